// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What loops do around a device: opened, watched, paced, lost, found, closed; and what else than
//! contact points a device has.

use palpate_haptics::{EventKind, HapticsError, NextPose, Servo, ServoOptions};
use std::time::Duration;

use palpate_device::{
    Buttons, Device, DeviceLost, DeviceProfile, GripperProfile, GripperState, MailboxDevice,
    PointState, Reading,
};
use palpate_field::{Shape, Vector};
use palpate_haptics::servo_loop::{
    Ending, Pace, Reconnection, RunOptions, ServoThread, ThreadOptions, VirtualClock, run,
    run_on,
};
use palpate_sim::{
    Calls, Fault, FaultKind, Hand, HandPath, Interpolation, RecordedDevice, SimulatedDevice,
    SimulatedTransport,
};

/// A device that keeps the names of the calls, and fails or panics in one of them.
#[derive(Debug)]
struct Called {
    profile: DeviceProfile,
    calls: Vec<&'static str>,
    /// What fails, and whether it panics.
    fails: Option<(&'static str, bool)>,
}

impl Called {
    fn new(fails: Option<(&'static str, bool)>) -> Self {
        let gripper = GripperProfile::new(0.03, 5.0);
        let profile = DeviceProfile { max_force: 2.0, ..DeviceProfile::unlimited("called") };
        Self {
            profile: DeviceProfile { gripper: Some(gripper), ..profile },
            calls: Vec::new(),
            fails,
        }
    }

    fn call(&mut self, name: &'static str) -> Result<(), DeviceLost> {
        if self.calls.last() != Some(&name) {
            self.calls.push(name);
        }
        match self.fails {
            Some((failing, panics)) if failing == name => {
                assert!(!panics, "{name} panics");
                Err(DeviceLost::new(format!("{name} fails")))
            }
            _ => Ok(()),
        }
    }
}

impl Device for Called {
    fn points(&self) -> usize {
        1
    }
    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }
    fn open(&mut self) -> Result<(), DeviceLost> {
        self.call("open")
    }
    fn set_watchdog(&mut self, time: Duration) -> Result<Option<Duration>, DeviceLost> {
        self.call("watch")?;
        // In steps of 125 µs, a byte of them.
        let steps = (time.as_micros() / 125).min(255) as u64;
        Ok(Some(Duration::from_micros(125 * steps)))
    }
    fn enable(&mut self) -> Result<(), DeviceLost> {
        self.call("enable")
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        points[0] = PointState::at_rest(Vector([0.0, 0.01, 0.0]));
        self.call("read")?;
        Ok(Reading::Fresh { time })
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        assert_eq!(forces, [Vector::ZERO]);
        self.call("write")
    }
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        assert_eq!(torque, Vector::ZERO);
        self.call("torque")
    }
    fn write_gripper_force(&mut self, force: f64) -> Result<(), DeviceLost> {
        assert_eq!(force, 0.0);
        self.call("gripper")
    }
    fn close(&mut self) -> Result<(), DeviceLost> {
        self.call("close")
    }
}

fn wall() -> Shape<2> {
    Shape::half_space([0.0, 1.0], 0.0).unwrap()
}

fn fast<'a>(duration: f64) -> RunOptions<'a> {
    RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(duration) }
}

#[test]
fn a_device_is_opened_watched_enabled_zeroed_and_closed() {
    let start = ["open", "watch", "enable"];
    let end = ["write", "torque", "gripper", "close"];
    for (fails, middle, ending) in [
        (None, &["read", "write", "gripper"][..], Ending::Finished),
        (Some("read"), &["read"][..], lost("read")),
        (Some("write"), &["read"][..], lost("write")),
        (Some("gripper"), &["read", "write", "gripper"][..], lost("gripper")),
    ] {
        for panics in [false, true] {
            let mut device = Called::new(fails.map(|name| (name, panics)));
            let mut servo = Servo::for_device(wall(), &device).unwrap();
            let report = run(&mut servo, &mut device, fast(0.001)).unwrap();
            let expected: Vec<_> = start.iter().chain(middle).chain(&end).copied().collect();
            let mut calls = expected.clone();
            calls.dedup();
            assert_eq!(device.calls, calls, "{fails:?} {panics}");
            if !panics {
                assert_eq!(report.ending, ending);
            } else if fails.is_some() {
                assert!(matches!(report.ending, Ending::Panicked { .. }));
            }
            assert_eq!(report.is_released, fails.is_none_or(|name| name == "read"));
            assert_eq!(report.connection.watchdog, Some(0.03));
            assert_eq!(report.connection.not_closed, None);
        }
    }
}

