// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Servos on simulated devices and gloves.
use assert_no_alloc::assert_no_alloc;
use palpate_device::{Device, PROFILES, PointState, profile_named};
use palpate_field::kernel::Ball;
use palpate_field::{Shape, Vector};
use palpate_haptics::servo_loop::{Pace, RunOptions, run};
use palpate_haptics::{Protection, Servo, ServoOptions, Shell, Tool, ToolOptions};
use palpate_sim::{Glove, Hand, HandPath, Interpolation, SimulatedDevice};

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
fn a_tick_of_a_tool_that_turns_allocates_nothing() {
    let turns = vec![Vector([0.0; 3]), Vector([0.3, 0.1, -0.4]), Vector([0.0, 0.5, 0.2])];
    let turns = HandPath::new(vec![0.0, 0.7, 1.5], turns, Interpolation::Smooth).unwrap();
    let hand = Hand::new(stroke()).with_turns(turns);
    let mut device =
        SimulatedDevice::new(profile_named("sigma7").unwrap(), vec![hand]).unwrap();
    let ball = Shape::<3>::from_kernel(Ball::new(0.05).unwrap());
    let rod = Shell::capsule([Vector([-0.05, 0.0, 0.0]), Vector([0.05, 0.0, 0.0])], 4e-3, 21);
    let tool = Tool::new(rod.unwrap(), ToolOptions::default()).unwrap();
    let mut servo = Servo::for_tool(ball, tool, &device).unwrap();
    let (mut points, mut largest) = ([PointState::at_rest(Vector::ZERO)], 0.0_f64);
    for tick in 0..2000 {
        assert_no_alloc(|| {
            device.read(f64::from(tick) * 1e-3, &mut points).unwrap();
            let turn = device.read_turn().unwrap();
            servo.set_turn(turn);
            servo.limit_torque(0.15);
            servo.step(&points);
            device.write(servo.forces()).unwrap();
            device.write_torque(servo.torque()).unwrap();
        });
        largest = largest.max(device.torque().norm());
    }
    assert!(largest > 1e-3 && largest <= 0.15, "{largest} N·m");
}

#[test]
fn every_known_device_rests_on_a_ball() {
    for (name, profile) in &PROFILES {
        let hand = Hand::resting(Vector([0.0, 0.06, 0.0])).unwrap();
        let hand = hand.with_push(Vector([0.0, -5.0, 0.0])).unwrap();
        let mut device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
        let ball = Shape::<3>::from_kernel(Ball::new(0.05).unwrap());
        // A force that rises from nothing under the hand would lift it, which takes energy.
        let protection = Protection::new(profile.clone()).with(|s| s.rise_rate = f64::INFINITY);
        let servo = Servo::new(ball, 1, ServoOptions::of_device(profile)).unwrap();
        let mut servo = servo.protected(&protection).unwrap();
        let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.5) };
        let report = run(&mut servo, &mut device, options).unwrap();
        assert!(report.contact_time > 1.0, "{name}: {report:?}");
        assert!(
            report.largest_force <= profile.max_force * (1.0 + 1e-12),
            "{name}: {report:?}"
        );
        assert!(servo.touches()[0].contact, "{name}");
        assert!(device.energy_given() < 0.0, "{name}: {} J", device.energy_given());
    }
}

#[test]
fn two_gloves_feel_with_24_points() {
    let mut gloves = both_hands();
    assert_eq!(gloves.points(), 24);
    let ball = Shape::<3>::from_kernel(Ball::new(0.05).unwrap());
    let mut servo = Servo::for_device(ball, &gloves).unwrap();
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.5) };
    let report = run(&mut servo, &mut gloves, options).unwrap();
    assert_eq!((report.points, report.ticks), (24, 1500));
    assert!(report.largest_depth > 0.005, "{report:?}");
    // Such gloves give no force.
    assert_eq!(report.largest_force, 0.0);
}
