// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tools on devices that turn: with the hand, against its torque, within the device's limits.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::common::tools::smooth;
use crate::common::{AnyServo, body, cases, half_space};
use palpate_device::{
    Device, DeviceLost, DeviceProfile, PointState, Reading, TurnState, TurningProfile,
};
use palpate_field::{Pose, Rotation, Vector};
use palpate_haptics::servo_loop::{
    Ending, Pace, Recorder, RunOptions, ServoThread, ThreadOptions, VirtualClock, run,
};
use palpate_haptics::{
    Bodies, HapticsError, HeldTool, Material, Protection, Servo, ServoOptions, Shell, Surface,
    Tool, ToolOptions, Unprotected,
};
use palpate_safety::{Acceptance, Accepted, Rule, SafetyError, WorkspaceMap};
use palpate_sim::{HandPath, Interpolation, RecordedDevice};

const STIFFNESS: f64 = 500.0;

/// [N·m/rad].
const ANGULAR: f64 = 2.0;

/// Half the length of the rod [m].
const HALF: f64 = 0.05;

const UNHURRIED: f64 = 1e-3;

fn coupling() -> ToolOptions {
    ToolOptions {
        stiffness: STIFFNESS,
        angular_stiffness: Some(ANGULAR),
        damping: 0.0,
        max_force: Some(f64::INFINITY),
        max_torque: f64::INFINITY,
        ..ToolOptions::default()
    }
}

/// A rod along x of two points at its ends, without a radius.
fn rod(options: ToolOptions, is_flat: bool) -> Tool {
    let end = Vector::unit(0) * HALF;
    let shell = Shell::capsule([-end, end], 1e-4, 2).unwrap();
    Tool::new(if is_flat { shell.in_plane() } else { shell }, options).unwrap()
}

/// What is below a wall of unit normal (0, 1, 0…) at y = 0.
fn ground<const D: usize>(material: Material) -> Bodies {
    body(half_space(Vector::<f64, D>::unit(1).0, 0.0), Surface::new(&material).unwrap())
}

/// Stiffer than every coupling.
fn rigid() -> Material {
    Material { stiffness: 1e6, ..smooth() }
}

fn servo<const D: usize>(material: Material, options: ToolOptions) -> Servo<Unprotected> {
    let free = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
    let tool = rod(options, D == 2);
    Servo::with_tool(ground::<D>(material), tool, free).unwrap()
}

/// Moves the device to a place and an orientation, in small ticks; the force and the torque there.
fn brought(
    servo: &mut impl AnyServo,
    (from, to): (Vector<f64, 3>, Vector<f64, 3>),
    turn: Vector<f64, 3>,
) -> (Vector<f64, 3>, Vector<f64, 3>) {
    for tick in 0..=400 {
        let part = (f64::from(tick) / 200.0).min(1.0);
        let orientation = Rotation::identity().turned(turn * part);
        servo.set_turn(Some(TurnState::at_rest(orientation)));
        servo.step(&[PointState::at_rest(from + (to - from) * part)]);
    }
    (servo.forces()[0], servo.torque())
}

fn up(height: f64) -> Vector<f64, 3> {
    Vector::unit(1) * height
}

/// The turn at which a rod whose device is at height `h` and turned by `a` rests with its lower
/// end on the ground: of least `K/2 y² + κ/2 t²` with the origin `y` above the device and the rod
/// turned back by `t`. Force along y and torque.
fn lever(height: f64, angle: f64) -> (f64, f64) {
    let height_at = |back: f64| HALF * (angle - back).sin() + 1e-4 - height;
    let slope = |back: f64| {
        let raised = height_at(back);
        ANGULAR * back - STIFFNESS * raised * HALF * (angle - back).cos()
    };
    let (mut low, mut high) = (0.0, angle);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if slope(middle) < 0.0 { low = middle } else { high = middle }
    }
    (STIFFNESS * height_at(low), ANGULAR * low)
}