fn lost(name: &str) -> Ending {
    Ending::DeviceLost { reason: format!("{name} fails") }
}

#[test]
fn what_cannot_be_opened_gets_no_forces_and_what_opens_in_part_is_closed() {
    for (fails, calls) in [
        ("open", &["open"][..]),
        ("watch", &["open", "watch", "close", "write", "torque", "gripper"]),
        ("enable", &["open", "watch", "enable", "close", "write", "torque", "gripper"]),
    ] {
        let mut device = Called::new(Some((fails, false)));
        let mut servo = Servo::for_device(wall(), &device).unwrap();
        let options =
            RunOptions { reconnection: Some(Reconnection::every(1.0).unwrap()), ..fast(0.01) };
        let report = run(&mut servo, &mut device, options).unwrap();
        assert_eq!(device.calls, calls);
        assert_eq!((report.ending, report.ticks), (Ending::Finished, 10));
        let connection = report.connection;
        assert_eq!((connection.losses, connection.reconnections), (1, 0));
        assert_eq!(connection.last_loss, Some(format!("{fails} fails")));
        assert!((connection.lost_time - 0.009).abs() < 1e-12, "{connection:?}");

        let mut device = Called::new(Some((fails, false)));
        let report = run(&mut servo, &mut device, fast(0.01)).unwrap();
        assert_eq!((report.ending, report.ticks), (lost(fails), 0));
        // Without reconnection the device is closed after the zeros, as at any end.
        assert_eq!(device.calls.last() == Some(&"close"), fails != "open");
    }
    let mut device = Called::new(Some(("close", false)));
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let report = run(&mut servo, &mut device, fast(0.01)).unwrap();
    assert_eq!((report.ending, report.is_released), (Ending::Finished, true));
    assert_eq!(report.connection.not_closed.as_deref(), Some("close fails"));
}

/// A hand that presses the wall by 1 mm after half a second.
fn press() -> HandPath {
    let places = [0.01, -0.003, -0.003].map(|y| Vector([0.0, y, 0.0]));
    HandPath::new(vec![0.0, 0.5, 100.0], places.to_vec(), Interpolation::Linear).unwrap()
}

fn pressing(faults: Vec<Fault>) -> SimulatedTransport<RecordedDevice> {
    SimulatedTransport::new(RecordedDevice::new(vec![press()]).unwrap(), faults).unwrap()
}

fn fault(start: f64, duration: f64, kind: FaultKind) -> Fault {
    Fault { start, duration, kind }
}

#[test]
fn a_device_that_stays_away_ends_the_run_after_the_patience() {
    let mut device = pressing(vec![fault(0.2, 0.0, FaultKind::Lost { attempts: 1000 })]);
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let patient = Reconnection::every(0.01).unwrap().with_patience(0.1).unwrap();
    let report =
        run(&mut servo, &mut device, RunOptions { reconnection: Some(patient), ..fast(1.0) })
            .unwrap();
    assert!(matches!(report.ending, Ending::DeviceLost { .. }), "{report}");
    assert!((report.duration - 0.31).abs() < 1e-9 && !report.is_released, "{report}");
    assert!((report.connection.lost_time - 0.11).abs() < 1e-9);
    assert!(Reconnection::every(0.0).is_err() && patient.with_patience(f64::NAN).is_err());
}

