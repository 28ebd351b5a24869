// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tool with a shape as what a servo renders: the same loop, safety chain and hand-off as for
//! contact points.

use std::time::Duration;

use crate::common::tools::smooth;
use crate::common::{ball, body, half_space, without_limits};
use palpate_device::{DeviceProfile, PointState};
use palpate_field::{Pose, Rotation, Vector};
use palpate_haptics::servo_loop::{
    Pace, Recorder, RunOptions, ServoThread, ThreadOptions, VirtualClock, run,
};
use palpate_haptics::{
    Bodies, EventKind, Guide, GuideOptions, HapticsError, Material, Protection, Servo,
    ServoOptions, Shell, Surface, Tool, ToolOptions, ToolState,
};
use palpate_safety::{Acceptance, Requester, SafetyError, WorkspaceMap};
use palpate_sim::{HandPath, Interpolation, RecordedDevice};

const STIFFNESS: f64 = 500.0;

/// A rod that lies along x, of radius 1 cm.
fn rod() -> Tool {
    rod_with(options())
}

fn rod_with(options: ToolOptions) -> Tool {
    let ends = [Vector([-0.04, 0.0, 0.0]), Vector([0.04, 0.0, 0.0])];
    Tool::new(Shell::capsule(ends, 0.01, 41).unwrap(), options).unwrap()
}

fn options() -> ToolOptions {
    ToolOptions { stiffness: STIFFNESS, damping: 0.0, ..ToolOptions::default() }
}

fn ground(material: Material) -> Bodies {
    body(half_space([0.0, 1.0, 0.0], 0.0), Surface::new(&material).unwrap())
}

fn at(x: f64, y: f64) -> PointState {
    PointState::at_rest(Vector([x, y, 0.0]))
}

fn press(positions: Vec<[f64; 3]>) -> RecordedDevice {
    let times = (0..positions.len()).map(|i| 0.5 * i as f64).collect();
    let positions = positions.into_iter().map(Vector).collect();
    let path = HandPath::new(times, positions, Interpolation::Linear).unwrap();
    RecordedDevice::new(vec![path]).unwrap()
}

#[test]
fn a_servo_feels_what_the_tool_alone_feels() {
    let options = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
    let mut servo = Servo::with_tool(ground(Material::default()), rod(), options).unwrap();
    let (mut bodies, mut tool) = (ground(Material::default()), rod());
    let mut slips = 0;
    for tick in 0..500 {
        let t = f64::from(tick) * 1e-3;
        let position = Vector([0.05 * (9.0 * t).sin(), 0.012 - 0.01 * t, 0.0]);
        let state = PointState { position, velocity: Vector([0.1, -0.01, 0.0]) };
        let touch = servo.step(&[state])[0];
        let PointState { position, velocity } = state;
        let pose = Pose::translation(position);
        let alone = tool
            .step(&mut bodies, &ToolState { pose, velocity, angular_velocity: Vector::ZERO });
        if alone.force.norm() <= 3.3 {
            assert_eq!((touch.force, touch.wanted), (alone.force, alone.force), "{tick}");
            assert_eq!(servo.forces()[0], alone.force);
        }
        assert_eq!(touch.proxy, alone.pose.translation);
        assert_eq!((touch.contact, touch.is_slipping), (alone.contact, alone.is_slipping));
        assert_eq!(servo.events(), tool.events());
        let slipped = servo.events().iter().filter(|event| event.kind == EventKind::Slip);
        slips += slipped.count();
    }
    assert!(slips > 0 && tool.touch().contact);
}

#[test]
fn the_device_turns_and_scales_the_tool_with_its_axes() {
    // The device's x points up in the world, and the world is twice as large.
    let rotation =
        Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), std::f64::consts::FRAC_PI_2);
    let pose = Pose::new(rotation.unwrap(), Vector::ZERO);
    let map = WorkspaceMap::new(pose, 2.0).unwrap();
    let servo = Servo::with_tool(ground(smooth()), rod(), ServoOptions::default()).unwrap();
    let profile = DeviceProfile::unlimited("example");
    let mut servo = servo.protected(&Protection::new(profile).with_map(map)).unwrap();
    // The rod stands on its end: its tip is 5 cm below its origin.
    let mut force = Vector::ZERO;
    for _ in 0..200 {
        let height = 0.05 - 0.002;
        force = servo.step(&[at(0.5 * height, 0.0)])[0].force;
    }
    assert!((force - Vector([0.0, 1.0, 0.0])).norm() < 1e-6, "{force:?}");
    let written = servo.forces()[0];
    assert!((written - Vector([1.0, 0.0, 0.0])).norm() < 1e-6, "{written:?}");
}

