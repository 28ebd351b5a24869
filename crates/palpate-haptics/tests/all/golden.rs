// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Trajectories that are the same to the last bit in every build.

use crate::common::tools::{box_mesh, on_a_loop, rough, smooth, springs};
use crate::common::wild::{bodies, plain, servo, step, step_hands};
use crate::common::{AnyServo, ball, body, half_space, protected};
use palpate_device::PointState;
use palpate_field::Vector;
use palpate_haptics::{Bodies, Material, Shell, Surface, Tool};

const TICKS: u32 = 6000;

/// FNV-1a of the numbers of a run.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, number: u64) {
        self.0 = (self.0 ^ number).wrapping_mul(0x0100_0000_01b3);
    }

    /// Adds the first `D` coordinates.
    fn add_vector<const D: usize>(&mut self, vector: Vector<f64, 3>) {
        for x in &vector.0[..D] {
            // A zero of either sign is the same zero.
            self.add((x + 0.0).to_bits());
        }
        assert!(D == 3 || vector[2] == 0.0, "{vector:?}");
    }

    /// Adds every proxy, force, normal and count of evaluations of a tick.
    fn add_touches<const D: usize>(&mut self, servo: &impl AnyServo) {
        for touch in servo.touches() {
            for vector in [touch.proxy, touch.force, touch.normal] {
                self.add_vector::<D>(vector);
            }
            self.add(u64::from(touch.evaluations) << 1 | u64::from(touch.contact));
        }
    }
}

/// The hash of a run in which bodies move and are replaced.
fn hash<const D: usize>(servo: &mut impl AnyServo) -> u64 {
    let mut states = vec![PointState::at_rest(Vector::ZERO); servo.touches().len()];
    let mut hash = Hash::new();
    let count = servo.bodies().bodies().len();
    for tick in 0..TICKS {
        step::<D>(servo, &mut states, (tick, 1.0));
        hash.add_touches::<D>(servo);
        if tick % 1000 == 999 {
            servo.swap_bodies(bodies::<D>(count, 1.0));
        }
    }
    hash.0
}

/// The hash of a run in which no body moves.
fn hash_at_rest<const D: usize>(servo: &mut impl AnyServo) -> u64 {
    let mut states = vec![PointState::at_rest(Vector::ZERO); servo.touches().len()];
    let mut hash = Hash::new();
    for tick in 0..TICKS {
        step_hands::<D>(servo, &mut states, (tick, 1.0));
        hash.add_touches::<D>(servo);
    }
    hash.0
}

/// Hands of both kinds of servo on bodies of one surface that do not move.
fn on_bodies_at_rest(surface: &Surface) -> [u64; 4] {
    [
        hash_at_rest::<2>(&mut plain::<2>(12, 3, surface)),
        hash_at_rest::<2>(&mut protected(plain::<2>(12, 3, surface))),
        hash_at_rest::<3>(&mut plain::<3>(12, 3, surface)),
        hash_at_rest::<3>(&mut protected(plain::<3>(12, 3, surface))),
    ]
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
    is_as_it_was(hashes, [0x3963_d1a2_27aa_ee9b, 0xca56_cf2e_57f0_7170]);
}

#[test]
fn in_space_every_bit_is_as_it_was() {
    let few = hash::<3>(&mut servo::<3>(4, 10, 1.0));
    let many = hash::<3>(&mut servo::<3>(20, 3, 1.0));
    let safe = hash::<3>(&mut protected(servo::<3>(20, 3, 1.0)));
    is_as_it_was(
        [few, many, safe],
        [0x97b0_851f_8174_e11d, 0xe9e8_027c_8793_3017, 0x0d76_32de_4974_eacb],
    );
}

#[test]
fn on_bodies_at_rest_damping_without_friction_is_as_it_was() {
    let surface = Surface::smooth(500.0, 0.5).unwrap();
    is_as_it_was(
        on_bodies_at_rest(&surface),
        [
            0xdbc7_62c4_504b_e8bc,
            0x8cb1_fedf_0124_b0f4,
            0x5010_9cae_b27c_cfce,
            0x2895_7269_badd_5eff,
        ],
    );
}

#[test]
fn on_bodies_at_rest_friction_without_damping_is_as_it_was() {
    let (static_friction, dynamic_friction) = (0.5, 0.3);
    let material =
        Material { static_friction, dynamic_friction, damping: 0.0, ..Material::default() };
    let surface = Surface::new(&material).unwrap();
    is_as_it_was(
        on_bodies_at_rest(&surface),
        [
            0x4dbd_f7ff_4500_39c3,
            0x13b3_54cd_cbbf_133a,
            0x0d64_0d89_4e6e_315b,
            0x9f16_746d_70d1_899e,
        ],
    );
}

/// The hash of a tool that goes twice round a loop.
fn hash_of_tool(mut tool: Tool, mut bodies: Bodies) -> u64 {
    let mut hash = Hash::new();
    for tick in 0..TICKS {
        let (_, state) = on_a_loop(f64::from(tick) / f64::from(TICKS / 2));
        tool.step(&mut bodies, &state);
        let touch = tool.touch();
        for vector in [touch.pose.translation, touch.force, touch.torque] {
            hash.add_vector::<3>(vector);
        }
    }
    hash.0
}

#[test]
fn on_bodies_at_rest_tools_are_as_they_were() {
    let shell = || Shell::from_mesh(&box_mesh([0.02, 0.03, 0.025]), 400, 0.0).unwrap();
    let on_ball = body(ball::<3>(0.05), Surface::new(&smooth()).unwrap());
    let on_ball = hash_of_tool(Tool::new(shell(), springs()).unwrap(), on_ball);
    let (ground, tool) = rough(&half_space([0.0, 1.0, 0.0], 0.03));
    let on_ground = hash_of_tool(tool, ground);
    is_as_it_was([on_ball, on_ground], [0xf37b_7d7c_7c39_c4f0, 0x49be_3192_a8c1_b766]);
}