#[test]
fn a_thread_finds_its_device_again() {
    let device = pressing(vec![fault(0.2, 0.0, FaultKind::Lost { attempts: 3 })]);
    let servo = Servo::for_device(wall(), &device).unwrap();
    let options = ThreadOptions {
        raises_priority: false,
        duration: Some(1.0),
        reconnection: Some(Reconnection::every(0.05).unwrap()),
        ..ThreadOptions::default()
    };
    let thread = ServoThread::start_on(VirtualClock::new(), servo, Box::new(device), options);
    let report = thread.unwrap().join().report;
    assert_eq!((&report.ending, report.ticks), (&Ending::Finished, 1000));
    let connection = &report.connection;
    assert_eq!((connection.losses, connection.reconnections), (1, 1));
    assert!((connection.lost_time - 0.15).abs() < 1e-9, "{connection:?}");
    let said = format!("{report:#}");
    assert!(said.contains("lost 1 times, found again 1 times, 0.150 s without it"), "{said}");
}

/// A device that comes back as another one must not get the forces of the first.
#[derive(Debug)]
struct Swapped {
    device: SimulatedTransport<RecordedDevice>,
    profile: DeviceProfile,
}

impl Device for Swapped {
    fn points(&self) -> usize {
        self.device.points()
    }
    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.device.read(time, points)
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.device.write(forces)
    }
    fn open(&mut self) -> Result<(), DeviceLost> {
        self.device.open()?;
        if self.device.calls().opened > 1 {
            self.profile.max_force = 0.5;
        }
        Ok(())
    }
}

#[test]
fn another_device_that_bears_less_is_no_reconnection() {
    let device = pressing(vec![fault(0.2, 0.0, FaultKind::Lost { attempts: 1 })]);
    let profile = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("swapped") };
    let mut device = Swapped { device, profile };
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let options =
        RunOptions { reconnection: Some(Reconnection::every(0.01).unwrap()), ..fast(1.0) };
    let report = run(&mut servo, &mut device, options).unwrap();
    let reason = report.connection.last_loss.unwrap();
    assert!(reason.contains("max_force of 3 N, but this device has 0.5 N"), "{reason}");
    assert_eq!(report.largest_force, 0.0);
    assert_eq!((report.connection.losses, report.connection.reconnections), (1, 0));
}

/// Once each attempt that found another device began the patience anew.
#[test]
fn another_device_does_not_renew_the_patience() {
    let device = pressing(vec![fault(0.2, 0.0, FaultKind::Lost { attempts: 1 })]);
    let profile = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("swapped") };
    let mut device = Swapped { device, profile };
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let patient = Reconnection::every(0.01).unwrap().with_patience(0.05).unwrap();
    let report =
        run(&mut servo, &mut device, RunOptions { reconnection: Some(patient), ..fast(1.0) })
            .unwrap();
    assert!(matches!(report.ending, Ending::DeviceLost { .. }), "{:?}", report.ending);
    assert!((report.connection.lost_time - 0.06).abs() < 1e-9, "{:?}", report.connection);
}

/// Once the time of a loop that follows a device became infinite.
#[test]
fn a_measurement_at_no_time_is_a_stale_one() {
    for jump in [f64::INFINITY, f64::NAN] {
        let mut device = pressing(Vec::new()).pacing_at(1000.0).unwrap();
        let mut servo = Servo::for_device(wall(), &device).unwrap();
        let mut jumping = Jumping { device: &mut device, ticks: 0, jump, is_once: true };
        let options = RunOptions { pace: Pace::Device, ..RunOptions::new(0.2) };
        let report = run_on(&mut VirtualClock::new(), &mut servo, &mut jumping, options);
        let report = report.unwrap();
        assert_eq!(report.connection.stale_ticks, 1);
        assert!(report.connection.longest_gap < 0.002 + 1e-9, "{:?}", report.connection);
    }
}

