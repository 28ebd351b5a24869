// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A wall comes back after its force was zeroed while a hand held on.

use arbitrary::{Result, Unstructured};
use palpate_device::{Device, DeviceProfile, PROFILES, PointState, profile_named};
use palpate_field::kernel::HalfSpace;
use palpate_field::{Shape, Vector};
use palpate_haptics::{Bodies, Body, Probe, Protection, Servo, ServoOptions, Surface};
use palpate_safety::Recovery;
use palpate_sim::{Hand, HandPath, Interpolation, SimulatedDevice};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;

const RATE: f64 = 1000.0;
const PERIOD: f64 = 1.0 / RATE;

/// [N/m]: more than any device renders.
const WANTED: f64 = 1e5;

/// How far a glitch is off [m].
const GLITCH: f64 = 0.05;

/// How fast a force may come back [N/s].
const RISE: f64 = 20.0;

/// How far an edit carries the probe: its radius [µm].
const CARRIED: u32 = 2000;

/// The most by which a force changes in a tick after such an edit [N], and for how many ticks at most: as
/// many as the largest force of a device needs.
const EDITED: f64 = 0.3;
const EDITED_TICKS: u32 = 130;

/// A hand that presses a wall through the safety chain of a device.
struct Held {
    device: SimulatedDevice,
    servo: Servo,
    tick: u32,
    /// Where the hand wants to be [m].
    target: Vector<f64, 3>,
    grip: f64,
    /// Of the wall [m].
    height: f64,
    is_lost: bool,
    /// How far the readings are below the device [m].
    off: f64,
}

/// The force on the hand.
#[derive(Clone, Copy, Debug)]
struct Felt {
    /// [N]
    force: f64,
    /// That of the spring at the hand's depth, up to the device's largest force [N].
    full: f64,
}

fn wall(stiffness: f64, height: f64) -> Bodies {
    let half_space = HalfSpace::new(Vector([0.0, 1.0, 0.0]), height - 0.002).unwrap();
    let surface = Surface::smooth(stiffness, 0.0).unwrap();
    Bodies::new(vec![Body::new(Shape::from_kernel(half_space), surface).unwrap()]).unwrap()
}

/// A device whose hand goes from one place to another in half a second.
fn held_at(
    profile: &DeviceProfile,
    from: Vector<f64, 3>,
    to: Vector<f64, 3>,
    grip: f64,
) -> SimulatedDevice {
    let path = HandPath::new(vec![0.0, 0.5], vec![from, to], Interpolation::Linear).unwrap();
    let hand = Hand::new(path).with_spring(grip, 5.0).unwrap();
    SimulatedDevice::new(profile.clone(), vec![hand]).unwrap()
}

impl Held {
    /// A wall at height zero, and a hand with a `grip` [N/m] that wants to be so far below it that the
    /// wall gives `part` of the force that the device bears for long when both rest.
    fn new(profile: &DeviceProfile, protection: Protection, grip: f64, part: f64) -> Self {
        let options = ServoOptions {
            rate: RATE,
            probe: Probe::new(0.002).unwrap(),
            max_force: f64::INFINITY,
            ..ServoOptions::default()
        };
        let servo = Servo::new(wall(WANTED, 0.0), 1, options).unwrap();
        let servo = servo.protected(&protection).unwrap();
        let stiffness = servo.bodies().bodies()[0].surface().stiffness();
        let at_rest = part * profile.max_force.min(profile.continuous_force);
        let target = Vector([0.0, -at_rest / stiffness - at_rest / grip, 0.0]);
        let device = held_at(profile, target, target, grip);
        Self { device, servo, tick: 0, target, grip, height: 0.0, is_lost: false, off: 0.0 }
    }

    fn stiffness(&self) -> f64 {
        self.servo.bodies().bodies()[0].surface().stiffness()
    }

