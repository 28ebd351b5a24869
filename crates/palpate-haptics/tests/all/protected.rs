// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! No public road leads from a device that declares limits to a force beyond them.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use palpate_device::{Device, DeviceLost, DeviceProfile, PointState, Reading};
use palpate_field::kernel::HalfSpace;
use palpate_field::{Point, Shape, Vector};
use palpate_haptics::servo_loop::{
    Pace, RunOptions, ServoThread, ThreadOptions, VirtualClock, run,
};
use palpate_haptics::{
    Bodies, Body, HandoffOptions, HapticsError, Magnet, Material, Protection, Servo,
    ServoOptions, Surface, handoff,
};
use palpate_safety::SafetyError;

use crate::common::{body, half_space};

const RATE: f64 = 1000.0;

/// A device that declares limits and keeps what was written to it. Its hand falls into the
/// floor, is torn out of it, and jumps.
#[derive(Clone)]
struct Fragile {
    profile: DeviceProfile,
    written: Arc<Mutex<Vec<Vector<f64, 3>>>>,
}

impl Fragile {
    fn new() -> Self {
        let profile = DeviceProfile {
            max_force: 4.0,
            max_force_rate: 3000.0,
            mass: 0.05,
            least_damping: 0.5,
            ..DeviceProfile::unlimited("fragile")
        };
        Self { profile, written: Arc::default() }
    }

    fn place(tick: u32) -> Point<3> {
        let height = match tick % 700 {
            0..200 => 0.1 - 0.001 * f64::from(tick % 700),
            200..500 => -0.1,
            _ => 0.05,
        };
        Vector([0.0, height, 0.0])
    }

    /// Every force and every change of force is within the limits, and some are large.
    fn check(&self, name: &str) {
        let written = self.written.lock().unwrap();
        let (most, step) = (self.profile.max_force, self.profile.max_force_rate / RATE);
        let mut last = Vector::ZERO;
        let mut largest = 0.0_f64;
        for (tick, force) in written.iter().enumerate() {
            assert!(force.norm() <= most * (1.0 + 1e-12), "{name}, tick {tick}: {force:?}");
            let change = (*force - last).norm();
            let falls = *force == Vector::ZERO;
            assert!(falls || change <= step * (1.0 + 1e-9), "{name}, tick {tick}: {change} N");
            (last, largest) = (*force, largest.max(force.norm()));
        }
        assert!(largest > 0.9 * most, "{name}: the largest force is {largest} N");
    }
}

impl Device for Fragile {
    fn points(&self) -> usize {
        1
    }
    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        points[0] = PointState::at_rest(Self::place((time * RATE).round() as u32));
        Ok(Reading::Fresh { time })
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.written.lock().unwrap().push(forces[0]);
        Ok(())
    }
}

/// Harder than the device can render.
fn floor() -> Bodies {
    body(half_space([0.0, 1.0], 0.0), Surface::smooth(50_000.0, 10.0).unwrap())
}

#[test]
fn a_run_keeps_the_limits_of_its_device() {
    let mut device = Fragile::new();
    let mut servo = Servo::for_device(floor(), &device).unwrap();
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(3.0) };
    run(&mut servo, &mut device, options).unwrap();
    device.check("run");
}

#[test]
fn a_thread_keeps_the_limits_of_its_device_under_new_bodies_and_stops() {
    let device = Fragile::new();
    let servo = Servo::for_device(half_space([0.0, 1.0], 0.0), &device).unwrap();
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions { raises_priority: false, ..ThreadOptions::default() };
    let mut thread =
        ServoThread::start_on(clock, servo, Box::new(device.clone()), options).unwrap();
    let switch = thread.control().stop_switch();
    for step in 0..30 {
        driver.advance(Duration::from_millis(97));
        match step % 5 {
            0 => drop(thread.control().replace_bodies(floor()).unwrap()),
            2 => _ = switch.stop(),
            3 => switch.release(),
            _ => {}
        }
    }
    drop(driver);
    drop(thread.end());
    device.check("thread");
}

#[test]
fn a_loop_of_ones_own_keeps_the_limits_and_stops() {
    let mut device = Fragile::new();
    let mut servo = Servo::for_device(floor(), &device).unwrap();
    let (control, mut end) = handoff(&servo, HandoffOptions::default());
    let switch = control.stop_switch();
    for tick in 0..3000 {
        match tick {
            1000 => _ = switch.stop(),
            1100 => switch.release(),
            _ => {}
        }
        // A tick in a hundred is late.
        servo.set_late(if tick % 100 == 0 { 0.002 } else { 0.0 });
        end.receive(&mut servo);
        servo.step(&[PointState::at_rest(Fragile::place(tick))]);
        device.write(servo.forces()).unwrap();
        assert!(!(1000..1100).contains(&tick) || servo.forces() == [Vector::ZERO]);
    }
    device.check("own loop");
}