#[test]
fn a_rod_turned_into_the_ground_turns_the_hand_back() {
    let (force, torque) = lever(0.01, 0.3);
    let start = (up(0.1), up(0.01));
    let mut space = servo::<3>(rigid(), coupling());
    let (f, t) = brought(&mut space, start, Vector([0.0, 0.0, -0.3]));
    assert!((f - Vector([0.0, force, 0.0])).norm() < 1e-6, "{f:?}, not {force}");
    assert!((t - Vector([0.0, 0.0, torque])).norm() < 1e-6, "{t:?}, not {torque}");
    // The force at the end, on its arm.
    assert!((torque / force - HALF * (0.3 - torque / ANGULAR).cos()).abs() < 1e-9);
    let mut plane = servo::<2>(rigid(), coupling());
    let (f, t) = brought(&mut plane, (up(0.1), up(0.01)), Vector([0.0, 0.0, -0.3]));
    assert!((f - up(force)).norm() < 1e-6 && (t - Vector([0.0, 0.0, torque])).norm() < 1e-6);
    // The other way round, the other end.
    let mut plane = servo::<2>(rigid(), coupling());
    let (_, t) = brought(&mut plane, (up(0.1), up(0.01)), Vector([0.0, 0.0, 0.3]));
    assert!((t + Vector([0.0, 0.0, torque])).norm() < 1e-6);
}

#[test]
fn a_flat_rod_pressed_flat_has_no_torque_and_one_turned_about_its_middle_no_force() {
    let mut flat = servo::<3>(rigid(), coupling());
    let (force, torque) = brought(&mut flat, (up(0.1), up(1e-4 - 0.002)), Vector::ZERO);
    assert!((force - up(1.0)).norm() < 1e-6 && torque.norm() < 1e-6);
    let held = flat.held_tool().unwrap();
    assert_eq!(held.given, Some(torque));
}

#[test]
fn a_device_that_does_not_turn_has_no_torque_to_write() {
    let mut servo = servo::<3>(rigid(), coupling());
    servo.step(&[PointState::at_rest(up(0.1))]);
    servo.step(&[PointState::at_rest(up(-0.002))]);
    assert_eq!((servo.torque(), servo.held_tool().unwrap().given), (Vector::ZERO, None));
}

#[test]
fn the_workspace_turns_what_turns_and_shortens_arms() {
    let rotation = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.5).unwrap();
    let map = WorkspaceMap::new(Pose::rotation(rotation), 2.0).unwrap();
    let profile = device(TurningProfile::unlimited());
    let servo = servo::<3>(rigid(), coupling());
    let protection =
        Protection::new(profile).with_map(map).with(|s| s.rise_rate = f64::INFINITY);
    let mut servo = servo.protected(&protection).unwrap();
    let at_device = |height: f64| map.point_to_device(up(height));
    // In the world turned by −0.3, so by −0.8 against the device's axes.
    for tick in 0..=400 {
        let part = (f64::from(tick) / 200.0).min(1.0);
        let turn = Rotation::identity().turned(Vector([0.0, 0.0, -0.5 - 0.3 * part]));
        servo.set_turn(Some(TurnState::at_rest(turn)));
        servo.step(&[PointState::at_rest(at_device(0.1 - 0.09 * part))]);
    }
    let (force, torque) = lever(0.01, 0.3);
    assert!((servo.torque() - Vector([0.0, 0.0, 0.5 * torque])).norm() < 1e-6);
    assert!((map.force_to_world(servo.forces()[0]) - up(force)).norm() < 1e-6);
    let given = servo.held_tool().unwrap().given.unwrap();
    assert!((given - Vector([0.0, 0.0, torque])).norm() < 1e-6);
}

/// What a device that turns needs to say, and no limits beside.
fn device(turning: TurningProfile) -> DeviceProfile {
    DeviceProfile { turning: Some(turning), ..DeviceProfile::unlimited("example") }
}

/// The same servo for a device that it moves from the first tick on.
fn for_device(servo: Servo<Unprotected>, device: &dyn Device) -> Servo {
    let protection = Protection::new(device.profile().clone());
    servo.protected(&protection.with(|s| s.rise_rate = f64::INFINITY)).unwrap()
}

