// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A virtual wall through the real servo: stable as theory says, and no further.

use palpate_device::{Device, DeviceProfile, PointState, profile_named};
use palpate_field::kernel::HalfSpace;
use palpate_field::{Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Probe, Protection, Servo, ServoOptions, Surface, Unprotected,
};
use palpate_safety::Acceptance;
use palpate_sim::{Hand, SimulatedDevice};

const PERIOD: f64 = 1e-3;

/// `bT/m` of the tests: small, so that 2b/T is the threshold to within as much.
const DAMPING_PER_TICK: f64 = 0.02;

/// A device of this damping, without friction and encoder steps.
fn smooth(profile: &DeviceProfile) -> DeviceProfile {
    DeviceProfile {
        mass: profile.least_damping * PERIOD / DAMPING_PER_TICK,
        friction: 0.0,
        encoder_step: 0.0,
        ..DeviceProfile { max_force: f64::INFINITY, ..profile.clone() }
    }
}

/// Pushed with 1 N onto a wall of `stiffness`, from rest `height` [m] above where the wall bears
/// it.
struct Pressed {
    device: SimulatedDevice,
    servo: Servo<Unprotected>,
    tick: u32,
}

impl Pressed {
    fn new(profile: &DeviceProfile, stiffness: f64, height: f64) -> Self {
        let radius = 0.002;
        let wall = HalfSpace::new(Vector([0.0, 1.0, 0.0]), -radius).unwrap();
        let options = ServoOptions {
            rate: 1.0 / PERIOD,
            probe: Probe::new(radius).unwrap(),
            max_force: f64::INFINITY,
            rise_time: 1e-9,
        };
        let surface = Surface::smooth(stiffness, 0.0).unwrap();
        let wall = Body::new(Shape::from_kernel(wall), surface).unwrap();
        let bodies = Bodies::new(vec![wall]).unwrap();
        let mut servo = Servo::new(bodies, 1, options).unwrap();
        // It comes from outside, so that its force need not rise.
        servo.step(&[PointState::at_rest(Vector([0.0, 1e-3, 0.0]))]);
        let hand = Hand::resting(Vector([0.0, height - 1.0 / stiffness, 0.0])).unwrap();
        let hand = hand.with_mass(0.0).unwrap().with_spring(0.0, 0.0).unwrap();
        let hand = hand.with_push(Vector([0.0, -1.0, 0.0])).unwrap();
        let device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
        Self { device, servo, tick: 0 }
    }

    /// The span of heights during the next `ticks` [m].
    fn span(&mut self, ticks: u32) -> f64 {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..ticks {
            self.device.read(f64::from(self.tick) * PERIOD, &mut points).unwrap();
            let force = self.servo.step(&points)[0].force;
            self.device.write(&[force]).unwrap();
            self.tick += 1;
            low = low.min(points[0].position[1]);
            high = high.max(points[0].position[1]);
        }
        high - low
    }
}

/// `true` if a small oscillation in contact dies away; otherwise it grows a hundred times before
/// it leaves the wall.
fn settles(profile: &DeviceProfile, stiffness: f64) -> bool {
    let mut pressed = Pressed::new(profile, stiffness, 0.01 / stiffness);
    let early = pressed.span(500);
    pressed.span(3000);
    pressed.span(500) < early
}

#[test]
fn walls_are_stable_up_to_twice_the_damping_over_the_period() {
    for name in ["touch", "omni", "desktop", "falcon", "omega", "lambda"] {
        let profile = smooth(&profile_named(name).unwrap());
        let theory = 2.0 * profile.least_damping / PERIOD;
        let (mut stable, mut unstable) = (0.5 * theory, 2.0 * theory);
        assert!(settles(&profile, stable) && !settles(&profile, unstable), "{name}");
        while unstable - stable > 1e-3 * theory {
            let middle = 0.5 * (stable + unstable);
            if settles(&profile, middle) {
                stable = middle;
            } else {
                unstable = middle;
            }
        }
        println!("{name}: threshold {stable:.0} N/m, 2b/T {theory:.0} N/m");
        assert!((stable / theory - 1.0).abs() < 0.05, "{name}: {stable} N/m, not {theory}");
    }
}

#[test]
fn above_the_threshold_a_limit_cycle_sustains_itself_on_energy_given() {
    for name in ["touch", "desktop", "omega", "delta"] {
        let profile = smooth(&profile_named(name).unwrap());
        let theory = 2.0 * profile.least_damping / PERIOD;
        let mut pressed = Pressed::new(&profile, 1.1 * theory, 0.2 / theory);
        pressed.span(20_000);
        let given = pressed.device.energy_given();
        let early = pressed.span(2000);
        pressed.span(20_000);
        let late = pressed.span(2000);
        assert!(early > 0.5 / theory, "{name}: {early} m");
        assert!((late / early - 1.0).abs() < 0.1, "{name}: {early} m, then {late} m");
        assert!(pressed.device.energy_given() > given, "{name}");

        let mut calm = Pressed::new(&profile, 0.9 * theory, 0.2 / theory);
        calm.span(40_000);
        assert!(calm.span(2000) < 1e-6 / theory, "{name}");
        assert!(calm.device.energy_given() <= 1e-12, "{name}");
    }
}