    /// The force at which wall and hand rest: that of two springs in series [N].
    fn at_rest(&self) -> f64 {
        let springs = 1.0 / (1.0 / self.stiffness() + 1.0 / self.grip);
        springs * (self.height - self.target[1])
    }

    /// Puts the hand above the wall, from where it comes down within half a second.
    fn start_outside(&mut self) {
        let above = Vector([0.0, self.height + 0.01, 0.0]);
        self.device = held_at(self.device.profile(), above, self.target, self.grip);
        self.tick = 0;
        self.step();
    }

    fn step(&mut self) -> Felt {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        self.device.read(f64::from(self.tick) * PERIOD, &mut points).unwrap();
        points[0].position[1] -= self.off;
        if self.is_lost {
            points[0].position = Vector([f64::NAN; 3]);
        }
        let touch = self.servo.step(&points)[0];
        self.device.write(self.servo.forces()).unwrap();
        self.tick += 1;
        let full = (self.stiffness() * touch.depth()).min(self.device.profile().max_force);
        Felt { force: touch.force.norm(), full }
    }

    fn run(&mut self, ticks: u32) -> Felt {
        let last = self.step();
        (1..ticks).fold(last, |_, _| self.step())
    }
}

/// The least credit that counts as such [J].
const NOTICED: f64 = 1e-4;

/// What zeroes a force.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// No tick came for so many.
    Stall(u32),
    /// Every tick comes two periods late.
    Late(u32),
    /// Stopped for so many ticks, then released.
    Stop(u32),
    /// The device is lost for so many ticks: its readings are no numbers.
    Lost(u32),
    /// The encoders are off by 50 mm for so many ticks.
    Glitch(u32),
    /// The bodies are swapped, and the wall is higher by so much [µm].
    Swap(u32),
}

fn fault(u: &mut Unstructured<'_>) -> Result<Fault> {
    let ticks = u.int_in_range(1..=300)?;
    Ok(match u.int_in_range(0..=5_u8)? {
        0 => Fault::Stall(ticks),
        1 => Fault::Late(ticks),
        2 => Fault::Stop(ticks),
        3 => Fault::Lost(ticks),
        4 => Fault::Glitch(1 + ticks / 10),
        _ => Fault::Swap(10 * ticks),
    })
}

impl Held {
    fn suffer(&mut self, fault: Fault) {
        match fault {
            Fault::Stall(ticks) => {
                // The device holds the force, and the hand goes on.
                self.tick += ticks;
                self.servo.set_late(f64::from(ticks) * PERIOD);
                self.step();
                self.servo.set_late(0.0);
            }
            Fault::Late(ticks) => {
                self.servo.set_late(2.0 * PERIOD);
                for _ in 0..ticks {
                    self.tick += 2;
                    self.step();
                }
                self.servo.set_late(0.0);
            }
            Fault::Stop(ticks) => {
                self.servo.stop(true);
                self.run(ticks);
                self.servo.stop(false);
            }
            Fault::Lost(ticks) => {
                self.is_lost = true;
                self.run(ticks);
                self.is_lost = false;
            }
            Fault::Glitch(ticks) => {
                self.off = GLITCH;
                self.run(ticks);
                self.off = 0.0;
            }
            Fault::Swap(micrometres) => {
                self.height += 1e-6 * f64::from(micrometres);
                let mut accepted = self.servo.accept(wall(WANTED, self.height)).unwrap();
                self.servo.replace_bodies(&mut accepted).unwrap();
            }
        }
    }
}

