// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whole runs of the servo, on clocks that tests move.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::common::{ball, cuboid, half_space, protected, without_limits};
use palpate_device::{Device, DeviceLost, DeviceProfile, PointState, Reading};
use palpate_field::{CustomField, Point, Pose, Promise, Shape, Vector};
use palpate_haptics::servo_loop::{
    Clock, Ending, Pace, Recorder, RunOptions, VirtualClock, run, run_on,
};
use palpate_haptics::{
    Bodies, Body, HapticsError, Impact, Layer, Material, NextPose, PopThrough, Probe,
    Protection, Servo, ServoOptions, Surface,
};
use palpate_sim::{HandPath, Interpolation, RecordedDevice, Tour};

/// A clock on which looking costs a microsecond and waiting nothing more.
#[derive(Default)]
struct TestClock {
    now: Duration,
    waits: u64,
    /// Looks at which the clock jumps, as if the machine had been busy.
    busy: Vec<(u64, Duration)>,
    looks: u64,
}

impl Clock for TestClock {
    fn now(&mut self) -> Duration {
        self.looks += 1;
        self.now += Duration::from_micros(1);
        for (look, time) in &self.busy {
            if *look == self.looks {
                self.now += *time;
            }
        }
        self.now
    }
    fn wait_until(&mut self, deadline: Duration) {
        self.waits += 1;
        self.now = self.now.max(deadline);
    }
}

fn press() -> HandPath {
    let positions =
        [0.25, 0.0, -0.0078125, -0.0078125, 0.25].map(|y| Vector([0.0, y, 0.0])).to_vec();
    HandPath::new(vec![0.0, 1.0, 2.0, 3.0, 4.0], positions, Interpolation::Linear).unwrap()
}

fn wall_servo(options: ServoOptions) -> Servo {
    let options = ServoOptions { probe: Probe::new(0.0).unwrap(), ..options };
    let wall = half_space([0.0, 1.0], 0.0);
    without_limits(Servo::new(wall, 1, options).unwrap())
}

fn fast<'a>(duration: f64) -> RunOptions<'a> {
    RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(duration) }
}

#[test]
fn a_report_counts_what_happened() {
    let max_force = f64::INFINITY;
    let mut servo =
        wall_servo(ServoOptions { rate: 128.0, max_force, ..ServoOptions::default() });
    let mut device = RecordedDevice::new(vec![press()]).unwrap();
    let mut recorder = Recorder::new(4 * 128);
    let options = RunOptions { recorder: Some(&mut recorder), ..fast(4.0) };
    let report = run_on(&mut TestClock::default(), &mut servo, &mut device, options).unwrap();

    assert_eq!(report.ending, Ending::Finished);
    assert_eq!((report.ticks, report.duration, report.points), (512, 4.0, 1));
    // Below the wall from the tick after 1 s; above it again 1/33 s, or 3.9 ticks, after 3 s.
    assert_eq!(report.contact_time, (2.0 * 128.0 + 3.0) / 128.0);
    assert_eq!(report.largest_depth, 0.0078125);
    // 500 N/m; the approach at 1/128 m/s adds up to 1/128 N for 1 N·s/m.
    assert!((report.largest_force - 500.0 * 0.0078125).abs() < 0.01);
    let cost = report.cost.unwrap();
    assert_eq!((cost.count, cost.max), (512, 1e-6));
    assert_eq!((report.lateness, report.missed_deadlines, report.rows_dropped), (None, 0, 0));
    assert!(report.evaluations.max <= 8 && report.evaluations.budget_spent == 0);

    assert_eq!(recorder.rows().len(), 512);
    let row = recorder.rows()[2 * 128];
    assert_eq!((row.time_s, row.point, row.cost_ns, row.lateness_ns), (2.0, 0, 1000, 0));
    assert_eq!(
        (row.device, row.proxy),
        (Vector([0.0, -0.0078125, 0.0]), Vector([0.0, 0.0, 0.0]))
    );
    assert_eq!((row.force, row.contact), (Vector([0.0, 3.90625, 0.0]), true));
    assert_eq!(device.forces(), [Vector::ZERO]);
}

/// A hand that stays at this height.
fn still(height: f64, duration: f64) -> RecordedDevice {
    let places = vec![Vector([0.0, height, 0.0]); 2];
    let path = HandPath::new(vec![0.0, duration], places, Interpolation::Linear).unwrap();
    RecordedDevice::new(vec![path]).unwrap()
}

