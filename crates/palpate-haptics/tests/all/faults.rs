// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a servo promises, through a transport that jitters, repeats, drops, delays and loses.

use arbitrary::{Result, Unstructured};
use palpate_device::{
    Device, DeviceLost, DeviceProfile, PROFILES, PointState, Reading, profile_named,
};
use palpate_field::kernel::HalfSpace;
use palpate_field::{Shape, Vector};
use palpate_haptics::servo_loop::{
    Ending, Pace, Reconnection, Recorder, RunOptions, RunReport, TraceRow, VirtualClock, run_on,
};
use palpate_haptics::{Bodies, Body, Probe, Protection, Servo, ServoOptions, Surface};
use palpate_sim::{
    Fault, FaultKind, Hand, HandPath, Interpolation, SimulatedDevice, SimulatedTransport,
};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;
use std::time::Duration;

const RATE: f64 = 1000.0;
const PERIOD: f64 = 1.0 / RATE;

/// How fast a force may come back [N/s].
const RISE: f64 = 20.0;

/// When the hand rests on the wall [s].
const AT_REST: f64 = 2.0;

/// How long a wall may take to come back [s].
const BACK: f64 = 2.0;

/// A device that keeps what is written to it.
struct Seen<T> {
    device: T,
    forces: Vec<Vector<f64, 3>>,
}

impl<T: Device> Device for Seen<T> {
    fn points(&self) -> usize {
        self.device.points()
    }
    fn profile(&self) -> &DeviceProfile {
        self.device.profile()
    }
    fn read(
        &mut self,
        time: f64,
        points: &mut [PointState],
    ) -> std::result::Result<Reading, DeviceLost> {
        self.device.read(time, points)
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> std::result::Result<(), DeviceLost> {
        self.forces.push(forces[0]);
        self.device.write(forces)
    }
    fn open(&mut self) -> std::result::Result<(), DeviceLost> {
        self.device.open()
    }
    fn set_watchdog(
        &mut self,
        time: Duration,
    ) -> std::result::Result<Option<Duration>, DeviceLost> {
        self.device.set_watchdog(time)
    }
    fn enable(&mut self) -> std::result::Result<(), DeviceLost> {
        self.device.enable()
    }
    fn close(&mut self) -> std::result::Result<(), DeviceLost> {
        self.device.close()
    }
    fn rate(&self) -> Option<f64> {
        self.device.rate()
    }
    fn paces(&self) -> bool {
        self.device.paces()
    }
}

/// A hand that presses a wall of all the stiffness that its device renders.
struct Held {
    servo: Servo,
    device: Seen<SimulatedTransport<SimulatedDevice>>,
    stiffness: f64,
    /// The force at which wall and hand rest [N].
    at_rest: f64,
}

/// What a run did.
struct Felt {
    report: RunReport,
    rows: Vec<TraceRow>,
}

impl Held {
    /// A hand of this grip [N/m] that presses with `part` of what the device bears for long.
    fn new(profile: &DeviceProfile, [grip, part]: [f64; 2], faults: Vec<Fault>) -> Self {
        let radius = 0.002;
        let wall =
            Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), -radius).unwrap());
        let wall = Body::new(wall, Surface::smooth(1e5, 0.0).unwrap()).unwrap();
        let options = ServoOptions {
            rate: RATE,
            probe: Probe::new(radius).unwrap(),
            max_force: f64::INFINITY,
            ..ServoOptions::default()
        };
        let bodies = Bodies::new(vec![wall]).unwrap();
        let servo = Servo::new(bodies, 1, options).unwrap();
        let servo = servo.protected(&Protection::new(profile.clone())).unwrap();
        let stiffness = servo.bodies().bodies()[0].surface().stiffness();
        let at_rest = part * profile.max_force.min(profile.continuous_force);
        let way = [0.01, -at_rest / stiffness - at_rest / grip].map(|y| Vector([0.0, y, 0.0]));
        let path = HandPath::new(vec![0.0, 0.5], way.to_vec(), Interpolation::Linear).unwrap();
        let hand = Hand::new(path).with_spring(grip, 5.0).unwrap();
        let device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
        let device = SimulatedTransport::new(device, faults).unwrap();
        Self { servo, device: Seen { device, forces: Vec::new() }, stiffness, at_rest }
    }

    /// The same at the pace of the device.
    fn paced(mut self) -> Self {
        self.device.device = self.device.device.pacing_at(RATE).unwrap();
        self
    }

    fn run(&mut self, duration: f64) -> Felt {
        let mut recorder = Recorder::new((duration * RATE) as usize + 1);
        let pace = if self.device.paces() { Pace::Device } else { Pace::RealTime };
        let options = RunOptions {
            pace,
            recorder: Some(&mut recorder),
            reconnection: Some(Reconnection::every(0.02).unwrap()),
            ..RunOptions::new(duration)
        };
        let clock = &mut VirtualClock::new();
        let report = run_on(clock, &mut self.servo, &mut self.device, options).unwrap();
        Felt { report, rows: recorder.rows().to_vec() }
    }

    /// What rises after `begin` [s] faster than a force may that was zeroed before, until it has
    /// caught up with the wall.
    fn too_fast(&self, rows: &[TraceRow], begin: f64) -> Option<String> {
        let gentle = RISE * PERIOD * (1.0 + 1e-9);
        let mut is_rising = false;
        for pair in rows.windows(2) {
            let [before, after] = [0, 1].map(|i| pair[i].force.norm());
            is_rising |= before == 0.0;
            is_rising &= after < 0.999 * self.full(&pair[1]);
            if is_rising && pair[0].time_s >= begin && after - before > gentle {
                return Some(format!("{before} N, then {after} N at {} s", pair[1].time_s));
            }
        }
        None
    }

    /// The force of the spring at the depth of a row, up to the device's largest [N].
    fn full(&self, row: &TraceRow) -> f64 {
        let depth = if row.contact { (row.proxy - row.device).norm() } else { 0.0 };
        (self.stiffness * depth).min(self.device.profile().max_force)
    }
}

