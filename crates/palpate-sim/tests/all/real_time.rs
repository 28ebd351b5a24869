// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tick of simulated devices and gloves allocates nothing, for any force and any time.
use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use palpate_device::{Device, PointState, profile_named};
use palpate_field::Vector;
use palpate_sim::{Glove, Hand, HandPath, Interpolation, SimulatedDevice};

/// Aborts on an allocation where none is allowed.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

fn stroke() -> HandPath {
    let places =
        vec![Vector([0.02, 0.08, 0.01]), Vector([0.0, 0.03, 0.0]), Vector([-0.03, 0.06, 0.0])];
    HandPath::new(vec![0.0, 0.7, 1.5], places, Interpolation::Smooth).unwrap()
}

/// Twelve points of a hand, 10 mm apart.
fn fingers(side: f64) -> Vec<Vector<f64, 3>> {
    let place = |i: i32| Vector([side, 0.002 * f64::from(i % 4), 0.01 * f64::from(i - 6)]);
    (0..12).map(place).collect()
}

fn both_hands() -> Glove {
    let [left, right] =
        [-0.03, 0.03].map(|x| Glove::from_hand(&stroke(), &fingers(x)).unwrap());
    left.joined(right)
}

#[test]
fn reading_and_writing_allocate_nothing() {
    let hands = vec![Hand::new(stroke()); 3];
    let mut stylus = SimulatedDevice::new(profile_named("falcon").unwrap(), hands).unwrap();
    let mut glove = both_hands();
    let mut points = [PointState::at_rest(Vector::ZERO); 24];
    for tick in 0..2000 {
        let time = f64::from(tick) * 1e-3;
        let push = 4.0 * (0.37 * f64::from(tick)).sin();
        let forces = [Vector([push, 0.0, -push]); 24];
        assert_no_alloc(|| {
            stylus.read(time, &mut points).unwrap();
            stylus.write(&forces).unwrap();
            glove.read(time, &mut points).unwrap();
            glove.write(&forces).unwrap();
        });
    }
}

#[test]
fn no_force_and_no_time_breaks_a_device() {
    let hand = Hand::new(stroke());
    let mut device = SimulatedDevice::new(profile_named("omega").unwrap(), vec![hand]).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let numbers = [f64::NAN, f64::INFINITY, -1e308, 1e308, 5e-324, 0.0, -0.0, 3.0, -7.5, 1e-9];
    for round in 0..10 {
        for (i, x) in numbers.iter().enumerate() {
            let y = numbers[(i + round) % numbers.len()];
            device.write(&[Vector([*x, y, 1.0])]).unwrap();
            device.read(y, &mut points).unwrap();
            assert!(points[0].is_finite(), "{x}, {y}: {:?}", points[0]);
            device.read(1e-3 * (i + 10 * round) as f64, &mut points).unwrap();
            assert!(points[0].is_finite(), "{x}, {y}: {:?}", points[0]);
        }
    }
    device.write(&[]).unwrap();
    device.read(1.0, &mut []).unwrap();
}
