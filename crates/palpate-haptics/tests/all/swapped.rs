// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scenes swapped under the hand: forces rise gently, and what protects the device is made anew
//! for what it renders.

use crate::common::tools::smooth;
use crate::common::{AnyServo, body, half_space};
use palpate_device::{DeviceProfile, PointState, TurnState, TurningProfile};
use palpate_field::{Pose, Vector};
use palpate_haptics::{
    Bodies, HandoffOptions, HapticsError, Material, Probe, Protection, Servo, ServoOptions,
    Shell, Surface, Tool, ToolOptions, ToolState, handoff,
};

const DEPTH: f64 = 1.0 / 256.0;

fn ground(material: Material) -> Bodies {
    body(half_space([0.0, 1.0, 0.0], 0.0), Surface::new(&material).unwrap())
}

fn of_stiffness(stiffness: f64) -> Bodies {
    ground(Material { stiffness, ..smooth() })
}

fn coupling() -> ToolOptions {
    ToolOptions {
        stiffness: 500.0,
        angular_stiffness: Some(2.0),
        damping: 0.5,
        angular_damping: 2e-4,
        ..ToolOptions::default()
    }
}

fn rod() -> Tool {
    let end = Vector([0.05, 0.0, 0.0]);
    Tool::new(Shell::capsule([-end, end], 1e-4, 2).unwrap(), coupling()).unwrap()
}

/// The forces of 300 ticks at rest in the ground, up to the first tick with that of the new one.
fn forces(mut servo: Box<dyn AnyServo>, soft: f64, stiff: f64) -> Vec<f64> {
    let mut states = [PointState::at_rest(Vector([0.0, 0.1, 0.0]))];
    servo.swap_bodies(of_stiffness(soft));
    servo.step(&states);
    states[0].position = Vector([0.0, -DEPTH, 0.0]);
    let mut all = Vec::new();
    for tick in 0..600 {
        if tick == 300 {
            servo.swap_bodies(of_stiffness(stiff));
        }
        servo.step(&states);
        all.push(servo.forces()[0][1]);
    }
    all
}

/// All that renders forces: points with and without a safety chain, and a tool.
fn servos() -> Vec<(&'static str, Box<dyn AnyServo>)> {
    let options = ServoOptions {
        probe: Probe::new(0.0).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    };
    let plain = Servo::new(of_stiffness(100.0), 1, options).unwrap();
    let protection = Protection::new(DeviceProfile::unlimited("example"))
        .with(|s| s.rise_rate = 10.0 * 800.0 * DEPTH);
    let protected = plain.clone().protected(&protection).unwrap();
    let tool = ToolOptions { stiffness: 1000.0, damping: 0.0, ..coupling() };
    let tool = Tool::new(Shell::ball(1e-6).unwrap(), tool).unwrap();
    let tool = Servo::with_tool(of_stiffness(100.0), tool, options).unwrap();
    vec![
        ("plain", Box::new(plain)),
        ("protected", Box::new(protected)),
        ("tool", Box::new(tool)),
    ]
}

#[test]
fn a_stiffer_material_under_the_hand_rises_to_its_force() {
    // Once the force of the new material was there in one tick.
    for (name, servo) in servos() {
        let forces = forces(servo, 100.0, 800.0);
        let (soft, stiff) = (100.0 * DEPTH, 800.0 * DEPTH);
        assert!((forces[299] - soft).abs() < 1e-3 * soft, "{name}: {}", forces[299]);
        // 0.1 s are 100 ticks from nothing to all of it.
        for (tick, pair) in forces[299..].windows(2).enumerate() {
            let rise = pair[1] - pair[0];
            assert!((-1e-9..0.010_01 * stiff).contains(&rise), "{name}, {tick}: {pair:?}");
        }
        assert!(forces[380] < 0.99 * stiff, "{name}: {}", forces[380]);
        assert!((forces[400] - stiff).abs() < 1e-3 * stiff, "{name}: {}", forces[400]);
    }
}

#[test]
fn a_softer_material_and_the_same_one_are_felt_at_once() {
    for (stiffness, part) in [(100.0, 1.0), (25.0, 0.25)] {
        for (name, servo) in servos() {
            let forces = forces(servo, 100.0, stiffness);
            let expected = part * forces[299];
            for force in &forces[300..] {
                assert!((force - expected).abs() < 1e-3 * expected, "{name}: {force}");
            }
        }
    }
}

/// It bears a coupling alone, hardly, and not with bodies that damp.
fn device() -> DeviceProfile {
    let turning = TurningProfile { least_damping: 1.2e-3, ..TurningProfile::unlimited() };
    DeviceProfile {
        max_stiffness: 300.0,
        least_damping: 0.7,
        turning: Some(turning),
        ..DeviceProfile::unlimited("example")
    }
}

fn with_rod(bodies: Bodies) -> Servo {
    let servo = Servo::with_tool(bodies, rod(), ServoOptions::default()).unwrap();
    servo.protected(&Protection::new(device())).unwrap()
}

fn damped(damping: f64) -> Bodies {
    ground(Material { stiffness: 1e4, damping, ..smooth() })
}