#[test]
fn a_body_that_moves_pushes_a_hand_at_rest_with_its_speed() {
    // 128 ticks a second, in each of which the wall rises by 1/1024 m: at 1/8 m/s.
    let material = Surface::smooth(512.0, 4.0).unwrap();
    let wall = Body::new(half_space([0.0, 1.0], 0.0), material).unwrap();
    let options = ServoOptions {
        rate: 128.0,
        max_force: f64::INFINITY,
        probe: Probe::new(0.0).unwrap(),
        ..ServoOptions::default()
    };
    let bodies = Bodies::new(vec![wall]).unwrap();
    let mut servo = without_limits(Servo::new(bodies, 1, options).unwrap());
    let mut recorder = Recorder::new(64);
    let mut rise = |time: f64, set_pose: &mut dyn FnMut(usize, NextPose)| {
        set_pose(0, Pose::translation(Vector([0.0, 0.125 * time.min(0.25), 0.0])).into());
    };
    let options =
        RunOptions { recorder: Some(&mut recorder), motion: Some(&mut rise), ..fast(0.5) };
    run(&mut servo, &mut still(0.015625, 0.5), options).unwrap();
    let row = |tick: usize| recorder.rows()[tick];
    assert!(!row(15).contact);
    // After 24 ticks the wall is 1/128 m above the hand; damping resists its approach.
    let moving = row(24);
    assert_eq!((moving.contact, moving.proxy[1]), (true, 24.0 / 1024.0));
    assert!(
        (moving.wanted - Vector([0.0, 4.0 + 0.5, 0.0])).norm() < 1e-9,
        "{:?}",
        moving.wanted
    );
    // After 32 ticks it stops, 1/64 m above the hand.
    assert!((row(40).wanted - Vector([0.0, 8.0, 0.0])).norm() < 1e-9, "{:?}", row(40).wanted);
}

#[test]
fn a_body_that_slides_past_drags_a_hand_at_rest() {
    let material = Material::default();
    let friction = material.dynamic_friction;
    let floor = Body::new(cuboid([2.0, 0.5]), material).unwrap();
    let options = ServoOptions { probe: Probe::new(0.0).unwrap(), ..ServoOptions::default() };
    let bodies = Bodies::new(vec![floor]).unwrap();
    let mut servo = without_limits(Servo::new(bodies, 1, options).unwrap());
    let mut recorder = Recorder::new(1000);
    let mut slide = |time: f64, set_pose: &mut dyn FnMut(usize, NextPose)| {
        let height = if time > 0.0 { 0.0 } else { -0.1 };
        set_pose(0, Pose::translation(Vector([0.2 * time, height, 0.0])).into());
    };
    let options =
        RunOptions { recorder: Some(&mut recorder), motion: Some(&mut slide), ..fast(1.0) };
    run(&mut servo, &mut still(0.249, 1.0), options).unwrap();
    let last = recorder.rows()[999];
    assert!(last.contact && last.is_slipping);
    let drag = last.wanted[0] / last.wanted[1];
    assert!((drag - friction).abs() < 1e-6, "{:?}", last.wanted);
}

#[test]
fn a_panic_of_a_motion_ends_the_run_with_zero_forces() {
    let mut servo = wall_servo(ServoOptions::default());
    let mut device = still(-0.001, 0.1);
    let mut bad =
        |time: f64, _: &mut dyn FnMut(usize, NextPose)| assert!(time < 0.05, "too late");
    let report =
        run(&mut servo, &mut device, RunOptions { motion: Some(&mut bad), ..fast(0.1) })
            .unwrap();
    assert_eq!(report.ending, Ending::Panicked { message: "too late".to_owned() });
    assert_eq!((report.ticks, device.forces()), (50, &[Vector::ZERO][..]));
}

#[test]
fn a_full_recorder_drops_rows_and_says_so() {
    let mut servo = wall_servo(ServoOptions::default());
    let mut device = RecordedDevice::new(vec![press()]).unwrap();
    let mut recorder = Recorder::new(100);
    let options = RunOptions { recorder: Some(&mut recorder), ..fast(1.0) };
    let report = run(&mut servo, &mut device, options).unwrap();
    assert_eq!(
        (report.rows_dropped, recorder.dropped(), recorder.rows().len()),
        (900, 900, 100)
    );
}

#[test]
fn a_paced_run_waits_for_every_tick_and_does_not_hurry_after_lost_time() {
    let mut servo = wall_servo(ServoOptions { rate: 1000.0, ..ServoOptions::default() });
    let mut device = RecordedDevice::new(vec![press()]).unwrap();
    // In a rehearsal a tenth of a second is lost.
    let busy = vec![(1000, Duration::from_millis(100))];
    let mut clock = TestClock { busy, ..TestClock::default() };
    let options = RunOptions { rehearses: true, ..RunOptions::new(1.0) };
    let report = run_on(&mut clock, &mut servo, &mut device, options).unwrap();
    let lateness = report.lateness.unwrap();
    // Two waits a tick: for the rehearsals and for the tick.
    assert_eq!((report.ticks, clock.waits, lateness.count), (1000, 2000, 1000));
    assert_eq!(report.missed_deadlines, 1);
    assert_eq!(lateness.p50, 1e-6);
    assert!(lateness.max >= 0.1);
    assert!(clock.now >= Duration::from_millis(1098), "{:?}", clock.now);
}