fn fault(u: &mut Unstructured<'_>) -> Result<Fault> {
    let start = AT_REST + draw::within(u, 0.0, 0.6)?;
    let duration = draw::within(u, 0.001, 0.3)?;
    let kind = match u.int_in_range(0..=5_u8)? {
        0 => FaultKind::Stale,
        1 => FaultKind::NotReady,
        2 => FaultKind::Delay { ticks: u.int_in_range(1..=3)? },
        3 => FaultKind::Glitch { distance: draw::within(u, -0.05, 0.05)? },
        4 => FaultKind::Lost { attempts: u.int_in_range(1..=10)? },
        _ => FaultKind::Jitter { most: draw::within(u, 1e-5, 4e-4)? },
    };
    Ok(Fault { start, duration, kind })
}

/// When the last of these faults is over [s].
fn end_of(faults: &[Fault]) -> f64 {
    let end = |fault: &Fault| match fault.kind {
        FaultKind::Lost { attempts } => fault.start + 0.02 * f64::from(attempts),
        _ => fault.start + fault.duration,
    };
    faults.iter().map(end).fold(0.0, f64::max)
}

/// What the servo promises for any input: forces within the limits of the device, that change no
/// faster than it bears but for falls to zero, and zero last.
fn broken_limits(forces: &[Vector<f64, 3>], profile: &DeviceProfile) -> Option<String> {
    if forces.last() != Some(&Vector::ZERO) {
        return Some(format!("last was {:?}", forces.last()));
    }
    let most = profile.max_force * (1.0 + 1e-12);
    let change = profile.max_force_rate * PERIOD * (1.0 + 1e-9);
    let mut last = Vector::ZERO;
    for (tick, force) in forces.iter().enumerate() {
        // Written so that NaN is broken.
        let holds = force.norm() <= most
            && (*force == Vector::ZERO || (*force - last).norm() <= change);
        if !holds {
            return Some(format!("{last:?} N, then {force:?} N in tick {tick}"));
        }
        last = *force;
    }
    None
}