#[test]
fn a_pacing_device_gives_the_time_and_the_lateness() {
    let gap = fault(0.1, 0.0105, FaultKind::Stale);
    let mut device = pressing(vec![gap]).pacing_at(500.0).unwrap();
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    assert_eq!(servo.options().rate, 500.0);
    let mut times = Vec::new();
    let mut sink = |row: &palpate_haptics::servo_loop::TraceRow| times.push(row.time_s);
    let options =
        RunOptions { pace: Pace::Device, sink: Some(&mut sink), ..RunOptions::new(1.0) };
    let report = run_on(&mut VirtualClock::new(), &mut servo, &mut device, options).unwrap();
    assert_eq!((report.ticks, report.connection.stale_ticks), (500, 6));
    for (tick, time) in times.iter().enumerate() {
        assert!((time - tick as f64 / 500.0).abs() < 1e-9, "{tick}: {time}");
    }
    // The time of the stale ticks was counted in them.
    assert_eq!(report.missed_deadlines, 0);
    assert!((report.connection.longest_gap - 0.014).abs() < 1e-9);
    assert_eq!(report.safety[0].watchdog.trips, 1);
}

#[test]
fn a_measurement_that_comes_late_is_a_late_tick() {
    let mut device = pressing(Vec::new()).pacing_at(1000.0).unwrap();
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    // A clock that stands still for a device whose times jump.
    let mut jumping = Jumping { device: &mut device, ticks: 0, jump: 0.007, is_once: false };
    let options = RunOptions { pace: Pace::Device, ..RunOptions::new(0.1) };
    let report = run_on(&mut VirtualClock::new(), &mut servo, &mut jumping, options).unwrap();
    assert_eq!(report.missed_deadlines, 1);
    assert_eq!(report.safety[0].watchdog.trips, 1);
    let lateness = report.lateness.unwrap();
    assert!((lateness.max - 0.007).abs() < 1e-4, "{lateness}");
}

/// A device of which the time of a measurement changes after 50 ticks.
struct Jumping<'a> {
    device: &'a mut SimulatedTransport<RecordedDevice>,
    ticks: u32,
    /// By so much [s].
    jump: f64,
    /// In one tick, or in all from then on.
    is_once: bool,
}

impl Device for Jumping<'_> {
    fn points(&self) -> usize {
        self.device.points()
    }
    fn profile(&self) -> &DeviceProfile {
        self.device.profile()
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.ticks += 1;
        Ok(match self.device.read(time, points)? {
            Reading::Fresh { time } if self.ticks == 51 || self.ticks > 51 && !self.is_once => {
                Reading::Fresh { time: time + self.jump }
            }
            reading => reading,
        })
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.device.write(forces)
    }
    fn paces(&self) -> bool {
        true
    }
}

#[test]
fn a_pace_or_a_rate_that_does_not_fit_is_refused() {
    let mut pacing = pressing(Vec::new()).pacing_at(500.0).unwrap();
    let mut servo = Servo::for_device(wall(), &pacing).unwrap();
    let error = run(&mut servo, &mut pacing, fast(1.0)).unwrap_err();
    assert_eq!(error, HapticsError::Pace { is_device: true });
    let said = "the device sets the pace itself: run it with `Pace::Device`";
    assert_eq!(error.to_string(), said);
    let options = RunOptions { pace: Pace::Device, ..RunOptions::new(1.0) };
    let error = run(&mut servo, &mut pressing(Vec::new()), options).unwrap_err();
    assert!(error.to_string().starts_with("the device sets no pace"), "{error}");

    for rate in [400.0, 600.0] {
        let options = ServoOptions { rate, ..palpate_haptics::ServoOptions::default() };
        let servo = Servo::new(wall(), 1, options).unwrap();
        let protection = palpate_haptics::Protection::new(pacing.profile().clone());
        let error = servo.protected(&protection).unwrap().check_device(&pacing).unwrap_err();
        assert_eq!(error, HapticsError::Rate { servo: rate, device: 500.0 });
    }
    let (slow, _driver) = MailboxDevice::new(DeviceProfile::unlimited("slow"), 1).unwrap();
    let slow = slow.with_rate(60.0);
    let servo = Servo::for_device(wall(), &slow).unwrap();
    assert_eq!((servo.options().rate, servo.check_device(&slow)), (60.0, Ok(())));
}

