// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Orientations that no hand can have made: held back, counted, without a kick.

use arbitrary::{Result, Unstructured};
use assert_no_alloc::assert_no_alloc;
use palpate_device::{DeviceProfile, PROFILES, PointState, Reading, TurnState, TurningProfile};
use palpate_field::{Rotation, Vector};
use palpate_haptics::{Protection, Servo, ServoOptions, Shell, Surface, Tool, ToolOptions};
use palpate_safety::TurnReadings;
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;

use crate::common::tools::smooth;
use crate::common::{body, half_space};

const PERIOD: f64 = 1e-3;

/// Half the length of the rod [m].
const HALF: f64 = 0.05;

/// Where the hand holds the rod [m]: so low that its lower end is in the ground.
const HEIGHT: f64 = 0.01;

/// How the rod leans at rest [rad].
const LEAN: Vector<f64, 3> = Vector([0.0, 0.0, -0.3]);

/// A rod along x whose right end leans into the ground, in a hand on a device.
struct Held {
    servo: Servo,
    /// Of the coupling, as accepted [N·m/rad].
    stiffness: f64,
    tick: u32,
}

impl Held {
    /// Whose torque rises as fast as the device lets it.
    fn new(profile: &DeviceProfile) -> Self {
        Self::with(Protection::new(profile.clone()).with(|s| s.rise_rate = f64::INFINITY))
    }

    fn with(protection: Protection) -> Self {
        let ground = body(half_space([0.0, 1.0, 0.0], 0.0), Surface::new(&smooth()).unwrap());
        let end = Vector::unit(0) * HALF;
        let options = ToolOptions {
            stiffness: 500.0,
            angular_stiffness: Some(0.3),
            damping: 0.0,
            max_force: Some(f64::INFINITY),
            max_torque: f64::INFINITY,
            ..ToolOptions::default()
        };
        let rod = Tool::new(Shell::capsule([-end, end], 1e-4, 2).unwrap(), options).unwrap();
        let free = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
        let servo = Servo::with_tool(ground, rod, free).unwrap();
        let servo = servo.protected(&protection).unwrap();
        let about = servo.accepted().get(1);
        let stiffness = about.map_or(0.0, |accepted| accepted.device_stiffness);
        Self { servo, stiffness, tick: 0 }
    }

    /// A tick with the rod turned so, at its height; it allocates nothing.
    fn step(&mut self, orientation: Rotation<3>) -> Vector<f64, 3> {
        self.step_at(HEIGHT, orientation)
    }

    fn step_at(&mut self, height: f64, orientation: Rotation<3>) -> Vector<f64, 3> {
        self.servo.set_reading(Reading::Fresh { time: f64::from(self.tick) * PERIOD });
        self.servo.set_turn(Some(TurnState::at_rest(orientation)));
        let states = [PointState::at_rest(Vector([0.0, height, 0.0]))];
        assert_no_alloc(|| {
            self.servo.step(&states);
        });
        self.tick += 1;
        self.servo.torque()
    }

    /// Comes down and leans, slowly.
    fn leaning(mut self) -> Self {
        for tick in 0..=1000 {
            let part = (f64::from(tick) / 500.0).min(1.0);
            let height = 0.06 + (HEIGHT - 0.06) * part;
            self.step_at(height, Rotation::identity().turned(LEAN * part));
        }
        self
    }

    fn held_back(&self) -> (u64, u64) {
        let readings = self.servo.safety()[0].readings;
        (readings.held, readings.turns_held)
    }
}

fn leaning() -> Rotation<3> {
    Rotation::identity().turned(LEAN)
}

fn with_torques() -> impl Iterator<Item = &'static (&'static str, DeviceProfile)> {
    let gives = |turning: &TurningProfile| turning.max_torque > 0.0;
    PROFILES.iter().filter(move |(_, profile)| profile.turning.as_ref().is_some_and(gives))
}