#[test]
fn a_tool_hangs_on_new_bodies_as_if_it_had_been_protected_on_them() {
    // Once each new body was made ready alone, and the coupling and the arms of its dampers
    // stayed as they were: what turned the hand was not as passive as the device needs.
    let soft = || of_stiffness(100.0);
    let scenes: [&dyn Fn() -> Bodies; 4] =
        [&soft, &|| damped(0.0), &|| damped(0.4), &|| damped(4.0)];
    let mut seen = Vec::new();
    for before in scenes {
        for after in scenes {
            let mut servo = with_rod(before());
            let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
            let accepted = control.replace_bodies(after()).unwrap();
            end.receive(&mut servo);
            let fresh = with_rod(after());
            let (tool, expected) = (servo.tool().unwrap(), fresh.tool().unwrap());
            assert_eq!(tool.coupling(), expected.coupling());
            assert_eq!(tool.options(), expected.options());
            let (report, expected) = (servo.safety(), fresh.safety());
            assert_eq!(report, expected);
            assert_eq!(accepted[0], expected[0].impedance);
            assert_eq!(accepted[1], expected[0].turning.as_ref().unwrap().impedance);
            let surfaces = |servo: &Servo| {
                let bodies = servo.bodies().bodies().iter();
                bodies.map(|body| body.surface().stiffness()).collect::<Vec<_>>()
            };
            assert_eq!(surfaces(&servo), surfaces(&fresh));
            seen.push((tool.coupling().arms, tool.coupling().stiffness));
        }
    }
    // Some scenes shorten the arms, some make all softer, some do neither.
    assert!(seen.iter().any(|(arms, _)| *arms < 1.0));
    assert!(seen.iter().any(|(_, stiffness)| *stiffness < 400.0));
    assert!(seen.contains(&(1.0, 500.0)), "{seen:?}");
}

/// What was given back had the stiffness that was accepted for the other bodies: a hard body was
/// rendered with the coupling of a soft one.
#[test]
fn bodies_that_are_given_back_are_rendered_as_they_were() {
    let scenes = [of_stiffness(100.0), damped(0.0), damped(0.4), damped(4.0)];
    for before in &scenes {
        for after in &scenes {
            let mut servo = with_rod(before.clone());
            let mut bodies = servo.accept(after.clone()).unwrap();
            for now in [after, before, after] {
                servo.replace_bodies(&mut bodies).unwrap();
                let fresh = with_rod(now.clone());
                assert_eq!(servo.tool().unwrap().coupling(), fresh.tool().unwrap().coupling());
                assert_eq!(servo.accepted(), fresh.accepted());
                assert_eq!(servo.safety(), fresh.safety());
            }
        }
    }
}

/// Bodies that a stronger device renders, or that nobody checked, were rendered by any servo.
#[test]
fn bodies_that_were_accepted_for_another_servo_are_refused() {
    let unlimited = Protection::new(DeviceProfile::unlimited("strong"));
    let tool = |bodies| Servo::with_tool(bodies, rod(), ServoOptions::default()).unwrap();
    let strong = tool(damped(0.0)).protected(&unlimited).unwrap();
    let mut weak = with_rod(damped(0.0));
    let accepted = weak.accepted().to_vec();
    let mut bodies = strong.accept(damped(4.0)).unwrap();
    assert_eq!(weak.replace_bodies(&mut bodies), Err(HapticsError::OtherServo));
    assert_eq!(weak.accepted(), accepted);
    assert_eq!(strong.clone().replace_bodies(&mut bodies), Ok(()));

    let plain = tool(damped(0.0));
    let (mut control, mut end) = handoff(&plain, HandoffOptions::default());
    let mut servo = plain.protected(&Protection::new(device())).unwrap();
    end.receive(&mut servo);
    assert!(!servo.is_stopped());
    control.replace_bodies(damped(4.0)).unwrap();
    end.receive(&mut servo);
    assert!(servo.is_stopped());
    assert_eq!(servo.accepted(), accepted);
    // Once only a stop that lasted over a tick and a release let the servo go on.
    control.stop_switch().release();
    end.receive(&mut servo);
    assert!(!servo.is_stopped());
}

#[test]
fn energy_is_counted_through_a_change_of_units() {
    // A coupling that is softer about axes has another radian; what was taken in before counts.
    let mut servo = with_rod(damped(0.0));
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let state = |y: f64| [PointState::at_rest(Vector([0.0, y, 0.0]))];
    let turn =
        TurnState { orientation: Pose::identity().rotation, angular_velocity: Vector::ZERO };
    servo.set_turn(Some(turn));
    for tick in 0..1000 {
        if tick == 500 {
            let before = servo.energy(0);
            control.replace_bodies(damped(4.0)).unwrap();
            end.receive(&mut servo);
            assert_eq!(servo.energy(0), before);
        }
        let t = f64::from(tick) * 1e-3;
        servo.step(&state(0.004 * (20.0 * t).cos() - 0.001));
    }
    let report = servo.safety().remove(0);
    assert!(report.passivity.energy_in > 0.0, "{report:?}");
    assert!(report.passivity.least_balance > -1e-3, "{report:?}");
}

#[test]
fn a_tool_alone_rises_on_other_bodies_too() {
    let (mut soft, mut stiff) = (of_stiffness(100.0), of_stiffness(400.0));
    let mut tool = rod();
    let at = |y| ToolState::at_rest(Pose::translation(Vector([0.0, y, 0.0])));
    tool.step(&mut soft, &at(0.01));
    for _ in 0..10 {
        tool.step(&mut soft, &at(-DEPTH));
    }
    let before = tool.touch().force[1];
    tool.forget_bodies();
    tool.step(&mut stiff, &at(-DEPTH));
    assert!((tool.touch().force[1] - before).abs() < 1e-9 * before);
    for _ in 0..100 {
        tool.step(&mut stiff, &at(-DEPTH));
    }
    assert!((tool.touch().force[1] / before - 4.0).abs() < 1e-6);
}