/// The wall of every device comes back to every grip within two seconds, gently, and never
/// pushes harder than it does at rest. One that was raised by an edit comes by 0.3 N a tick.
#[test]
fn walls_come_back_after_faults() {
    cases::numbered(96, |seed, u| {
        let (_, profile) = &PROFILES[seed % PROFILES.len()];
        if profile.max_force == f64::INFINITY {
            return Ok(Ok(()));
        }
        let grip = 10.0_f64.powf(draw::within(u, 2.0, 3.0)?);
        let part = draw::within(u, 0.1, 0.9)?;
        let mut held = Held::new(profile, Protection::new(profile.clone()), grip, part);
        if u.arbitrary()? {
            held.start_outside();
        }
        held.run(2000);
        let mut faults = Vec::new();
        for k in 0..u.int_in_range(1..=3)? {
            if k > 0 {
                held.run(u.int_in_range(1..=300)?);
            }
            faults.push(fault(u)?);
            held.suffer(faults[k]);
        }
        let at_rest = held.at_rest();
        if at_rest > 0.9 * profile.continuous_force.min(profile.max_force) {
            return Ok(Ok(()));
        }
        let mut told = format!("{} with {grip:.0} N/m at {part:.2}, {faults:?}", profile.name);
        let fail = |what: &str, felt: Felt| Ok(Err(format!("{what}: {felt:?} of {told}")));
        let mut last = held.step();
        let mut has_risen = false;
        let is_carried = |fault: &Fault| matches!(fault, Fault::Swap(way) if *way <= CARRIED);
        let is_edited = faults.iter().any(is_carried);
        for tick in 0..2000 {
            let felt = held.step();
            has_risen |= felt.force >= 0.999 * felt.full;
            let follows = is_edited && tick < EDITED_TICKS;
            let most = if follows { EDITED } else { RISE * PERIOD };
            if !has_risen && felt.force - last.force > most * (1.0 + 1e-9) {
                return fail("too fast", felt);
            }
            if felt.force > felt.full * (1.0 + 1e-9) {
                return fail("harder than at rest", felt);
            }
            last = felt;
        }
        // Friction of the device may hold the hand on its way out.
        let most_held = 0.1 * at_rest + profile.friction;
        if last.force < 0.9 * last.full || last.force < at_rest - most_held {
            return fail("not back", last);
        }
        let passivity = held.servo.safety()[0].passivity;
        let net = passivity.energy_out - passivity.energy_in;
        // In a glitch the device is not seen: a held force may do work that nobody counts.
        let is_seen = !faults.iter().any(|fault| matches!(fault, Fault::Glitch(_)));
        if is_seen && net > passivity.credited + 1e-3 {
            told += &format!(", {passivity:?}");
            return Ok(Err(format!("energy from nowhere: {told}")));
        }
        Ok(Ok(()))
    });
}

/// As CHAI3D's `setWaitForSmallForce`.
#[test]
fn a_wall_may_wait_until_the_hand_is_out() {
    let profile = profile_named("omega").unwrap();
    let protection = Protection::new(profile.clone()).with(|s| s.recovery = Recovery::OnceOut);
    let mut held = Held::new(&profile, protection, 300.0, 0.5);
    held.start_outside();
    assert!(held.run(2000).force > 0.45 * profile.max_force);
    held.suffer(Fault::Stop(50));
    assert_eq!(held.run(3000).force, 0.0);
    let credited = held.servo.safety()[0].passivity.credited;
    assert!(credited < NOTICED, "{credited}");
    held.start_outside();
    assert!(held.run(2000).force > 0.45 * profile.max_force);
}

/// Once a glitch of three ticks kicked with all the force that the device has.
#[test]
fn a_glitch_of_the_encoders_cannot_kick() {
    for (name, profile) in PROFILES.iter().filter(|(_, p)| p.max_force < f64::INFINITY) {
        let mut held = Held::new(profile, Protection::new(profile.clone()), 300.0, 0.5);
        held.start_outside();
        let before = held.run(3000).force;
        for off in [GLITCH, -GLITCH] {
            held.off = off;
            for tick in 0..6 {
                held.off = if tick < 3 { off } else { 0.0 };
                let force = held.step().force;
                assert!((force - before).abs() < 0.1, "{name}: {before} N, then {force} N");
            }
        }
        assert_eq!(held.servo.safety()[0].readings.held, 6);
    }
}