#[test]
fn what_turns_is_accepted_by_the_same_law() {
    let accept = |turning: TurningProfile, options: ToolOptions, is_strict| {
        let servo = servo::<3>(rigid(), options);
        let protection = Protection::new(device(turning)).with(|s| {
            s.acceptance = Acceptance::Passive;
            s.is_strict = is_strict
        });
        let servo = servo.protected(&protection)?;
        Ok((servo.accepted()[0].stiffness_factor, servo.accepted()[1].clone()))
    };
    let scaled = |turning, options| accept(turning, options, false).unwrap();
    let base = TurningProfile::unlimited();
    let damped = ToolOptions { angular_damping: 0.001, ..coupling() };
    let of_stiffness = |about: &Accepted| (about.stiffness_factor, about.stiffness_rule);
    // 2 b / (κ T) = 0.001 / 0.002, which leaves no damping.
    let passive = TurningProfile { least_damping: 5e-4, ..base.clone() };
    let (along, about) = scaled(passive.clone(), damped);
    assert_eq!(along, 1.0);
    assert_eq!(of_stiffness(&about), (0.5, Some(Rule::AngularPassivity)));
    assert_eq!(about.damping_rule, Some(Rule::AngularDampingLeft));
    assert_eq!((about.device_stiffness, about.device_damping), (1.0, 0.0));
    // 2 f_c / (Δ κ) = 2 · 1e-3 / (2e-3 · 2)
    let seen = TurningProfile { friction: 1e-3, encoder_step: 2e-3, ..base.clone() };
    let (_, about) = scaled(seen, coupling());
    assert_eq!(of_stiffness(&about), (0.5, Some(Rule::AngularQuantisation)));
    let soft = TurningProfile { max_stiffness: 0.25, ..base.clone() };
    let (_, about) = scaled(soft, coupling());
    assert_eq!(of_stiffness(&about), (0.125, Some(Rule::MaxAngularStiffness)));
    let thin = TurningProfile { max_damping: 5e-4, ..base };
    let (_, about) = scaled(thin, damped);
    assert_eq!(of_stiffness(&about), (1.0, None));
    let of_damping = (about.damping_factor, about.damping_rule);
    assert_eq!(of_damping, (0.5, Some(Rule::MaxAngularDamping)));
    let refused: HapticsError = accept(passive, damped, true).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "coupling of the tool about axes: the device renders angular stiffness 1 N·m/rad (asked 2) \
         and damping 0 N·m·s/rad (asked 0.001): κ ≤ 2 b / T about axes"
    );
    assert!(matches!(refused, HapticsError::Safety(SafetyError::MaterialRefused(_))));
}

#[test]
fn a_softer_coupling_turns_the_hand_less() {
    // κ T / 2 = 1e-3 [N·m·s/rad].
    let turning = TurningProfile { least_damping: 2.5e-4, ..TurningProfile::unlimited() };
    let servo = servo::<3>(rigid(), coupling());
    let protection = Protection::new(device(turning)).with(|s| {
        s.acceptance = Acceptance::Passive;
        s.rise_rate = f64::INFINITY
    });
    let mut servo = servo.protected(&protection).unwrap();
    assert_eq!(servo.accepted()[1].stiffness_factor, 0.25);
    // Pressed flat by so much that the rod stays level: κ/4 times the angle.
    let (_, torque) = brought(&mut servo, (up(0.1), up(-0.02)), Vector([0.0, 0.0, -0.2]));
    assert!((torque - Vector([0.0, 0.0, 0.25 * ANGULAR * 0.2])).norm() < 1e-6, "{torque:?}");
}

/// Limits that all have to act.
fn limits() -> TurningProfile {
    TurningProfile {
        max_torque: 0.2,
        continuous_torque: 0.05,
        max_torque_rate: 20.0,
        inertia: 1e-4,
        least_damping: 2e-3,
        ..TurningProfile::unlimited()
    }
}

