// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Forces that change hands: bodies that jump, squeeze, creep and let go; and what reports say of them.

use std::time::Duration;

use palpate_device::{PointState, profile_named};
use palpate_field::{Pose, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, HandoffOptions, Material, Probe, Protection, Servo, ServoOptions,
    Shell, Surface, Tool, ToolOptions, Touch, handoff,
};

use crate::common::cuboid;

fn at(x: f64, y: f64, z: f64) -> Pose<3> {
    Pose::translation(Vector([x, y, z]))
}

/// A plate of 20 mm whose top is at zero.
fn plate(stiffness: f64, static_friction: f64, dynamic_friction: f64) -> Body {
    let material = Material {
        stiffness,
        damping: 0.0,
        static_friction,
        dynamic_friction,
        ..Material::default()
    };
    let body = Body::new(cuboid([0.3, 0.02, 0.3]), Surface::new(&material).unwrap()).unwrap();
    body.at(at(0.0, -0.01, 0.0)).unwrap()
}

fn options() -> ServoOptions {
    ServoOptions {
        probe: Probe::new(0.002).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    }
}

fn on(device: &str, servo: Servo<palpate_haptics::Unprotected>) -> Servo {
    servo.protected(&Protection::new(profile_named(device).unwrap())).unwrap()
}

fn point(device: &str, bodies: Vec<Body>) -> Servo {
    on(device, Servo::new(Bodies::new(bodies).unwrap(), 1, options()).unwrap())
}

fn tool(bodies: Vec<Body>, ends: [Vector<f64, 3>; 2], balls: usize) -> Servo {
    let shell = Shell::capsule(ends, 0.002, balls).unwrap();
    let tool = Tool::new(shell, ToolOptions { stiffness: 1000.0, ..ToolOptions::default() });
    on(
        "omega",
        Servo::with_tool(Bodies::new(bodies).unwrap(), tool.unwrap(), options()).unwrap(),
    )
}

fn step(servo: &mut Servo, x: f64, y: f64, z: f64) -> Touch {
    servo.step(&[PointState::at_rest(Vector([x, y, z]))])[0]
}

/// In how many ticks a stage has taken away of the force.
fn taken(servo: &Servo) -> u64 {
    servo.stage_effects().named().map(|(_, effect)| effect.ticks).sum()
}

/// The largest force on a hand that touches nothing, in how many ticks, and its work [J]: a hand presses,
/// slides until it slips, and lifts at 1 m/s.
fn left_behind(device: &str, stiffness: f64, depth: f64, creep: f64) -> (f64, u32, f64) {
    let mut servo = point(device, vec![plate(stiffness, 0.9, 0.5)]);
    let (mut x, mut y, mut speed) = (0.0, 0.01, 0.0_f64);
    let (mut slipped, mut most, mut ticks, mut work) = (false, 0.0_f64, 0, 0.0);
    for tick in 0..4000 {
        let before = (servo.touches()[0], y);
        if slipped {
            speed = (speed + 0.05).min(1.0);
            y += 1e-3 * speed;
        } else if y > 0.002 - depth {
            y -= 2e-5;
        } else {
            x += 2e-5;
        }
        servo.set_pose(0, at(creep * f64::from(tick), -0.01, 0.0));
        let touch = step(&mut servo, x, y, 0.0);
        slipped |= x > 0.0 && servo.events().iter().any(|event| event.kind == EventKind::Slip);
        if slipped && !touch.contact && touch.force != Vector::ZERO {
            (most, ticks) = (most.max(touch.force.norm()), ticks + 1);
        }
        if slipped && !before.0.contact {
            work += before.0.force[1] * (y - before.1);
        }
    }
    (most, ticks, work)
}