#[test]
fn a_stop_holds_without_a_safety_chain_too() {
    // Once a stop went over the safety chains, and did nothing where there were none.
    let mut servo = Servo::new(floor(), 1, ServoOptions::default()).unwrap();
    let inside = [PointState::at_rest(Vector([0.0, -0.001, 0.0]))];
    servo.step(&[PointState::at_rest(Vector([0.0, 0.1, 0.0]))]);
    servo.step(&inside);
    assert!(servo.forces()[0].norm() > 3.0);
    servo.stop(true);
    servo.step(&inside);
    assert_eq!((servo.forces()[0], servo.touches()[0].force), (Vector::ZERO, Vector::ZERO));
    // Released, the force rises from nothing.
    servo.stop(false);
    servo.step(&inside);
    assert!((servo.forces()[0].norm() - 0.033).abs() < 1e-9, "{:?}", servo.forces());
}

#[test]
fn a_servo_does_not_run_with_a_device_that_bears_less_than_its_own() {
    let servo = Servo::for_device(floor(), &Fragile::new()).unwrap();
    let run_with = |profile: DeviceProfile| {
        let mut weak = Fragile { profile, ..Fragile::new() };
        let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(0.01) };
        run(&mut servo.clone(), &mut weak, options).map(|report| report.ticks)
    };
    let own = Fragile::new().profile;
    assert_eq!(run_with(own.clone()), Ok(10));
    assert_eq!(run_with(DeviceProfile { max_force: 5.0, ..own.clone() }), Ok(10));
    let refused = |profile: DeviceProfile| match run_with(profile) {
        Err(HapticsError::Safety(SafetyError::OtherDevice { limit, .. })) => limit,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(DeviceProfile { max_force: 3.9, ..own.clone() }), "max_force");
    assert_eq!(refused(DeviceProfile { max_force_rate: 1.0, ..own.clone() }), "max_force_rate");
    assert_eq!(
        refused(DeviceProfile { continuous_force: 1.0, ..own.clone() }),
        "continuous_force"
    );
    assert_eq!(refused(DeviceProfile { least_damping: 0.4, ..own.clone() }), "least_damping");
    assert_eq!(refused(DeviceProfile { friction: 0.1, ..own.clone() }), "friction");
    assert_eq!(refused(DeviceProfile { encoder_step: 1e-5, ..own }), "encoder_step");
}

/// The end of the process came before the zero forces: the motors kept the last ones.
#[test]
fn a_thread_that_is_dropped_writes_its_zero_forces_first() {
    let device = Fragile::new();
    let servo = Servo::for_device(floor(), &device).unwrap();
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions { raises_priority: false, ..ThreadOptions::default() };
    let thread =
        ServoThread::start_on(clock, servo, Box::new(device.clone()), options).unwrap();
    driver.advance(Duration::from_millis(250));
    let last = || device.written.lock().unwrap().last().copied();
    assert!(last().is_some_and(|force| force != Vector::ZERO));
    drop(driver);
    drop(thread);
    assert_eq!(last(), Some(Vector::ZERO));
}

/// NaN was no limit, and a negative one a device without force.
#[test]
fn a_profile_whose_largest_force_is_none_is_refused() {
    for max_force in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        let profile = DeviceProfile { max_force, ..Fragile::new().profile };
        let servo = Servo::new(floor(), 1, ServoOptions::default()).unwrap();
        let refused = servo.protected(&Protection::new(profile)).unwrap_err();
        assert!(refused.to_string().starts_with("max_force must be"), "{refused}");
    }
}

/// A servo that was stopped before it was protected gave its force at the release at once.
#[test]
fn what_was_stopped_before_it_was_protected_is_released_gently() {
    let mut servo = Servo::new(floor(), 1, ServoOptions::default()).unwrap();
    servo.stop(true);
    let profile = Fragile::new().profile;
    let rate = profile.max_force_rate;
    let mut servo = servo.protected(&Protection::new(profile)).unwrap();
    let at = |y: f64| [PointState::at_rest(Vector([0.0, y, 0.0]))];
    servo.step(&at(0.01));
    for _ in 0..200 {
        servo.step(&at(-0.005));
        assert_eq!(servo.forces()[0], Vector::ZERO);
    }
    servo.stop(false);
    let mut before = 0.0;
    for _ in 0..200 {
        servo.step(&at(-0.005));
        let force = servo.forces()[0].norm();
        assert!(
            force - before <= 1e-3 * rate + 1e-9 && force - before <= 0.1,
            "{before} {force}"
        );
        before = force;
    }
    assert!(before > 1.0, "{before}");
}

#[test]
fn a_magnet_pulls_no_steeper_than_the_device_renders() {
    // 30 N at 0.25 mm are 120 kN/m, of which the device renders 1 kN/m.
    let magnet = Magnet { description: None, force: 30.0, distance: 0.001 };
    let material = Material { magnet: Some(magnet), ..Material::default() };
    let shape = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), -0.002).unwrap());
    let body = Body::new(shape, Surface::new(&material).unwrap()).unwrap();
    let bodies = Bodies::new(vec![body]).unwrap();
    let device = DeviceProfile { max_stiffness: 1000.0, ..DeviceProfile::unlimited("example") };
    let servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
    let protection = Protection::new(device).with(|s| s.rise_rate = f64::INFINITY);
    let mut servo = servo.protected(&protection).unwrap();
    servo.step(&[PointState::at_rest(Vector([0.0, 0.00025, 0.0]))]);
    assert!(
        (servo.forces()[0] - Vector([0.0, -0.25, 0.0])).norm() < 1e-9,
        "{:?}",
        servo.forces()
    );
}