#[test]
fn torques_keep_the_limits_of_the_device_in_any_motion() {
    let mut reports = Vec::new();
    cases(20, |u| {
        let servo = servo::<3>(rigid(), coupling());
        let profile = DeviceProfile {
            mass: 0.05,
            least_damping: 0.5,
            ..DeviceProfile { max_force: 3.0, ..device(limits()) }
        };
        let mut servo = servo.protected(&Protection::new(profile)).unwrap();
        let mut draw = || u.int_in_range(-1000..=1000).map(|x| f64::from(x) * 1e-3);
        let (axis, height) = (Vector([draw()?, draw()?, draw()?]), 0.01 * draw()?);
        let (pace, sudden) = (20.0 + 15.0 * draw()?, draw()?);
        let mut last = Vector::ZERO;
        for tick in 0..3000_u32 {
            let t = f64::from(tick) * 1e-3;
            let swing = 0.6 * (pace * t).sin() + if tick % 500 == 499 { sudden } else { 0.0 };
            let spin = if tick % 700 == 699 { f64::NAN } else { 0.0 };
            servo.set_turn(Some(TurnState {
                orientation: Rotation::identity().turned(axis * swing),
                angular_velocity: Vector([spin, 0.0, 0.0]),
            }));
            servo.set_late(if (1000..1010).contains(&tick) { 0.002 } else { 0.0 });
            if tick == 2000 {
                servo.stop(true);
            } else if tick == 2100 {
                servo.stop(false);
            }
            servo.step(&[PointState::at_rest(up(height))]);
            let torque = servo.torque();
            assert!(torque.norm() <= 0.2 * (1.0 + 1e-12), "{tick}: {torque:?}");
            let falls = torque == Vector::ZERO;
            assert!(falls || (torque - last).norm() <= 0.02 * (1.0 + 1e-9), "{tick}");
            assert!(!(2000..2100).contains(&tick) || falls, "{tick}: stopped");
            assert!(spin == 0.0 || falls, "{tick}: not a number");
            last = torque;
        }
        reports.push(servo.safety()[0].clone());
        Ok(())
    });
    let turning = || reports.iter().map(|report| report.turning.as_ref().unwrap());
    assert!(turning().all(|report| report.largest_torque <= 0.2 * (1.0 + 1e-12)));
    assert!(turning().any(|report| report.slew.ticks > 0));
    assert!(turning().any(|report| report.torque_limit.ticks > 0));
    assert!(turning().any(|report| report.continuous.effect.ticks > 0));
    assert!(turning().any(|report| report.ramp.ticks > 0));
    assert!(turning().any(|report| report.watchdog.trips > 0));
    assert!(turning().any(|report| report.emergency_stop.ticks > 0));
    assert!(turning().all(|report| report.continuous.root_mean_square <= 0.05 + 1e-12));
}

#[test]
fn the_largest_torque_keeps_its_direction() {
    let turning = TurningProfile { max_torque: 0.125, ..TurningProfile::unlimited() };
    let servo = servo::<3>(rigid(), coupling());
    let protection = Protection::new(device(turning)).with(|s| s.rise_rate = f64::INFINITY);
    let mut servo = servo.protected(&protection).unwrap();
    let (_, torque) = brought(&mut servo, (up(0.1), up(-0.02)), Vector([0.0, 0.0, -0.2]));
    assert!((torque - Vector([0.0, 0.0, 0.125])).norm() < 1e-9, "{torque:?}");
    let planar = self::servo::<2>(rigid(), coupling());
    let turning = TurningProfile { max_torque: 0.125, ..TurningProfile::unlimited() };
    let mut planar = planar
        .protected(&Protection::new(device(turning)).with(|s| s.rise_rate = f64::INFINITY))
        .unwrap();
    let (_, flat) = brought(&mut planar, (up(0.1), up(-0.02)), Vector([0.0, 0.0, -0.2]));
    assert!((flat - torque).norm() < 1e-9, "{flat:?}");
    let report = servo.safety()[0].clone();
    let limit = report.turning.unwrap().torque_limit;
    assert!((limit.largest - (0.4 - 0.125)).abs() < 1e-6, "{limit:?}");
    // At run time, too.
    servo.limit_torque(0.0625);
    let (_, torque) = brought(&mut servo, (up(-0.02), up(-0.02)), Vector([0.0, 0.0, -0.2]));
    assert!((torque.norm() - 0.0625).abs() < 1e-12);
}