/// Once it kicked with the torque of the whole angle, as fast as the slew limit lets it.
#[test]
fn a_quarter_turn_for_three_ticks_cannot_kick() {
    for (name, profile) in with_torques() {
        let mut held = Held::new(profile).leaning();
        let before = held.step(leaning());
        assert!(before.norm() > 0.01, "{name}: {before:?}");
        for (axis, angle) in [(0, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            let quarter = Vector::unit(axis) * (angle * std::f64::consts::FRAC_PI_2);
            for tick in 0..6 {
                let read = if tick < 3 { leaning().turned(quarter) } else { leaning() };
                let torque = held.step(read);
                let kick = (torque - before).norm();
                assert!(kick < 1e-3, "{name}: {before:?} N·m, then {torque:?} N·m");
            }
        }
        assert_eq!(held.held_back(), (0, 12), "{name}");
        let farthest = held.servo.safety()[0].readings.farthest_turn;
        assert!((farthest - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{name}: {farthest}");
    }
}

/// The tool keeps its orientation and the contact point its place, on a device without torques too.
#[test]
fn a_glitch_moves_no_tool_on_a_device_that_senses_turns_alone() {
    let (_, profile) = PROFILES.iter().find(|(name, _)| *name == "omega6").unwrap();
    let mut held = Held::new(profile).leaning();
    held.step(leaning());
    let (before, force) = (held.servo.held_tool().unwrap().pose, held.servo.forces()[0]);
    assert!(force.norm() > 0.1, "{force:?}");
    for _ in 0..3 {
        held.step(leaning().turned(Vector([0.0, 0.0, 1.5])));
        let after = held.servo.held_tool().unwrap().pose;
        assert!(before.rotation.turn_to(&after.rotation).norm() < 1e-6);
        assert!((held.servo.forces()[0] - force).norm() < 1e-3);
    }
    assert_eq!(held.held_back(), (0, 3));
}

/// What lasts is where the hand is: the torque falls meanwhile, and rises gently again.
#[test]
fn an_orientation_that_stays_is_taken_up_by_the_ramp() {
    let (_, profile) = with_torques().find(|(name, _)| *name == "sigma7").unwrap();
    let mut held = Held::with(Protection::new(profile.clone())).leaning();
    let before = held.step(leaning()).norm();
    let turned = leaning().turned(Vector([0.0, 0.0, -0.9]));
    let torques: Vec<_> = (0..1000).map(|_| held.step(turned).norm()).collect();
    // 0.9 rad at 50 rad/s.
    assert_eq!(held.held_back(), (0, 17));
    assert_eq!(held.servo.safety()[0].turning.as_ref().unwrap().watchdog.trips, 1);
    assert!(torques[..4].iter().all(|torque| *torque == before), "{torques:?}");
    assert!(torques[16] < 0.4 * before, "{torques:?}");
    // As the force by 20 N/s, at the length of a radian that the coupling has.
    let unit = (held.stiffness / held.servo.accepted()[0].device_stiffness).sqrt();
    let gently = 20.0 * unit * PERIOD * (1.0 + 1e-9);
    assert!(torques.windows(2).all(|pair| pair[1] - pair[0] <= gently), "{torques:?}");
    assert!(torques[999] > 2.0 * before, "{}", torques[999]);
}

/// The part of the limits that leaves room for rounding.
const WITHIN: f64 = 1.0 - 1e-9;

/// A rotation with an angular speed and acceleration of at most those of the profile, about axes that
/// change; its angular velocity is linear within each of the `parts` of a tick.
struct Swing {
    orientation: Rotation<3>,
    angular_velocity: Vector<f64, 3>,
    max_speed: f64,
    max_acceleration: f64,
}

impl Swing {
    /// One tick with an angular acceleration along `push`, of at most unit length.
    fn step(&mut self, push: Vector<f64, 3>, parts: u32) {
        let part = PERIOD / f64::from(parts);
        for _ in 0..parts {
            let wanted = self.angular_velocity + push * (self.max_acceleration * part);
            let next = if wanted.norm() > self.max_speed {
                // Shortening to a ball moves two points no farther apart.
                wanted * (self.max_speed / wanted.norm())
            } else {
                wanted
            };
            let mean = (self.angular_velocity + next) * 0.5;
            self.orientation = self.orientation.turned(mean * part);
            self.angular_velocity = next;
        }
    }
}

fn push(u: &mut Unstructured<'_>) -> Result<Vector<f64, 3>> {
    let direction = draw::direction::<3>(u)?;
    Ok(direction * if u.arbitrary()? { 1.0 } else { draw::unit(u)? })
}

#[test]
fn no_rotation_within_the_limits_is_held_back() {
    let mut fast = 0;
    cases::check(300, |u| {
        let max_speed = draw::within(u, 5.0, 200.0)?;
        let max_acceleration = 10.0_f64.powf(draw::within(u, 2.0, 5.0)?);
        let profile =
            TurningProfile { max_speed, max_acceleration, ..TurningProfile::unlimited() };
        let mut readings = TurnReadings::new(&profile).unwrap();
        let mut swing = Swing {
            orientation: Rotation::identity(),
            angular_velocity: draw::direction::<3>(u)? * (WITHIN * max_speed * draw::unit(u)?),
            max_speed: WITHIN * max_speed,
            max_acceleration: WITHIN * max_acceleration,
        };
        let (mut way, mut gap) = (push(u)?, 0);
        for tick in 0..400 {
            if u.ratio(1, 20)? {
                way = push(u)?;
            }
            swing.step(way, 8);
            fast += u32::from(swing.angular_velocity.norm() > 0.9 * max_speed);
            gap += 1;
            // Unread for up to a tenth of a second, now and then.
            if gap < 100 && u.ratio(1, 8)? {
                continue;
            }
            if !readings.counts(swing.orientation, f64::from(gap) * PERIOD) {
                return Ok(Err(format!("held back at {tick} after {gap} ticks: {profile:?}")));
            }
            gap = 0;
        }
        Ok(Ok(()))
    });
    assert!(fast > 1000, "{fast}");
}

/// Against a servo without glitches: each glitch changes the torque by no more than the fastest hand
/// would turn the coupling meanwhile.
#[test]
fn random_glitches_change_the_torque_no_more_than_a_hand_would() {
    let profiles: Vec<_> = with_torques().collect();
    let (mut glitches, mut largest) = (0, 0.0_f64);
    cases::numbered(40, |seed, u| {
        let (name, profile) = profiles[seed % profiles.len()];
        let turning = profile.turning.as_ref().unwrap();
        let (mut clean, mut held) =
            (Held::new(profile).leaning(), Held::new(profile).leaning());
        let (amplitude, pace) = (0.1 * draw::unit(u)?, draw::within(u, 1.0, 30.0)?);
        let axis = draw::direction::<3>(u)?;
        let (mut left, mut glitch, mut since) = (0, Vector::ZERO, 0);
        let mut held_ticks = 0;
        for tick in 0..600_u32 {
            let t = f64::from(tick) * PERIOD;
            let swing = axis * (amplitude * (1.0 - (pace * t).cos()));
            let orientation = leaning().turned(swing);
            // So seldom that lateness does not add up.
            if left == 0 && since > 100 && u.ratio(1, 20)? {
                left = u.int_in_range(1..=3)?;
                // Farther than a hand comes in three ticks.
                glitch = draw::direction::<3>(u)? * draw::within(u, 0.6, 3.0)?;
                glitches += 1;
            }
            let read = if left > 0 { orientation.turned(glitch) } else { orientation };
            held_ticks += u64::from(left > 0);
            since = if left > 0 { 0 } else { since + 1 };
            left -= u32::from(left > 0);
            let (with, without) = (held.step(read), clean.step(orientation));
            let kick = (with - without).norm();
            largest = largest.max(kick);
            let of_hand = held.stiffness * turning.max_speed * PERIOD * 3.0;
            if kick > of_hand {
                let told = format!("{name}: {kick} N·m, of a hand {of_hand}, at {tick}");
                return Ok(Err(told));
            }
        }
        if held.held_back() != (0, held_ticks) || clean.held_back() != (0, 0) {
            let (of, by) = (held.held_back(), clean.held_back());
            return Ok(Err(format!("{name}: held back {of:?}, {by:?}, not {held_ticks}")));
        }
        Ok(Ok(()))
    });
    assert!(glitches > cases::count(50), "{glitches}");
    assert!(largest > 0.0);
}