/// A hand that goes 2 mm into a wall within 0.5 s, by a driver with a clock of its own: of ticks in a
/// row, two had nothing new now and then. One stale tick took the force away for good.
#[test]
fn a_slow_driver_gets_the_force_that_its_rate_allows() {
    for rate in [12.0, 30.0, 60.0, 90.0, 250.0, 500.0] {
        let profile =
            DeviceProfile { mass: 0.2, least_damping: 2.0, ..DeviceProfile::unlimited("slow") };
        let (device, mut mailbox) = MailboxDevice::new(profile, 1).unwrap();
        let mut device = device.with_rate(rate);
        let mut servo = Servo::for_device(wall(), &device).unwrap();
        let stiffness = servo.accepted()[0].device_stiffness;
        let (mut ticks, mut least) = (0, f64::INFINITY);
        let mut drive = |time: f64, _: &mut dyn FnMut(usize, NextPose)| {
            let depth = (0.004 * time - 0.001).min(0.002);
            // What the passivity controller takes on the way in comes back to a hand at rest.
            if time > 2.0 {
                least = least.min(mailbox.forces()[0][1] / (stiffness * 0.002));
            }
            if ![1, 3, 4].contains(&(ticks % 9)) {
                let place = Vector([0.0, 0.002 - depth, 0.0]);
                mailbox.set(&[PointState::at_rest(place)]).unwrap();
            }
            ticks += 1;
        };
        let options = RunOptions { motion: Some(&mut drive), ..fast(4.0) };
        let report = run(&mut servo, &mut device, options).unwrap();
        assert_eq!(report.ending, Ending::Finished, "{rate} Hz");
        assert!((least - 1.0).abs() < 0.02, "{rate} Hz: {least} of the force");
    }
}

fn gripping() -> SimulatedDevice {
    let profile = (DeviceProfile {
        mass: 0.1,
        least_damping: 1.0,
        friction: 0.0,
        max_force: 3.0,
        gripper: Some(GripperProfile {
            max_force_rate: 1000.0,
            ..GripperProfile::new(0.03, 5.0)
        }),
        ..DeviceProfile::unlimited("gripping")
    })
    .with_buttons(["front", "rear"]);
    let jaws = vec![Vector::ZERO, Vector([0.02, 0.0, 0.0])];
    let jaws = HandPath::new(vec![0.0, 1.0], jaws, Interpolation::Linear).unwrap();
    let device =
        SimulatedDevice::new(profile, vec![Hand::resting(Vector([0.0, 0.1, 0.0])).unwrap()]);
    let one = Buttons::NONE.with(1);
    let presses = vec![(0.1, one), (0.2, one.with(0)), (0.3, Buttons::NONE)];
    device.unwrap().with_gripper(jaws).with_buttons(presses).unwrap()
}

#[test]
fn buttons_are_events_and_part_of_the_snapshot() {
    let device = gripping();
    let servo = Servo::for_device(wall(), &device).unwrap();
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions {
        raises_priority: false,
        duration: Some(0.5),
        ..ThreadOptions::default()
    };
    let mut thread = ServoThread::start_on(clock, servo, Box::new(device), options).unwrap();
    driver.advance(Duration::from_millis(250));
    let snapshot = thread.control().latest().unwrap();
    assert_eq!(snapshot.buttons, Buttons::NONE.with(0).with(1));
    drop(driver);
    let mut ended = thread.join();
    let mut events = Vec::new();
    while let Some(event) = ended.control.next_event() {
        events.push((event.tick, event.kind));
    }
    let (down, up) =
        (|button| EventKind::ButtonDown { button }, |button| EventKind::ButtonUp { button });
    assert_eq!(events, [(100, down(1)), (200, down(0)), (300, up(0)), (300, up(1))]);
    assert_eq!((ended.report.events.presses, ended.report.events.releases), (2, 2));
}