#[test]
fn the_energy_of_force_and_torque_is_counted_together() {
    // Turned into the ground, then lifted off it: torque takes what force gives.
    let turning =
        TurningProfile { least_damping: 2e-3, inertia: 1e-3, ..TurningProfile::unlimited() };
    let profile = DeviceProfile { least_damping: 0.5, mass: 0.1, ..device(turning) };
    let servo = servo::<3>(rigid(), coupling());
    let protection = Protection::new(profile).with(|s| s.rise_rate = f64::INFINITY);
    let mut servo = servo.protected(&protection).unwrap();
    assert!(servo.accepted().iter().all(|a| a.stiffness_factor == 1.0));
    let mut given = 0.0;
    let mut wanted = 0.0_f64;
    let mut last: Option<(Vector<f64, 3>, Vector<f64, 3>)> = None;
    for tick in 0..4000_u32 {
        let t = f64::from(tick) * 1e-3;
        let angle = -0.3 * (t / 2.0).min(1.0);
        let height = 0.012 + 0.01 * (t - 2.0).max(0.0);
        let (place, turn) = (up(height), Vector([0.0, 0.0, angle]));
        if let Some((last_place, last_turn)) = last {
            given += servo.forces()[0].dot(place - last_place)
                + servo.torque().dot(turn - last_turn);
        }
        servo.set_turn(Some(TurnState::at_rest(Rotation::identity().turned(turn))));
        servo.step(&[PointState { position: place, velocity: Vector::ZERO }]);
        last = Some((place, turn));
        wanted = wanted.max(servo.touches()[0].wanted.norm());
    }
    assert!(wanted > 0.5, "{wanted} N");
    let energy = servo.energy(0);
    assert!((energy.given - energy.taken - given).abs() < 1e-9, "{energy:?}, {given}");
    // What was taken by turning is given by lifting: nothing is held back.
    assert!(energy.taken > 1e-3 && energy.given > 0.9 * energy.taken, "{energy:?}");
    assert_eq!(servo.safety()[0].passivity.effect.ticks, 0, "{:?}", servo.safety());
}

#[test]
fn dampers_of_bodies_turn_the_hand_no_harder_than_the_device_bears() {
    // 2 N·s/m on 5 cm are 5e-3 N·m·s/rad, and the coupling takes 1e-3 of the device's 2e-3.
    let turning = TurningProfile { least_damping: 2e-3, ..TurningProfile::unlimited() };
    let material = Material { damping: 2.0, viscosity: 0.0, ..rigid() };
    let servo = servo::<3>(material, coupling());
    let protection = Protection::new(device(turning)).with(|s| s.rise_rate = f64::INFINITY);
    let mut servo = servo.protected(&protection).unwrap();
    let (_, still) = brought(&mut servo, (up(0.1), up(0.01)), Vector([0.0, 0.0, -0.3]));
    let state = PointState::at_rest(up(0.01));
    let turn = TurnState {
        orientation: Rotation::identity().turned(Vector([0.0, 0.0, -0.3])),
        angular_velocity: Vector([0.0, 0.0, -0.1]),
    };
    servo.set_turn(Some(turn));
    servo.step(&[state]);
    let damped = servo.torque() - still;
    assert!(damped[2] > 0.5e-4 && damped[2] <= 1.001e-4, "{damped:?}");
}

/// What was written was told as at the device, beside what was wanted, as in the world.
#[test]
fn the_torques_of_a_report_are_those_of_the_trace() {
    let turning = TurningProfile { max_torque: 0.1, ..TurningProfile::unlimited() };
    let mut device = RecordedDevice::new(vec![resting(0.005)]).unwrap().with_turns(swing());
    device = device.with_profile(self::device(turning));
    let map = WorkspaceMap::new(Pose::identity(), 0.5).unwrap();
    let protection = Protection::new(device.profile().clone()).with_map(map);
    let mut servo = servo::<3>(rigid(), coupling()).protected(&protection).unwrap();
    let mut recorder = Recorder::new(1001);
    let options = RunOptions {
        pace: Pace::AsFastAsPossible,
        recorder: Some(&mut recorder),
        ..RunOptions::new(1.001)
    };
    let report = run(&mut servo, &mut device, options).unwrap();
    let largest = |of: fn(&HeldTool) -> Vector<f64, 3>| {
        let tools = recorder.rows().iter().filter_map(|row| row.tool);
        tools.map(|tool| of(&tool).norm()).fold(0.0, f64::max)
    };
    let tool = report.tool.unwrap();
    assert_eq!(tool.largest_torque, largest(|tool| tool.torque));
    assert_eq!(tool.largest_torque_written, Some(largest(|tool| tool.given.unwrap())));
    let at_device = report.safety[0].turning.as_ref().unwrap().largest_torque;
    assert!(at_device > 0.01, "{at_device}");
    assert!((tool.largest_torque_written.unwrap() - 0.5 * at_device).abs() < 1e-12);
}