/// A body that remembers: it rings, sticks, and gives way.
fn lively_servo() -> Servo {
    let shape = cuboid([0.1, 0.1, 0.1]).difference([ball(0.06)]).unwrap();
    let material = Material {
        static_friction: 0.5,
        dynamic_friction: 0.3,
        pop_through: Some(PopThrough { description: None, force: 1.0, distance: 0.01 }),
        layers: vec![Layer { depth: 0.004, ..Layer::default() }],
        impact: Some(Impact {
            description: None,
            amplitude: 2.0,
            frequency: 90.0,
            decay: 20.0,
        }),
        ..Material::default()
    };
    let body = Body::new(shape, Surface::new(&material).unwrap()).unwrap();
    let bodies = Bodies::new(vec![body]).unwrap();
    protected(Servo::new(bodies, 1, ServoOptions::default()).unwrap())
}

/// Every bit of a run: FNV-1a.
fn hash(pace: Pace) -> u64 {
    let mut servo = lively_servo();
    let shape = servo.bodies().bodies()[0].shape().clone();
    let bounds = shape.promise().bounds.unwrap().aabb;
    let path = Tour::new(bounds, 2.0).unwrap().over(&shape).unwrap();
    let mut device = RecordedDevice::new(vec![path]).unwrap();
    let mut recorder = Recorder::new(2000);
    let options = RunOptions {
        pace,
        rehearses: true,
        recorder: Some(&mut recorder),
        ..RunOptions::new(2.0)
    };
    run_on(&mut VirtualClock::new(), &mut servo, &mut device, options).unwrap();
    let numbers = recorder.rows().iter().flat_map(|row| [row.proxy.0, row.force.0].concat());
    numbers.fold(0xcbf2_9ce4_8422_2325, |hash, number| {
        (hash ^ number.to_bits()).wrapping_mul(0x0100_0000_01b3)
    })
}

#[test]
fn the_same_run_gives_the_same_bits() {
    assert_eq!(hash(Pace::AsFastAsPossible), hash(Pace::AsFastAsPossible));
}

#[test]
fn a_tick_that_was_rehearsed_is_the_same() {
    assert_eq!(hash(Pace::RealTime), hash(Pace::AsFastAsPossible));
}

#[test]
fn a_watch_sees_the_end() {
    let mut servo = wall_servo(ServoOptions::default());
    let mut device = RecordedDevice::new(vec![press()]).unwrap();
    let mut seen = Vec::new();
    let mut watch = |progress: &palpate_haptics::Progress| seen.push(*progress);
    let every = Duration::from_millis(1);
    let options = fast(3.0).with_watch(every, &mut watch);
    run(&mut servo, &mut device, options).unwrap();
    let last = seen.last().unwrap();
    assert_eq!((last.ticks, last.contacts, last.time), (3000, 1, 2.999));
    assert!(seen.windows(2).all(|pair| pair[0].ticks <= pair[1].ticks));
}

/// A wall that panics when it is touched.
#[derive(Debug)]
struct Trap(Promise<2>);

impl CustomField<2> for Trap {
    fn distance(&self, p: Point<2>) -> f64 {
        p[1]
    }
    fn distance_gradient(&self, p: Point<2>) -> (f64, Vector<f64, 2>) {
        assert!(p[1] > 0.1, "the trap snapped");
        (p[1], Vector([0.0, 1.0]))
    }
    fn promise(&self) -> &Promise<2> {
        &self.0
    }
}

#[test]
fn a_panic_stops_the_run_with_no_force() {
    let trap = Shape::custom(Trap(Promise::lipschitz(None, 1.0)));
    let mut device = Watched::new();
    let mut servo = Servo::for_device(trap, &device).unwrap();
    let report = run(&mut servo, &mut device, fast(4.0)).unwrap();
    assert_eq!(report.ending, Ending::Panicked { message: "the trap snapped".to_owned() });
    assert!(report.ticks > 0 && report.ticks < 4000);
    assert_eq!(device.written, Some(Vector::ZERO));
}

/// A device that falls for two seconds and is unplugged then.
struct Watched {
    profile: DeviceProfile,
    written: Option<Vector<f64, 3>>,
}

impl Watched {
    fn new() -> Self {
        let profile = DeviceProfile { max_force: 3.3, ..DeviceProfile::unlimited("watched") };
        Self { profile, written: None }
    }
}