/// Once, a slip counted as a handover after any body had moved, and 16 N stayed on a hand that had left.
#[test]
fn a_hand_that_left_a_creeping_plate_feels_nothing() {
    assert_eq!(left_behind("omega", 1000.0, 0.01, 0.0).0, 0.0);
    for (device, stiffness, depth) in [("omega", 1000.0, 0.01), ("delta", 1500.0, 0.015)] {
        // A plate that creeps by 1 nm/s.
        let (most, ticks, work) = left_behind(device, stiffness, depth, 1e-12);
        assert!(most < 0.5, "{device}: {most} N in {ticks} ticks without contact, {work} J");
    }
}

/// Once, `set_poses` looked at the ends of the way alone, and carried the hand along at 37 m/s.
#[test]
fn a_plate_that_a_frame_takes_through_the_hand_jumps() {
    for (far, over) in [(0.3, 16), (0.3, 0), (0.1, 16)] {
        let body = Body::new(cuboid([0.1, 0.01, 0.1]), Surface::smooth(1000.0, 0.0).unwrap());
        let mut servo = point("omega", vec![body.unwrap().at(at(0.0, -far, 0.0)).unwrap()]);
        let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
        let mut most = 0.0_f64;
        for tick in 0..1000 {
            if tick == 100 {
                let poses = [(0, at(0.0, far, 0.0))];
                control.set_poses(&poses, Duration::from_millis(over)).unwrap();
            }
            end.receive(&mut servo);
            most = most.max(step(&mut servo, 0.0, 0.0, 0.0).force.norm());
        }
        let proxy = servo.touches()[0].proxy;
        assert!(
            most < 0.1,
            "{far} m in {over} ms: {most} N towards {proxy:?}, the plate is far away"
        );
    }
}

/// The friction is lost at once: an event tells so.
#[test]
fn a_plate_that_jumps_away_a_little_tells_what_it_takes() {
    for to in [[0.01, -0.01], [0.0, -0.0121]] {
        let mut servo = point("omega", vec![plate(1000.0, 0.9, 0.5)]);
        let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
        let mut last = Vector::ZERO;
        for tick in 0..1100 {
            let y = 0.004 - 2e-5 * f64::from(tick.min(400));
            let x = 1e-5 * f64::from((tick - 450).clamp(0, 400));
            if tick == 1000 {
                control.set_poses(&[(0, at(to[0], to[1], 0.0))], Duration::ZERO).unwrap();
            }
            end.receive(&mut servo);
            let before = taken(&servo);
            let force = step(&mut servo, x, y, 0.0).force;
            let is_told = taken(&servo) > before || !servo.events().is_empty();
            let along = (force - last)[0].abs();
            let is_smooth = is_told || along < 0.5;
            assert!(is_smooth, "to {to:?}: tick {tick}: {last:?} to {force:?}");
            last = force;
        }
    }
}

