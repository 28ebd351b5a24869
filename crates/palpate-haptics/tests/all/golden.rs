// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Trajectories that are the same to the last bit in every build.

use crate::common::wild::{bodies, servo, step};
use crate::common::{AnyServo, protected};
use palpate_device::PointState;
use palpate_field::Vector;

const TICKS: u32 = 6000;

/// FNV-1a of every proxy, force and evaluation of a run.
fn hash<const D: usize>(servo: &mut impl AnyServo) -> u64 {
    let mut states = vec![PointState::at_rest(Vector::ZERO); servo.touches().len()];
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |number: u64| hash = (hash ^ number).wrapping_mul(0x0100_0000_01b3);
    let count = servo.bodies().bodies().len();
    for tick in 0..TICKS {
        step::<D>(servo, &mut states, (tick, 1.0));
        for touch in servo.touches() {
            let felt = [touch.proxy, touch.force, touch.normal];
            for x in felt.iter().flat_map(|vector| &vector.0[..D]) {
                // A zero of either sign is the same zero.
                add((x + 0.0).to_bits());
            }
            assert!(felt.iter().all(|vector| D == 3 || vector[2] == 0.0), "{touch:?}");
            add(u64::from(touch.evaluations) << 1 | u64::from(touch.contact));
        }
        if tick % 1000 == 999 {
            servo.swap_bodies(bodies::<D>(count, 1.0));
        }
    }
    hash
}

/// Compares with what was; shown as it stands in this file.
fn is_as_it_was<const N: usize>(hashes: [u64; N], stored: [u64; N]) {
    assert_eq!(hashes.map(|h| format!("{h:#018x}")), stored.map(|h| format!("{h:#018x}")));
}

#[test]
fn in_the_plane_every_bit_is_as_it_was() {
    let hashes = [
        hash::<2>(&mut servo::<2>(9, 3, 1.0)),
        hash::<2>(&mut protected(servo::<2>(9, 3, 1.0))),
    ];
    is_as_it_was(hashes, [0xdf7c_0975_dc7b_3b8c, 0x2081_2887_ed9a_f10d]);
}

#[test]
fn in_space_every_bit_is_as_it_was() {
    let few = hash::<3>(&mut servo::<3>(4, 10, 1.0));
    let many = hash::<3>(&mut servo::<3>(20, 3, 1.0));
    let safe = hash::<3>(&mut protected(servo::<3>(20, 3, 1.0)));
    is_as_it_was(
        [few, many, safe],
        [0x4357_b65f_c9bd_e10a, 0xaafc_a61f_de39_ccb0, 0x37e2_bbc6_ba9e_76a7],
    );
}