#[test]
fn one_percent_beyond_the_threshold_the_mass_just_leaves_the_wall() {
    // 0.05 kg, 0.5 N·s/m, 1 kHz, 1 N: 2b/T is 1000 N/m, where the wall bears 1 N at 1 mm.
    let profile = DeviceProfile {
        mass: 0.05,
        least_damping: 0.5,
        friction: 0.0,
        ..DeviceProfile::unlimited("wall")
    };
    let span_at = |stiffness: f64| {
        let mut pressed = Pressed::new(&profile, stiffness, 0.01);
        pressed.span(60_000);
        pressed.span(2000)
    };
    assert!(span_at(950.0) < 1e-6);
    assert!(span_at(990.0) < 2e-4);
    // In contact it grows; once it leaves, it loses: the span is twice the depth and a little.
    let sustained = span_at(1010.0);
    assert!((1.98e-3..2.2e-3).contains(&sustained), "{sustained} m");
}

#[test]
fn a_passive_wall_gives_no_energy_to_any_grip() {
    // One hundredth short of what theory allows: what the held force gives, the damping takes.
    let profile = smooth(&profile_named("desktop").unwrap());
    let stiffness = 0.99 * 2.0 * profile.least_damping / PERIOD;
    let mut most_given = 0.0_f64;
    for grip in [0.0, 0.5, 2.0, 10.0] {
        for spring in [0.0, 50.0, 800.0] {
            let mut pressed = Pressed::new(&profile, stiffness, 0.02);
            let hand =
                Hand::resting(Vector([0.0, 0.01, 0.0])).unwrap().with_mass(0.03).unwrap();
            let hand = hand.with_spring(spring, grip).unwrap();
            let hand = hand.with_push(Vector([0.1, -12.0, 0.0])).unwrap();
            pressed.device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
            for _ in 0..2000 {
                pressed.span(1);
                let given = pressed.device.energy_to_hand();
                most_given = most_given.max(pressed.device.energy_given());
                assert!(given <= 1e-12, "{grip} N·s/m, {spring} N/m: {given} J");
            }
        }
    }
    assert!(most_given > 1e-3, "the force held gave no energy: {most_given} J");
}

/// The most energy that the servo gave out in net at any time of 10 s [J], and how deep the
/// device is in the end, on a wall three times as stiff as is passive.
fn given_by_a_stiff_wall(profile: &DeviceProfile, grip: f64, height: f64) -> (f64, f64) {
    let stiffness = 3.0 * 2.0 * profile.least_damping / PERIOD;
    let Pressed { servo, .. } = Pressed::new(profile, stiffness, height);
    let mut servo = servo
        .protected(&Protection::new(profile.clone()).with(|s| {
            s.acceptance = Acceptance::AsIs;
            s.rise_rate = f64::INFINITY
        }))
        .unwrap();
    assert_eq!(servo.accepted()[0].stiffness_factor, 1.0);
    let hand = Hand::resting(Vector([0.0, height, 0.0])).unwrap();
    let hand = hand.with_mass(0.0).unwrap().with_spring(0.0, grip).unwrap();
    let hand = hand.with_push(Vector([0.0, -1.0, 0.0])).unwrap();
    let mut device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let mut most = 0.0_f64;
    for tick in 0..10_000 {
        device.read(f64::from(tick) * PERIOD, &mut points).unwrap();
        most = most.max(device.energy_given());
        servo.step(&points);
        device.write(servo.forces()).unwrap();
    }
    (most, -points[0].position[1])
}

#[test]
fn a_wall_thrice_as_stiff_gives_out_less_than_a_millijoule_under_control() {
    let wall = DeviceProfile {
        mass: 0.05,
        least_damping: 0.5,
        friction: 0.0,
        ..DeviceProfile::unlimited("wall")
    };
    let mut worst = 0.0_f64;
    for profile in [wall.clone(), DeviceProfile { mass: 0.1, ..wall }] {
        for grip in [0.0, 0.1, 0.3, 1.0, 3.0, 10.0] {
            for height in [0.0, 0.001, 0.01] {
                let (given, depth) = given_by_a_stiff_wall(&profile, grip, height);
                worst = worst.max(given);
                assert!(given <= 1e-3, "grip {grip}, from {height} m: {given} J");
                assert!(depth < 0.005, "grip {grip}, from {height} m: {depth} m deep");
            }
        }
    }
    println!("given at most {worst} J");
}