fn resting(height: f64) -> HandPath {
    let places = vec![up(0.1), up(height), up(height)];
    HandPath::new(vec![0.0, 0.5, 1.0], places, Interpolation::Linear).unwrap()
}

fn swing() -> HandPath {
    let turns = vec![Vector::ZERO, Vector::ZERO, Vector([0.1, 0.0, -0.3])];
    HandPath::new(vec![0.0, 0.4, 1.0], turns, Interpolation::Linear).unwrap()
}

#[test]
fn a_run_turns_the_tool_and_reports_the_torque() {
    let turning = TurningProfile { max_torque: 0.1, ..TurningProfile::unlimited() };
    let mut device = RecordedDevice::new(vec![resting(0.005)]).unwrap().with_turns(swing());
    device = device.with_profile(self::device(turning));
    let mut servo = for_device(servo::<3>(rigid(), coupling()), &device);
    let mut recorder = Recorder::new(1001);
    let options = RunOptions {
        pace: Pace::AsFastAsPossible,
        recorder: Some(&mut recorder),
        ..RunOptions::new(1.001)
    };
    let report = run(&mut servo, &mut device, options).unwrap();
    let tool = report.tool.unwrap();
    assert!(tool.largest_torque > 0.15, "{tool:?}");
    assert!((tool.largest_torque_written.unwrap() - 0.1).abs() < 1e-12);
    let held = recorder.rows().last().unwrap().tool.unwrap();
    assert!((held.given.unwrap().norm() - 0.1).abs() < 1e-12);
    // The tool is where the hand turned it, less what the ground took back.
    let hand = Rotation::identity().turned(Vector([0.1, 0.0, -0.3]));
    assert!((hand.turn_to(&held.pose.rotation) - held.turn).norm() < 1e-9);
    assert_eq!((device.torque(), device.forces()[0]), (Vector::ZERO, Vector::ZERO));
}

/// Answers for a while only, and remembers what was written last.
struct Fragile {
    inner: RecordedDevice,
    ticks: u32,
    panics: bool,
    largest: f64,
}

impl Device for Fragile {
    fn points(&self) -> usize {
        1
    }

    fn profile(&self) -> &DeviceProfile {
        self.inner.profile()
    }

    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.inner.read(time, points)
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.inner.write(forces)
    }

    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        self.ticks += 1;
        assert!(!(self.panics && self.ticks > 900), "a driver's defect");
        if self.ticks > 900 {
            return Err(DeviceLost { reason: "unplugged".to_owned() });
        }
        self.inner.read_turn()
    }

    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.largest = self.largest.max(torque.norm());
        self.inner.write_torque(torque)
    }
}

#[test]
fn a_device_that_is_lost_or_panics_gets_no_force_and_no_torque_last() {
    for panics in [false, true] {
        let inner = RecordedDevice::new(vec![resting(0.005)]).unwrap().with_turns(swing());
        let inner = inner.with_profile(device(TurningProfile::unlimited()));
        let mut device = Fragile { inner, ticks: 0, panics, largest: 0.0 };
        let mut servo = for_device(servo::<3>(rigid(), coupling()), &device);
        let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(2.0) };
        let report = run(&mut servo, &mut device, options).unwrap();
        assert_eq!(matches!(report.ending, Ending::Panicked { .. }), panics);
        assert_eq!(matches!(report.ending, Ending::DeviceLost { .. }), !panics);
        assert_eq!(report.ticks, 900);
        assert!(device.largest > 0.1, "{}", device.largest);
        assert_eq!(device.inner.torque(), Vector::ZERO);
        assert_eq!(device.inner.forces()[0], Vector::ZERO);
    }
}