/// Walls of every device, in every grip, through random faults, at the pace of the clock and of the
/// device: the limits hold always, and the wall comes back gently when the faults are over.
#[test]
fn the_servo_keeps_its_promises_through_faults() {
    cases::numbered(192, |seed, u| {
        let (_, profile) = &PROFILES[seed % PROFILES.len()];
        if profile.max_force == f64::INFINITY {
            return Ok(Ok(()));
        }
        let grip = 10.0_f64.powf(draw::within(u, 2.0, 3.0)?);
        let part = draw::within(u, 0.1, 0.8)?;
        let mut faults = Vec::new();
        for _ in 0..u.int_in_range(1..=3)? {
            faults.push(fault(u)?);
        }
        let mut held = Held::new(profile, [grip, part], faults.clone());
        if u.arbitrary()? {
            held = held.paced();
        }
        let end = end_of(&faults);
        let felt = held.run(end + BACK + 0.01);
        let told = format!(
            "{} with {grip:.0} N/m at {part:.2}, paced {}, {faults:?}",
            profile.name,
            held.device.paces()
        );
        let fail = |what: String| Ok(Err(format!("{what}: {told}")));
        if felt.report.ending != Ending::Finished || !felt.report.is_released {
            return fail(format!("{}", felt.report));
        }
        if let Some(broken) = broken_limits(&held.device.forces, profile) {
            return fail(broken);
        }
        let losses = faults.iter().filter(|f| matches!(f.kind, FaultKind::Lost { .. })).count();
        let connection = &felt.report.connection;
        if connection.losses > losses as u64 || connection.reconnections != connection.losses {
            return fail(format!("{connection:?}"));
        }
        // A stiff wall behind a delay gives out energy that the servo does not see, and that its
        // controller takes back later.
        if faults.iter().any(|fault| matches!(fault.kind, FaultKind::Delay { .. })) {
            return Ok(Ok(()));
        }
        if let Some(too_fast) = held.too_fast(&felt.rows, end) {
            return fail(too_fast);
        }
        let (force, full) = felt.rows.last().map(|r| (r.force.norm(), held.full(r))).unwrap();
        // Where a stiff wall oscillates through jitter, it is softer: the hand is deeper, and feels
        // the force of a hand at rest all the same.
        let part = felt.report.safety.iter().map(|point| point.limit_cycles.least_part);
        let full = part.fold(full, |full, part| full.min(full * part));
        // Friction of the device may hold the hand on its way out.
        if force < 0.9 * full || force < 0.9 * held.at_rest - profile.friction {
            return fail(format!("not back: {force} of {full} N, {} N at rest", held.at_rest));
        }
        Ok(Ok(()))
    });
}

/// Repeats looked like a hand at rest: after 20 of them the force jumped from 0 to 6 N.
#[test]
fn repeats_do_not_kick() {
    for (name, profile) in PROFILES.iter().filter(|(_, p)| p.max_force < f64::INFINITY) {
        for ticks in [1_u32, 3, 4, 20, 200] {
            let duration = f64::from(ticks) * PERIOD;
            let repeats =
                Fault { start: AT_REST - 0.5 * PERIOD, duration, kind: FaultKind::Stale };
            let mut held = Held::new(profile, [300.0, 0.5], vec![repeats]);
            let felt = held.run(AT_REST + 0.5);
            assert_eq!(felt.report.connection.stale_ticks, u64::from(ticks), "{name}");
            let gap = felt.report.connection.longest_gap;
            assert!((gap - f64::from(ticks + 1) * PERIOD).abs() < 1e-9, "{name}: {gap}");
            let at = (AT_REST * RATE) as usize;
            if ticks < 5 {
                for rows in felt.rows[at - 1..].windows(2) {
                    let change = (rows[1].force - rows[0].force).norm();
                    assert!(change < 0.1, "{name}, {ticks}: {change} N in a tick");
                }
            } else {
                let told = held.too_fast(&felt.rows, felt.rows[at + ticks as usize].time_s);
                assert_eq!(told, None, "{name}, {ticks}");
            }
            // The force is held while the watchdog of the safety chain bears it, and gone then.
            let force = |tick: usize| felt.rows[at + tick].force.norm();
            let before = force(0);
            if ticks < 5 {
                assert!((force(ticks as usize) - before).abs() < 0.1, "{name}, {ticks}");
            } else if ticks == 200 {
                assert_eq!(force(100), 0.0, "{name}");
            }
        }
    }
}