#[test]
fn a_coupling_is_made_as_soft_as_the_device_needs() {
    let device = DeviceProfile { least_damping: 0.2, ..DeviceProfile::unlimited("example") };
    let protection = Protection::new(device).with(|s| s.acceptance = Acceptance::Passive);
    let servo = Servo::with_tool(ground(smooth()), rod(), ServoOptions::default()).unwrap();
    let mut servo = servo.protected(&protection).unwrap();
    let accepted = servo.accepted().to_vec();
    // b / (K T / 2) = 0.2 / 0.25
    assert!((accepted[0].stiffness_factor - 0.8).abs() < 1e-12 && accepted.len() == 1);
    let tool = servo.tool().unwrap();
    assert!((tool.coupling().stiffness - 400.0).abs() < 1e-9);
    for _ in 0..200 {
        servo.step(&[at(0.0, 0.008)]);
    }
    assert!((servo.forces()[0] - Vector([0.0, 0.8, 0.0])).norm() < 1e-6);
    // A body that is soft enough leaves the coupling as it is.
    let soft = Material { stiffness: 300.0, ..smooth() };
    let servo = Servo::with_tool(ground(soft), rod(), ServoOptions::default()).unwrap();
    let servo = servo.protected(&protection).unwrap();
    assert_eq!(servo.accepted()[0].stiffness_factor, 1.0);
    // Coupling and body damp together.
    let damped = Material { damping: 0.3, ..smooth() };
    let strict = protection.with(|s| s.is_strict = true);
    let servo = Servo::with_tool(ground(damped), rod(), ServoOptions::default()).unwrap();
    let refused = servo.protected(&strict).unwrap_err();
    let HapticsError::Safety(SafetyError::MaterialRefused(refused)) = refused else {
        panic!("{refused}");
    };
    assert_eq!(refused[0].requested.damping(), 0.3);
    assert_eq!(refused[0].requester, Requester::Body(0));
}

#[test]
fn a_tool_is_guided_and_limited() {
    let mut servo = Servo::with_tool(ground(smooth()), rod(), ServoOptions::default()).unwrap();
    let options = GuideOptions { stiffness: 100.0, damping: 0.0, ..GuideOptions::default() };
    servo.guide(&[Guide::to_point(Vector([0.0, 0.1, 0.0]), options).unwrap()]);
    let force = servo.step(&[at(0.0, 0.09)])[0].force;
    assert!((force - Vector([0.0, 1.0, 0.0])).norm() < 1e-9, "{force:?}");
    servo.guide(&[]);
    servo.limit_force(0.5);
    servo.step(&[at(0.0, 0.005)]);
    assert!((servo.forces()[0].norm() - 0.5).abs() < 1e-12);
    // A state that is none.
    servo.step(&[]);
    assert_eq!(servo.forces(), [Vector::ZERO]);
    assert_eq!(servo.events()[0].kind, EventKind::Leave);
}

/// The largest force written while `servo` presses its tool 15 mm deep, which its coupling
/// answers with 7.5 N.
fn hardest(servo: &mut Servo) -> f64 {
    let pressed = (0..1000).map(|_| {
        servo.step(&[at(0.0, -0.005)]);
        servo.forces()[0].norm()
    });
    pressed.fold(0.0, f64::max)
}

#[test]
fn of_the_force_limits_of_tool_and_servo_the_smaller_holds() {
    let profile = DeviceProfile { max_force: 5.0, ..DeviceProfile::unlimited("example") };
    let limited = |max_force| rod_with(ToolOptions { max_force: Some(max_force), ..options() });
    for (tool, most) in [(limited(1.0), 1.0), (rod(), 5.0), (limited(6.0), 5.0)] {
        let options = ServoOptions::of_device(&profile);
        let bodies = ground(smooth());
        let mut free = Servo::with_tool(bodies.clone(), tool.clone(), options).unwrap();
        free.step(&[at(0.0, 0.02)]);
        free.step(&[at(0.0, -0.005)]);
        assert!((free.forces()[0].norm() - most).abs() < 1e-12);
        assert_eq!(free.options().max_force, most);
        let servo = Servo::with_tool(bodies, tool, options).unwrap();
        let mut servo = servo.protected(&Protection::new(profile.clone())).unwrap();
        servo.step(&[at(0.0, 0.02)]);
        assert!((hardest(&mut servo) - most).abs() < 1e-12);
    }
}

#[test]
fn a_servo_made_for_a_tool_keeps_the_tools_force_limit_and_its_guides_share_it() {
    let device = press(vec![[0.0, 0.02, 0.0], [0.0, -0.005, 0.0]]);
    let tool = rod_with(ToolOptions { max_force: Some(0.5), ..options() });
    let mut servo = Servo::for_tool(ground(smooth()), tool, &device).unwrap();
    let pull = GuideOptions { stiffness: 100.0, damping: 0.0, ..GuideOptions::default() };
    servo.guide(&[Guide::to_point(Vector([0.0, 0.5, 0.0]), pull).unwrap()]).unwrap();
    servo.step(&[at(0.0, 0.02)]);
    assert!((hardest(&mut servo) - 0.5).abs() < 1e-12);
}