/// Once, the coupling's damper took the jump of the tool for a velocity: 3.5 N, 0 N, 1.0 N.
#[test]
fn a_plate_that_jumps_away_under_a_tool_gives_no_spike() {
    let ends = [-0.01, 0.01].map(|x| Vector([x, 0.0, 0.0]));
    let mut servo = tool(vec![plate(1000.0, 0.0, 0.0)], ends, 15);
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let mut forces = Vec::new();
    for tick in 0..1100 {
        if tick == 1000 {
            control.set_poses(&[(0, at(0.0, -0.0125, 0.0))], Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        let y = 0.004 - 1e-5 * f64::from(tick.min(550));
        forces.push(step(&mut servo, 0.0, y, 0.0).force[1]);
    }
    let [before, at_once, after] = [forces[999], forces[1000], forces[1001]];
    assert!(at_once > after - 0.1, "{before} N, {at_once} N, {after} N: {}", taken(&servo));
}

/// A vertical rod slides along the edge of a block. Once, it hung 4 mm above the hand for 147 ticks and
/// gave no force.
#[test]
fn a_tool_that_is_held_away_from_the_hand_touches() {
    let block = Surface::smooth(1859.6, 0.0).unwrap();
    let block =
        Body::new(cuboid([0.03; 3]), block).unwrap().at(at(-0.015091, 0.003128, 0.024262));
    let small =
        Body::new(cuboid([0.1, 0.02, 0.1]), Surface::smooth(1000.0, 0.0).unwrap()).unwrap();
    let (tilt, half) = (1.100_092_700_091_371_f64, 0.024_305_103_942_223_65);
    let end = Vector([half * tilt.cos(), half * tilt.sin(), 0.0]);
    let small = small.at(at(0.0, -0.01, 0.0)).unwrap();
    let mut servo = tool(vec![small, block.unwrap()], [-end, end], 15);
    let (mut hand, mut floor) = (Vector([0.0, 0.06, 0.0]), f64::NEG_INFINITY);
    let mut away = Vec::new();
    for tick in 0..2000 {
        if hand[1] > floor {
            hand[1] -= 5e-5;
        } else {
            hand += Vector([0.018_775_413_545_350_332, 0.0, 0.022_375_241_637_509_43]) * 1e-3;
        }
        let touch = step(&mut servo, hand[0], hand[1], hand[2]);
        if touch.contact && floor == f64::NEG_INFINITY {
            floor = hand[1] - 0.005_117_300_316_603_361;
        }
        let held = servo.held_tool().unwrap();
        let gap = (held.pose.translation - hand).norm();
        if gap > 1e-3 && !touch.contact && !held.is_covered && !held.is_degraded {
            away.push((tick, gap));
        }
    }
    assert!(
        away.len() < 2,
        "{} ticks without force, from {:?} to {:?}",
        away.len(),
        away[0],
        away.last()
    );
}

/// What a tool feels when a plate that is 0.5 mm below it is put higher by `way` [m] at once, at `x` [m] of
/// its 0.15 m: the largest step [N], whether `Placed` was told, in how many ticks it was covered.
fn put_into_a_rod(x: f64, way: f64) -> (f64, bool, u32) {
    let small = Body::new(cuboid([0.04, 0.02, 0.04]), Surface::smooth(1000.0, 0.0).unwrap());
    let small = small.unwrap().at(at(x, -0.0125, 0.0)).unwrap();
    let mut servo = tool(vec![small], [Vector::ZERO, Vector([0.15, 0.0, 0.0])], 61);
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let (mut last, mut most, mut placed, mut covered) = (Vector::ZERO, 0.0_f64, false, 0);
    for tick in 0..400 {
        if tick == 100 {
            control.set_poses(&[(0, at(x, way - 0.0125, 0.0))], Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        let force = step(&mut servo, 0.0, 0.0, 0.0).force;
        most = most.max((force - last).norm());
        placed |= servo.events().iter().any(|event| event.kind == EventKind::Placed);
        covered += u32::from(servo.held_tool().unwrap().is_covered);
        last = force;
    }
    (most, placed, covered)
}

/// Once, jumps were looked for at the tool's origin alone.
#[test]
fn a_plate_that_is_put_into_the_tip_of_a_tool_is_told() {
    for way in [0.003, 0.004] {
        let [origin, tip] = [0.0, 0.14].map(|x| put_into_a_rod(x, way));
        assert!(origin.1, "{origin:?}");
        assert!(
            tip.1 && tip.2 < 5,
            "{way}: (step, placed, covered) {origin:?} at the origin, {tip:?} at the tip"
        );
    }
}

/// Once, it rose by 0.3 N a tick, as after an edit.
#[test]
fn a_jump_under_a_tool_lets_the_force_rise_by_20_newtons_a_second() {
    let (most, ..) = put_into_a_rod(0.0, 0.0024);
    assert!(most < 0.1, "{most} N in a tick");
}

/// Once, forces that rounding left at the limit did not count.
#[test]
fn every_tick_that_the_force_limit_shortens_counts() {
    let mut servo = point("omega", vec![plate(1000.0, 0.5, 0.4)]);
    let (mut missed, mut limited) = (Vec::new(), 0);
    for tick in 0..3000 {
        let y = 0.004 - 1e-5 * f64::from(tick);
        let before = taken(&servo);
        let touch = step(&mut servo, 0.003 * (0.01 * f64::from(tick)).sin(), y, 0.0);
        if touch.wanted.norm() > 12.5 {
            limited += 1;
            if taken(&servo) == before {
                missed.push((tick, touch.wanted.norm(), touch.force.norm()));
            }
        }
    }
    assert!(missed.is_empty(), "{} of {limited}: {:?}", missed.len(), missed.first());
}

/// A handover at the end of a rise gives too much until the force has followed.
#[test]
fn every_tick_that_an_approach_changes_counts() {
    use palpate_safety::{Change, Impedance, PortState, SafetyChain, SafetyOptions};
    let device = palpate_device::DeviceProfile::unlimited("free");
    let mut chain =
        SafetyChain::new(&device, 1000.0, SafetyOptions::new(Impedance::default())).unwrap();
    let up = |force: f64| Vector([0.0, force, 0.0]);
    for _ in 0..1000 {
        let _ = chain.step(up(10.0), &PortState::at_rest());
    }
    let mut state = PortState::at_rest();
    (state.change, state.start) = (Change::HandedOver, 0.9);
    let (mut before, mut uncounted) = (chain.report().ramp.ticks, Vec::new());
    for tick in 0..40 {
        let force = chain.step(up(2.0), &state)[1];
        let now = chain.report().ramp.ticks;
        if (force - 2.0).abs() > 1e-9 && now == before {
            uncounted.push((tick, force));
        }
        (before, state) = (now, PortState::at_rest());
    }
    assert!(uncounted.is_empty(), "2 N are wanted, and uncounted are {uncounted:?}");
}

/// A cube moves on between hand and table. Once, the force went from 0.1 N to 1.4 N in one tick.
#[test]
fn a_squeeze_that_lets_go_changes_the_force_step_by_step() {
    let cube =
        Body::new(cuboid([0.03; 3]), Surface::smooth(985.675_086_512_399_3, 0.0).unwrap())
            .unwrap();
    let turn = palpate_field::Rotation::from_axis_angle(
        Vector([0.0, 0.0, 1.0]),
        -0.076_370_949_588_294_27,
    )
    .unwrap();
    let pose = |way: f64| {
        let start = Vector([0.006_929_046_269_846_476, 0.018_018_417_253_084_985, 0.0]);
        let speed = Vector([-0.091_172_430_856_523_36, -0.093_662_192_874_872_4, 0.0]);
        Pose::new(turn, start + speed * (0.3 * (way / 0.3).sin()))
    };
    let cube = cube.at(Pose::new(turn, Vector([0.0, 0.1, 0.0]))).unwrap();
    let mut servo = point("omega", vec![plate(1000.0, 0.0, 0.0), cube]);
    let mut last = Vector::ZERO;
    for tick in 0..1000 {
        let time = 1e-3 * f64::from(tick);
        let above = Pose::translation(Vector([0.0, 0.1 * (1.0 - time / 0.75).max(0.0), 0.0]));
        servo.set_pose(1, above * pose((time - 0.75).max(0.0)));
        let before = taken(&servo);
        let y = (0.01 - 0.02 * time).max(0.000_553_422_139_696_627_1);
        let force = step(&mut servo, 0.0, y, 0.0).force;
        let is_told = taken(&servo) > before || !servo.events().is_empty();
        // The cube moves by 0.13 mm a tick.
        let change = (force - last).norm() - 0.13;
        assert!(
            is_told || change < 0.5,
            "{change} N more in tick {tick}: {last:?} to {force:?}"
        );
        last = force;
    }
}

/// A rod rests on a soft ball (193 N/m) and a hard plate (1000 N/m). Once, its force stepped from 3.4 N to
/// 9.4 N and back.
#[test]
fn a_tool_on_a_soft_and_a_hard_body_is_not_felt_by_turns() {
    let ball =
        Body::new(crate::common::ball::<3>(0.015), Surface::smooth(192.72, 0.0).unwrap())
            .unwrap();
    let ball = ball.at(at(-0.006_432_838, 0.011_195_427, 0.018_710_695)).unwrap();
    let small =
        Body::new(cuboid([0.1, 0.02, 0.1]), Surface::smooth(1000.0, 0.0).unwrap()).unwrap();
    let (tilt, half) = (0.320_924_740_576_018_05_f64, 0.025_121_003_717_035_004);
    let end = Vector([half * tilt.cos(), half * tilt.sin(), 0.0]);
    let mut servo = tool(vec![small.at(at(0.0, -0.01, 0.0)).unwrap(), ball], [-end, end], 15);
    let (mut hand, mut floor) = (Vector([0.0, 0.06, 0.0]), f64::NEG_INFINITY);
    let mut last = (Vector::ZERO, Vector::ZERO);
    for tick in 0..2000 {
        if hand[1] > floor {
            hand[1] -= 5e-5;
        } else {
            hand += Vector([-0.026_441_338, 0.0, 0.029_889_182]) * 1e-3;
        }
        let touch = step(&mut servo, hand[0], hand[1], hand[2]);
        if touch.contact && floor == f64::NEG_INFINITY {
            floor = hand[1] - 0.002_652_629;
        }
        let held = servo.held_tool().unwrap().pose.translation;
        let (change, moved) = ((touch.force - last.0).norm(), (held - last.1).norm());
        let is_still = moved < 2e-4;
        assert!(
            !is_still || change < 1.0,
            "{change} N in tick {tick}: {:?} to {:?}, wanted {:?}, the tool moved by {moved} m",
            last.0,
            touch.force,
            touch.wanted
        );
        last = (touch.force, held);
    }
}

/// A hand of 0.1 kg without damping swings against a plate with two ticks of delay, until the plate has become
/// soft; then a softer plate takes over, in the middle of a swing. Once, the force fell by 6 N in a tick.
#[test]
fn a_plate_that_takes_over_from_a_softened_one_gives_no_step() {
    let heights = |tick: i32| {
        let time = 1e-3 * f64::from(tick);
        let sunk = (0.02 * (time - 2.5).max(0.0)).min(0.004);
        [-0.01 - sunk, -0.012 + 0.0005 * (3.0 * time).sin()]
    };
    let mut servo = point("omega", vec![plate(1000.0, 0.0, 0.0), plate(300.0, 0.0, 0.0)]);
    let (mut y, mut speed, mut delayed) = (0.003, 0.0, [0.0; 2]);
    let (mut before, mut last) = (y, 0.0);
    for tick in 0..2700 {
        let ([first, second], earlier) = (heights(tick), heights(tick - 1));
        servo.set_pose(0, at(0.0, first, 0.0));
        servo.set_pose(1, at(0.0, second, 0.0));
        let read = (y / 1e-5_f64).round() * 1e-5;
        let velocity = Vector([0.0, speed, 0.0]);
        let position = Vector([0.0, read, 0.0]);
        let force = servo.step(&[PointState { position, velocity }])[0].force[1];
        let bodies = f64::max((first - earlier[0]).abs(), (second - earlier[1]).abs());
        let moved = 1000.0 * ((read - before).abs() + bodies);
        let step = (force - last).abs() - moved;
        assert!(tick < 5 || step <= 0.3 + 1e-9, "{tick}: {last} N to {force} N, {moved} N");
        (before, last) = (read, force);
        for _ in 0..20 {
            let pushed = delayed[0] + 300.0 * (-0.003 - y) - 0.3 * speed;
            speed += pushed / 0.1 * 5e-5;
            y += speed * 5e-5;
        }
        delayed = [delayed[1], force];
    }
    assert!(servo.safety()[0].limit_cycles.found > 0);
}
