// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whole runs at other scales: lengths and forces scale alike, and nothing else changes.

use crate::common::wild::{servo, step};
use palpate_device::PointState;
use palpate_field::Vector;
use palpate_haptics::{EventKind, Touch};

const TICKS: u32 = 8000;
const POINTS: usize = 5;

/// Every touch of a run, and how many events of each kind there were.
fn run<const D: usize>(scale: f64) -> (Vec<Touch>, [u32; 5]) {
    let mut servo = servo::<D>(if D == 2 { 9 } else { 20 }, POINTS, scale);
    let mut states = [PointState::at_rest(Vector::ZERO); POINTS];
    let (mut touches, mut events) = (Vec::new(), [0; 5]);
    for tick in 0..TICKS {
        step::<D>(&mut servo, &mut states, (tick, scale));
        touches.extend_from_slice(servo.touches());
        for event in servo.events() {
            let kind = match event.kind {
                EventKind::Touch { .. } => 0,
                EventKind::Leave => 1,
                EventKind::Slip => 2,
                EventKind::Stick => 3,
                EventKind::Pop { .. } => 4,
                other => panic!("{other:?}"),
            };
            events[kind] += 1;
        }
    }
    (touches, events)
}

/// The part of all touches that differ by more than rounding explains.
fn apart<const D: usize>(scale: f64, tolerance: f64) -> f64 {
    let ((ours, events), (others, _)) = (run::<D>(1.0), run::<D>(scale));
    // Everything happens.
    assert!(events.iter().all(|count| *count > 0), "{events:?}");
    let contacts = ours.iter().filter(|touch| touch.contact).count();
    assert!(contacts > ours.len() / 20, "{contacts}");
    let mut apart = 0;
    for (touch, other) in ours.iter().zip(&others) {
        let proxy = (other.proxy * (1.0 / scale) - touch.proxy).norm();
        let force = (other.force * (1.0 / scale) - touch.force).norm();
        let is_alike = touch.contact == other.contact && proxy <= 0.1 * tolerance;
        apart += usize::from(!is_alike || force > 100.0 * tolerance);
    }
    apart as f64 / ours.len() as f64
}

#[test]
fn powers_of_two_change_no_bit_of_a_run() {
    for scale in [1.0 / 64.0, 64.0] {
        assert_eq!(apart::<2>(scale, 0.0), 0.0);
        assert_eq!(apart::<3>(scale, 0.0), 0.0);
    }
}

#[test]
fn a_hundredth_and_a_hundred_times_feel_alike() {
    // A rounding more or less decides whether a proxy sticks for a tick more, or a search on a
    // bumpy body ends a step earlier; until the hand leaves the body, it is felt.
    for scale in [0.01, 0.1, 10.0, 100.0] {
        let parts = [apart::<2>(scale, 1e-5), apart::<3>(scale, 1e-5)];
        assert!(parts.iter().all(|part| *part < 0.01), "{parts:?}");
    }
}