#[test]
fn a_tool_takes_the_servos_rate_and_the_longer_rise_time() {
    let options = ServoOptions { rate: 4000.0, rise_time: 0.2, ..ServoOptions::default() };
    for (own, holds) in [(0.1, 0.2), (0.3, 0.3)] {
        let tool =
            rod_with(ToolOptions { rate: 100.0, rise_time: own, ..ToolOptions::default() });
        let servo = Servo::with_tool(ground(smooth()), tool, options).unwrap();
        let tool = servo.tool().unwrap().options();
        assert_eq!((tool.rate, tool.rise_time), (4000.0, holds));
    }
}

#[test]
fn a_force_limit_that_is_no_number_is_refused_with_a_tool_too() {
    let refused = |max_force| {
        let options = ServoOptions { max_force, ..ServoOptions::default() };
        Servo::with_tool(ground(smooth()), rod(), options).unwrap_err().to_string()
    };
    assert_eq!(refused(f64::NAN), "max_force must be positive, got NaN N");
    assert_eq!(refused(-1.0), "max_force must be positive, got -1 N");
    let tool = Tool::new(
        Shell::ball(0.01).unwrap(),
        ToolOptions { max_force: Some(0.0), ..options() },
    );
    assert_eq!(tool.unwrap_err().to_string(), "max_force must be positive, got 0 N");
}

#[test]
fn a_run_reports_what_the_tool_felt() {
    let servo = Servo::with_tool(ground(smooth()), rod(), ServoOptions::default()).unwrap();
    let mut servo = without_limits(servo);
    let mut device = press(vec![[0.0, 0.02, 0.0], [0.0, 0.007, 0.0]]);
    let mut recorder = Recorder::new(1000);
    let options = RunOptions {
        pace: Pace::AsFastAsPossible,
        recorder: Some(&mut recorder),
        ..RunOptions::new(1.0)
    };
    let report = run(&mut servo, &mut device, options).unwrap();
    let tool = report.tool.unwrap();
    assert_eq!((report.points, tool.points), (1, 41));
    assert!((report.largest_force - 0.003 * STIFFNESS).abs() < 1e-2, "{report:?}");
    assert!(report.contact_time > 0.5 && report.evaluations.max >= 41);
    assert!(tool.most_contacts >= 2 && tool.mean_contacts >= 1.0, "{tool:?}");
    assert_eq!((tool.degraded_ticks, tool.covered_ticks), (0, 0));
    assert_eq!(tool.coarsest_resolution, tool.resolution);
    assert_eq!(report.events.touches, 1);
    let last = recorder.rows().last().unwrap();
    let held = last.tool.unwrap();
    assert!(last.contact && held.contacts >= 2 && held.torque.norm() < 1e-9);
    assert_eq!(held.pose.translation, last.proxy);
}

#[test]
fn a_tool_with_too_small_a_budget_says_so() {
    let shell = Shell::from_field(&ball::<3>(0.02), 600, 0.0).unwrap();
    let options = ToolOptions { budget: 100, ..ToolOptions::default() };
    let tool = Tool::new(shell, options).unwrap();
    let servo = Servo::with_tool(ground(smooth()), tool, ServoOptions::default()).unwrap();
    let mut servo = without_limits(servo);
    let mut device = press(vec![[0.0, 0.03, 0.0], [0.03, 0.015, 0.0]]);
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.0) };
    let report = run(&mut servo, &mut device, options).unwrap();
    let tool = report.tool.unwrap();
    assert!(report.evaluations.max <= 100 && tool.degraded_ticks > 0, "{report:?}");
    assert!(tool.coarsest_resolution > tool.resolution);
}

#[test]
fn a_thread_hands_off_what_the_tool_does() {
    let servo = Servo::with_tool(ground(smooth()), rod(), ServoOptions::default()).unwrap();
    let servo = without_limits(servo);
    let device = Box::new(press(vec![[0.0, 0.02, 0.0]; 2]));
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions { raises_priority: false, ..ThreadOptions::default() };
    let mut thread = ServoThread::start_on(clock, servo, device, options).unwrap();
    driver.advance(Duration::ZERO);
    let held = thread.control().latest().unwrap().tool.unwrap();
    assert_eq!((held.contacts, held.pose.translation), (0, Vector([0.0, 0.02, 0.0])));
    // The ground rises by 1.2 cm, and pushes the tool up by 2 mm.
    let raised = Pose::translation(Vector([0.0, 0.012, 0.0]));
    thread.control().set_poses(&[(0, raised)], Duration::ZERO).unwrap();
    driver.advance(Duration::from_millis(1));
    let snapshot = thread.control().latest().unwrap();
    let (held, touch) = (snapshot.tool.unwrap(), snapshot.touches[0]);
    assert!(held.contacts >= 2 && touch.contact, "{held:?}");
    assert!((held.pose.translation - Vector([0.0, 0.022, 0.0])).norm() < 1e-9);
    assert!((snapshot.reactions[0].force + touch.wanted).norm() < 1e-12);
    let event = thread.control().next_event().unwrap();
    assert!(matches!(event.kind, EventKind::Touch { .. }) && event.tick == 1);
    drop(driver);
    assert!(thread.end().report.tool.is_some());
}