/// A moving hand whose readings repeat has the velocity that it had, and the real one afterwards.
#[test]
fn velocities_are_over_real_times() {
    let profile = profile_named("omega").unwrap();
    let step = profile.encoder_step;
    let way = [0.05, 0.03].map(|y| Vector([0.0, y, 0.0]));
    let path = HandPath::new(vec![0.0, 1.0], way.to_vec(), Interpolation::Linear).unwrap();
    let hand = Hand::new(path).with_spring(5000.0, 20.0).unwrap();
    let device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
    let jitter = Fault { start: 0.0, duration: 1.0, kind: FaultKind::Jitter { most: 4e-4 } };
    let repeats = [0.3, 0.5, 0.6].map(|start| {
        let kind = FaultKind::Stale;
        Fault { start, duration: 0.0045, kind }
    });
    let faults = repeats.into_iter().chain([jitter]).collect();
    let mut device = SimulatedTransport::new(device, faults).unwrap().with_seed(7);
    let mut servo =
        Servo::for_device(Shape::half_space([0.0, 1.0], 0.0).unwrap(), &device).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    for tick in 0..900 {
        let reading = device.read(f64::from(tick) * PERIOD, &mut points).unwrap();
        servo.set_reading(reading);
        let velocity = servo.step(&points)[0].velocity[1];
        if tick > 100 {
            // A step over the window of 16 readings, which lie at least 0.2 ms apart.
            let most = step / (15.0 * PERIOD) + 1e-3;
            assert!((velocity + 0.02).abs() < most, "{tick}: {velocity} m/s");
        }
    }
}

/// The servo's account of energy is that of the device, whatever the times of the readings.
#[test]
fn energies_are_over_real_times() {
    let profile = profile_named("omega").unwrap();
    for most in [0.0, 2e-4, 4e-4] {
        let jitter = Fault { start: 0.0, duration: 10.0, kind: FaultKind::Jitter { most } };
        let mut held = Held::new(&profile, [300.0, 0.5], vec![jitter]).paced();
        let felt = held.run(3.0);
        let seen = felt.report.safety[0].passivity;
        let given = held.device.device.device().energy_given();
        let counted = seen.energy_out - seen.energy_in;
        // An encoder step of way at the largest force.
        let most = profile.encoder_step * profile.max_force;
        assert!((given - counted).abs() < most, "{given} J, counted as {counted} J");
        assert!(given < 0.0, "a wall that is pressed takes energy in");
    }
}

#[test]
fn a_device_that_hangs_takes_its_force_away_itself() {
    let profile = profile_named("omega").unwrap();
    let away = FaultKind::Lost { attempts: 20 };
    let lost = Fault { start: AT_REST, duration: 0.0, kind: away };
    let mut held = Held::new(&profile, [300.0, 0.5], vec![lost]);
    let felt = held.run(AT_REST + 1.0);
    let connection = &felt.report.connection;
    assert_eq!((connection.watchdog, connection.losses), (Some(0.03), 1));
    assert!((connection.lost_time - 20.0 * 0.02).abs() < 1e-9, "{connection:?}");
    let transport = &held.device.device;
    assert_eq!(transport.device().watchdog_trips(), 1);
    let calls = transport.calls();
    assert_eq!((calls.opened, calls.failed, calls.enabled, calls.closed), (2, 19, 2, 2));
}