impl Device for Watched {
    fn points(&self) -> usize {
        1
    }
    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        if time >= 2.0 {
            return Err(DeviceLost { reason: "unplugged".to_owned() });
        }
        points[0] = PointState::at_rest(Vector([0.0, 0.5 - time, 0.0]));
        Ok(Reading::Fresh { time })
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.written = forces.first().copied();
        Ok(())
    }
}

#[test]
fn a_lost_device_ends_the_run_with_its_reason() {
    let mut device = Watched::new();
    let mut servo = Servo::for_device(half_space([0.0, 1.0], 0.0), &device).unwrap();
    let report = run(&mut servo, &mut device, fast(4.0)).unwrap();
    assert_eq!(report.ending, Ending::DeviceLost { reason: "unplugged".to_owned() });
    assert_eq!((report.ticks, device.written), (2000, Some(Vector::ZERO)));
    // The force is the device's at most.
    assert_eq!(report.largest_force, 3.3);
}

/// A device that takes every force but none of zero.
struct Stuck(Watched);

impl Device for Stuck {
    fn points(&self) -> usize {
        self.0.points()
    }
    fn profile(&self) -> &DeviceProfile {
        self.0.profile()
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.0.read(time, points)
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        let is_zero = forces.iter().all(|force| *force == Vector::ZERO);
        if is_zero && self.0.written.is_some_and(|force| force != Vector::ZERO) {
            return Err(DeviceLost { reason: "stuck".to_owned() });
        }
        self.0.write(forces)
    }
}

/// The last write was ignored: a device that kept its force ended a run as if it had let go.
#[test]
fn a_run_says_whether_the_device_took_the_last_zero_forces() {
    let mut device = Stuck(Watched::new());
    let mut servo = Servo::for_device(half_space([0.0, 1.0], 0.0), &device).unwrap();
    let report = run(&mut servo, &mut device, fast(1.0)).unwrap();
    assert!(device.0.written.is_some_and(|force| force != Vector::ZERO));
    assert_eq!((&report.ending, report.is_released), (&Ending::Finished, false));
    let error = report.unless_failed().unwrap_err();
    assert!(error.to_string().contains("zero forces"), "{error}");

    let mut device = Watched::new();
    let mut servo = Servo::for_device(half_space([0.0, 1.0], 0.0), &device).unwrap();
    let report = run(&mut servo, &mut device, fast(1.0)).unwrap();
    assert!(report.is_released && report.unless_failed().is_ok());
    let report = run(&mut servo, &mut device, fast(4.0)).unwrap();
    let unplugged = DeviceLost { reason: "unplugged".to_owned() };
    assert_eq!(report.unless_failed().unwrap_err(), unplugged.into());
}

#[test]
fn what_cannot_run_is_refused() {
    let mut servo = wall_servo(ServoOptions::default());
    let mut two = RecordedDevice::new(vec![press(), press()]).unwrap();
    let error = run(&mut servo, &mut two, fast(1.0)).unwrap_err();
    assert_eq!(error, HapticsError::ContactPoints { servo: 1, device: 2 });
    assert!(run(&mut servo, &mut Watched::new(), fast(f64::NAN)).is_err());
    assert!(RecordedDevice::new(vec![]).is_err());
}

/// A device whose user leaves as soon as a force is felt.
struct Leaving<'a> {
    device: Watched,
    left: &'a AtomicBool,
}

impl Device for Leaving<'_> {
    fn points(&self) -> usize {
        self.device.points()
    }
    fn profile(&self) -> &DeviceProfile {
        self.device.profile()
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.device.read(time, points)
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        if forces[0].norm() > 0.0 {
            self.left.store(true, Ordering::Relaxed);
        }
        self.device.write(forces)
    }
}

#[test]
fn an_interrupted_run_ends_before_its_next_tick_with_no_force() {
    let left = AtomicBool::new(false);
    let mut device = Leaving { device: Watched::new(), left: &left };
    let protection = Protection::new(device.profile().clone());
    let options = ServoOptions { probe: Probe::new(0.0).unwrap(), ..ServoOptions::default() };
    let servo = Servo::new(half_space([0.0, 1.0], 0.0), 1, options).unwrap();
    let mut servo = servo.protected(&protection.with(|s| s.rise_rate = f64::INFINITY)).unwrap();
    let options = RunOptions { interrupt: Some(&left), ..fast(4.0) };
    let report = run(&mut servo, &mut device, options).unwrap();
    assert_eq!(report.ending, Ending::Interrupted);
    // The hand is at the wall after half a second, and below it in the tick after.
    assert_eq!(report.ticks, 502);
    assert!(report.largest_force > 0.0);
    assert_eq!(device.device.written, Some(Vector::ZERO));
}