#[test]
fn a_device_that_senses_turns_alone_gets_none_of_the_torque() {
    let turning = TurningProfile {
        max_torque: 0.0,
        encoder_step: UNHURRIED,
        ..TurningProfile::unlimited()
    };
    let servo = servo::<3>(rigid(), coupling());
    let protection = Protection::new(device(turning)).with(|s| s.rise_rate = f64::INFINITY);
    let mut servo = servo.protected(&protection).unwrap();
    assert_eq!(servo.accepted().len(), 1);
    let (force, torque) = brought(&mut servo, (up(0.1), up(0.01)), Vector([0.0, 0.0, -0.3]));
    let (expected, wanted) = lever(0.01, 0.3);
    assert!((force - up(expected)).norm() < 1e-6);
    assert_eq!(torque, Vector::ZERO);
    assert!((servo.held_tool().unwrap().torque[2] - wanted).abs() < 1e-6);
    assert_eq!(servo.safety()[0].turning, None);
}

/// Shows what is written, from wherever it runs.
struct Shown(RecordedDevice, Arc<Mutex<Vector<f64, 3>>>);

impl Device for Shown {
    fn points(&self) -> usize {
        1
    }

    fn profile(&self) -> &DeviceProfile {
        self.0.profile()
    }

    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.0.read(time, points)
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.0.write(forces)
    }

    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        self.0.read_turn()
    }

    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        *self.1.lock().unwrap() = torque;
        self.0.write_torque(torque)
    }
}

#[test]
fn another_thread_limits_and_stops_the_torque() {
    let written = Arc::new(Mutex::new(Vector::ZERO));
    let turns = HandPath::new(
        vec![0.0, 0.1],
        vec![Vector::ZERO, Vector([0.0, 0.0, -0.3])],
        Interpolation::Linear,
    );
    let places = HandPath::new(vec![0.0, 0.1], vec![up(0.1), up(0.005)], Interpolation::Linear);
    let recorded = RecordedDevice::new(vec![places.unwrap()]).unwrap();
    let recorded = recorded.with_profile(device(TurningProfile::unlimited()));
    let device = Box::new(Shown(recorded.with_turns(turns.unwrap()), written.clone()));
    let servo = for_device(servo::<3>(rigid(), coupling()), &*device);
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions { raises_priority: false, ..ThreadOptions::default() };
    let mut thread = ServoThread::start_on(clock, servo, device, options).unwrap();
    let mut torque_after = |milliseconds| {
        driver.advance(Duration::from_millis(milliseconds));
        written.lock().unwrap().norm()
    };
    let (_, wanted) = lever(0.005, 0.3);
    assert!((torque_after(200) - wanted).abs() < 1e-6);
    thread.control().limit_torque(0.03).unwrap();
    assert!((torque_after(2) - 0.03).abs() < 1e-12);
    let held = thread.control().latest().unwrap().tool.unwrap();
    assert!((held.given.unwrap().norm() - 0.03).abs() < 1e-12);
    let switch = thread.control().stop_switch();
    switch.stop();
    assert_eq!(torque_after(2), 0.0);
    switch.release();
    assert!((torque_after(2) - 0.03).abs() < 1e-12);
    assert!(thread.control().limit_torque(-1.0).is_err());
    drop(driver);
    drop(thread.end());
    assert_eq!(*written.lock().unwrap(), Vector::ZERO);
}

#[test]
fn a_device_that_no_longer_says_how_it_is_turned_gets_no_torque() {
    let servo = servo::<3>(rigid(), coupling());
    let profile = DeviceProfile { max_force_rate: 50.0, ..device(limits()) };
    let mut servo = servo
        .protected(&Protection::new(profile).with(|s| s.rise_rate = f64::INFINITY))
        .unwrap();
    brought(&mut servo, (up(0.1), up(0.01)), Vector([0.0, 0.0, -0.3]));
    let (mut force, mut torque) = (servo.forces()[0], servo.torque());
    assert!(torque.norm() > 0.01);
    servo.set_turn(None);
    for _ in 0..100 {
        servo.step(&[PointState::at_rest(up(0.01))]);
        assert!((servo.forces()[0] - force).norm() <= 0.05 * (1.0 + 1e-9));
        assert!((servo.torque() - torque).norm() <= 0.02 * (1.0 + 1e-9));
        (force, torque) = (servo.forces()[0], servo.torque());
    }
    assert_eq!((torque, servo.held_tool().unwrap().given), (Vector::ZERO, None));
}