#[test]
fn a_gripper_gets_a_limited_force_that_stops_and_rises() {
    let device = gripping();
    let servo = Servo::for_device(wall(), &device).unwrap();
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions {
        raises_priority: false,
        duration: Some(2.0),
        ..ThreadOptions::default()
    };
    let mut thread = ServoThread::start_on(clock, servo, Box::new(device), options).unwrap();
    driver.advance(Duration::ZERO);
    let control = thread.control();
    assert!(control.set_gripper_force(f64::NAN).is_err());
    control.set_gripper_force(-20.0).unwrap();
    // By 1000 N/s, the largest rate of the gripper.
    driver.advance(Duration::from_millis(3));
    let snapshot = thread.control().latest().unwrap();
    assert!((snapshot.gripper_force + 3.0).abs() < 1e-12, "{snapshot:?}");
    let gripper = snapshot.gripper.unwrap();
    assert!((gripper.opening - 6e-5).abs() < 1e-12 && gripper.velocity == 0.02);
    driver.advance(Duration::from_millis(500));
    assert_eq!(thread.control().latest().unwrap().gripper_force, -5.0);
    thread.control().stop_switch().stop();
    driver.advance(Duration::from_millis(1));
    assert_eq!(thread.control().latest().unwrap().gripper_force, 0.0);
    thread.control().stop_switch().release();
    // By 20 N/s after a stop.
    driver.advance(Duration::from_millis(10));
    let force = thread.control().latest().unwrap().gripper_force;
    assert!((force + 0.2).abs() < 1e-12, "{force} N");
    drop(driver);
    assert!(thread.join().report.is_released);
}

#[test]
fn without_a_state_a_gripper_has_no_force() {
    let device = gripping();
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let states = [PointState::at_rest(Vector([0.0, 0.1, 0.0]))];
    servo.set_gripper_force(3.0);
    servo.set_gripper(Some(GripperState::at_rest(0.01)));
    for _ in 0..200 {
        servo.step(&states);
    }
    assert_eq!(servo.gripper_force(), 3.0);
    servo.set_reading(Reading::NotReady);
    servo.step(&states);
    assert_eq!(servo.gripper_force(), 0.0);
    servo.set_gripper(None);
    for _ in 0..200 {
        servo.step(&states);
    }
    assert_eq!(servo.gripper_force(), 0.0);
    let other = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("none") };
    let (other, _driver) = MailboxDevice::new(other, 1).unwrap();
    let error = servo.check_device(&other).unwrap_err();
    assert!(error.to_string().contains("gripper_max_force of 5 N"), "{error}");
}

#[test]
fn a_driver_that_is_not_ready_is_waited_for_and_its_repeats_are_counted() {
    let profile = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("mail") };
    let (device, mut mailbox) = MailboxDevice::new(profile, 1).unwrap();
    let mut device = device.with_watchdog(Duration::from_millis(20));
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let mut sets = |time: f64, _: &mut dyn FnMut(usize, NextPose)| {
        // From the tenth tick on every second tick has a new state.
        let tick = (time * 1000.0).round() as u32;
        if tick >= 10 && tick.is_multiple_of(2) {
            let y = 0.05 - time;
            mailbox.set_at(time, &[PointState::at_rest(Vector([0.0, y, 0.0]))]).unwrap();
        }
    };
    let options = RunOptions { motion: Some(&mut sets), ..fast(0.04) };
    let report = run(&mut servo, &mut device, options).unwrap();
    // What is set in a tick is read in the next.
    let connection = &report.connection;
    assert_eq!((connection.not_ready_ticks, connection.stale_ticks), (11, 14));
    assert!((connection.longest_gap - 0.002).abs() < 1e-12, "{connection:?}");
    assert_eq!(connection.watchdog, Some(0.02));
    assert_eq!(report.safety[0].watchdog.trips, 0);
    assert!(!mailbox.is_enabled() && mailbox.ticks() == 41);
}

#[test]
fn a_transport_counts_the_calls_around_a_run() {
    let mut device = pressing(vec![fault(0.1, 0.0, FaultKind::Lost { attempts: 2 })]);
    let mut servo = Servo::for_device(wall(), &device).unwrap();
    let options =
        RunOptions { reconnection: Some(Reconnection::every(0.01).unwrap()), ..fast(0.2) };
    run(&mut servo, &mut device, options).unwrap();
    let Calls { opened, failed, enabled, closed, .. } = device.calls();
    assert_eq!((opened, failed, enabled, closed), (2, 1, 2, 2));
}
