// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Hands and tools in open wedges, at rims and seams of bodies that move, and where bodies jump.

use std::time::Duration;

use palpate_device::{PointState, profile_named};
use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, HandoffOptions, Magnet, Material, Probe, Protection, Servo,
    ServoOptions, Shell, Surface, Tool, ToolOptions, Unprotected, handoff,
};

use crate::common::cuboid;

fn at(x: f64, y: f64, z: f64) -> Pose<3> {
    Pose::translation(Vector([x, y, z]))
}

fn body(shape: Shape<3>, stiffness: f64, friction: f64, pose: Pose<3>) -> Body {
    let material = Material {
        stiffness,
        damping: 0.0,
        static_friction: friction,
        dynamic_friction: 0.75 * friction,
        ..Material::default()
    };
    Body::new(shape, Surface::new(&material).unwrap()).unwrap().at(pose).unwrap()
}

fn options() -> ServoOptions {
    ServoOptions {
        probe: Probe::new(0.002).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    }
}

fn on(device: &str, servo: Servo<Unprotected>) -> Servo {
    servo.protected(&Protection::new(profile_named(device).unwrap())).unwrap()
}

fn point(device: &str, bodies: Vec<Body>) -> Servo {
    on(device, Servo::new(Bodies::new(bodies).unwrap(), 1, options()).unwrap())
}

fn tool(shell: Shell, bodies: Vec<Body>) -> Servo {
    let options_of_tool =
        ToolOptions { stiffness: 1000.0, damping: 0.0, ..ToolOptions::default() };
    let tool = Tool::new(shell, options_of_tool).unwrap();
    on("omega", Servo::with_tool(Bodies::new(bodies).unwrap(), tool, options()).unwrap())
}

/// One side of a V whose faces lean by `half` [rad] from the vertical and meet at the origin.
fn side(sign: f64, half: f64) -> Pose<3> {
    let normal = Vector([sign * half.cos(), half.sin(), 0.0]);
    let turn = -normal[0].atan2(normal[1]);
    let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), turn).unwrap();
    Pose::new(turn, normal * -0.02)
}

/// A V of two plates whose faces lean by `half` degrees from the vertical; the left one swings by `swing` [m]
/// at `hz`, the right one stands still. A rigid hand swings across it, 3 mm below its bottom. Returns in how
/// many ticks on end the hand is more than 1 mm deep in a plate and no force is wanted, how deep it is then
/// at most [m], and the events `Squeezed`.
fn in_a_v(
    half: f64,
    swing: Vector<f64, 3>,
    hz: f64,
    across: f64,
    is_tool: bool,
) -> (u32, f64, u32) {
    let half = half.to_radians();
    let poses = [side(1.0, half), side(-1.0, half)];
    let bodies = poses.map(|pose| body(cuboid([0.1, 0.04, 0.1]), 1000.0, 0.0, pose)).to_vec();
    let mut servo = if is_tool {
        let ends = [-0.01, 0.01].map(|z| Vector([0.0, 0.0, z]));
        tool(Shell::capsule(ends, 0.002, 11).unwrap(), bodies)
    } else {
        point("omega", bodies)
    };
    let bottom = 0.002 / half.sin();
    let (mut silent, mut longest, mut deepest, mut squeezes) = (0, 0, 0.0_f64, 0);
    for tick in 0..4000 {
        let time = 1e-3 * f64::from(tick);
        let part = (time / 0.5).min(1.0);
        let x = across * (3.0 * (time - 0.5).max(0.0)).sin();
        let hand = Vector([x, bottom + 0.01 * (1.0 - part) - 0.003 * part, 0.0]);
        let wave = (std::f64::consts::TAU * hz * time).sin();
        servo.set_pose(0, Pose::new(poses[0].rotation, poses[0].translation + swing * wave));
        let touch = servo.step(&[PointState::at_rest(hand)])[0];
        squeezes +=
            servo.events().iter().filter(|it| it.kind == EventKind::Squeezed).count() as u32;
        let deep = servo.bodies().bodies().iter().map(|body| {
            let place = body.world_from_body().inverse().transform_point(hand);
            0.002 - body.shape().distance(place)
        });
        let deep = deep.fold(f64::MIN, f64::max);
        if time > 0.6 && deep > 1e-3 && touch.wanted.norm() < 0.05 {
            silent += 1;
            deepest = deepest.max(deep);
            longest = longest.max(silent);
        } else {
            silent = 0;
        }
    }
    (longest, deepest, squeezes)
}

/// The V is open above: there is always room. Once, the plate that moves yielded, and the hand felt nothing
/// for up to 935 ticks.
#[test]
fn a_v_that_moves_pushes_a_hand_out() {
    let mut bad = Vec::new();
    for (half, is_tool) in
        [45.0, 26.0, 20.0].into_iter().flat_map(|half| [(half, false), (half, true)])
    {
        for swing in [[0.002, 0.002], [0.0005, 0.0003]] {
            for (hz, across) in [(1.0, 0.006), (3.0, 0.005)] {
                let swing = Vector([swing[0], swing[1], 0.0]);
                let found = in_a_v(half, swing, hz, across, is_tool);
                if found.0 > 20 {
                    bad.push(found);
                }
            }
        }
    }
    assert!(
        bad.is_empty(),
        "{} of 24, the longest {:?}",
        bad.len(),
        bad.iter().max_by_key(|it| it.0)
    );
}

/// A rigid hand goes down through a thin plate that creeps, slides out under its rim, and goes up beside it.
/// The plate lets it go step by step, by 0.5 N a tick beyond what the motion of the hand explains.
#[test]
fn a_hand_that_slides_out_under_a_rim_is_let_go() {
    for (device, friction) in [("omega", 0.0), ("omega", 0.5), ("delta", 0.0)] {
        for creep in [1e-12, 1e-5] {
            let rim = body(cuboid([0.04, 0.004, 0.1]), 1000.0, friction, at(0.0, -0.002, 0.0));
            let mut servo = point(device, vec![rim]);
            let (mut hand, mut free) = (Vector([0.0, 0.01, 0.0]), 0);
            let mut before = servo.touches()[0];
            for tick in 0..1500 {
                let is_out = tick > 500 && !before.contact;
                let [down, aside, up] =
                    [tick < 500, tick >= 500, is_out].map(|is| f64::from(u32::from(is)));
                // To 12 mm below the top of the plate.
                hand += Vector([1e-4 * aside, 3e-4 * up - 4.4e-5 * down, 0.0]);
                servo.set_pose(0, at(creep * f64::from(tick), -0.002, 0.0));
                let touch = servo.step(&[PointState::at_rest(hand)])[0];
                if is_out {
                    let moved = 1000.0 * (touch.device - before.device).norm();
                    let fallen = before.force.norm() - touch.force.norm();
                    let is_gone = touch.force.norm() < 1e-9;
                    assert!(
                        fallen <= 0.5 + moved + 1e-9,
                        "{device} {tick}: {before:?} {touch:?}"
                    );
                    assert!(is_gone || fallen >= 0.5, "{device} {tick}: {before:?} {touch:?}");
                    free += u32::from(is_gone);
                }
                before = touch;
            }
            assert!(free > 500, "{device}: {free}");
        }
    }
}

/// A hand presses on a plate that then jumps `far` [m] down at once. Returns the force before [N], the largest
/// force after the jump on a hand that nothing touches, in how many ticks, and its work on a hand that goes
/// up at 0.3 m/s [J].
fn jumped_away(
    creep: f64,
    far: f64,
    device: &str,
    is_tool: bool,
    over: u64,
) -> (f64, f64, u32, f64) {
    let bodies = vec![body(cuboid([0.2, 0.02, 0.2]), 1000.0, 0.0, at(0.0, -0.01, 0.0))];
    let mut servo = if is_tool {
        let ends = [-0.01, 0.01].map(|x| Vector([x, 0.0, 0.0]));
        let shell = Shell::capsule(ends, 0.002, 11).unwrap();
        let of_tool = ToolOptions { stiffness: 1000.0, damping: 0.0, ..ToolOptions::default() };
        let tool = Tool::new(shell, of_tool).unwrap();
        on(device, Servo::with_tool(Bodies::new(bodies).unwrap(), tool, options()).unwrap())
    } else {
        point(device, bodies)
    };
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let mut hand = Vector([0.0, 0.01, 0.0]);
    let (mut before, mut most, mut ticks, mut work) = (0.0, 0.0_f64, 0, 0.0);
    for tick in 0..1500 {
        let last = hand;
        if tick < 500 {
            hand[1] -= 3.8e-5; // 11 mm deep
        }
        if tick >= 1000 {
            hand[1] += 3e-4;
            let force = servo.touches()[0].force;
            if tick == 1000 {
                before = force.norm();
            } else if force.norm() > 0.05 && !servo.touches()[0].contact {
                most = most.max(force.norm());
                ticks += 1;
                work += force.dot(hand - last);
            }
        }
        if tick < 1000 {
            servo.set_pose(0, at(creep * f64::from(tick), -0.01, 0.0));
        }
        if tick == 1000 {
            control
                .set_poses(&[(0, at(0.0, -0.01 - far, 0.0))], Duration::from_millis(over))
                .unwrap();
        }
        end.receive(&mut servo);
        servo.step(&[PointState::at_rest(hand)]);
    }
    (before, most, ticks, work)
}

/// Once, after a creep of 1 nm/s, 10 N stayed on the hand for 18 ticks.
#[test]
fn a_plate_that_jumps_away_leaves_no_force() {
    let mut bad = Vec::new();
    for (device, is_tool) in [("omega", false), ("omega", true), ("delta", false)] {
        for far in [0.015, 0.2] {
            for creep in [0.0, 1e-12] {
                for over in [0, 5] {
                    let found = jumped_away(creep, far, device, is_tool, over);
                    if found.1 > 0.5 && found.2 > 3 {
                        bad.push(found);
                    }
                }
            }
        }
    }
    assert!(bad.is_empty(), "{} of 24: {bad:?}", bad.len());
}

fn cube() -> Shell {
    Shell::of_shape(cuboid([0.02, 0.02, 0.02]), 250, 0.0).unwrap()
}

fn short_rod() -> Shell {
    Shell::capsule([-0.01, 0.01].map(|x| Vector([x, 0.0, 0.0])), 0.002, 11).unwrap()
}

fn stylus(balls: f64) -> Shell {
    let shaft =
        Shape::<3>::cylinder(0.004, 0.06).unwrap().translated([0.0, 0.036, 0.0]).unwrap();
    let shape = Shape::union([shaft, Shape::cone(0.004, 0.012).unwrap()]).unwrap();
    Shell::from_field(&shape, 250, balls).unwrap()
}

/// A tool hovers; a plate 20 mm thick, `from` below it, jumps `way` less 1 mm into it at once [m]. Returns in
/// how many of the 900 ticks after it the tool is covered, in how many it gives no force, how many events there
/// are, and the last force [N].
fn swallowed(shell: Shell, way: f64, place: f64, from: f64) -> (u32, u32, usize, f64) {
    let lowest =
        shell.points().iter().map(|it| it.radius - it.centre[1]).fold(f64::MIN, f64::max);
    let plate = body(cuboid([0.2, 0.02, 0.2]), 1000.0, 0.3, at(place, -0.01 - from, 0.0));
    let mut servo = tool(shell, vec![plate]);
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let (mut covered, mut silent, mut events) = (0, 0, 0);
    for tick in 0..1000 {
        if tick == 100 {
            control.set_poses(&[(0, at(place, way - 0.01, 0.0))], Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        let touch = servo.step(&[PointState::at_rest(Vector([0.0, lowest + 0.001, 0.0]))])[0];
        if tick > 100 {
            covered += u32::from(servo.held_tool().unwrap().is_covered);
            silent += u32::from(touch.force.norm() < 0.05);
        }
        events += servo.events().len();
    }
    (covered, silent, events, servo.touches()[0].force.norm())
}

/// A tool that a body covers gives no force until it is out; an event tells so.
#[test]
fn a_plate_that_jumps_over_a_tool_is_told() {
    for shell in [stylus(0.0), stylus(0.001), cube(), short_rod()] {
        for way in [0.003, 0.009, 0.015] {
            for (place, from) in [(0.0, 0.0), (0.09, 0.3)] {
                let (covered, silent, events, force) =
                    swallowed(shell.clone(), way, place, from);
                let is_told = events > 0 || covered == 0;
                assert!(is_told, "{way} {place} {from}: {covered} {silent} {force}");
            }
        }
    }
}

/// A box is pressed up to 9 mm into two level plates that touch, and slides over their seam without friction.
/// The plates drift by less than 1 mm, at no more than 8 mm/s. Returns in how many ticks on end no force is
/// wanted though the hand is deep, in how many ticks the tool is covered, and the events in these ticks.
fn box_on_drifting_plates(depth: f64, drift: f64, phase: f64) -> (u32, u32, Vec<EventKind>) {
    let poses = [at(-0.05, -0.01, 0.0), at(0.05, -0.01, 0.0)];
    let drifts = [[0.58e-3, 0.04e-3, -0.63e-3], [0.04e-3, 0.34e-3, -0.42e-3]].map(Vector);
    let bodies = poses.map(|pose| body(cuboid([0.1, 0.02, 0.1]), 1000.0, 0.0, pose)).to_vec();
    let shell = Shell::of_shape(cuboid([0.01365, 0.02548, 0.01205]), 250, 0.0).unwrap();
    let mut servo = tool(shell, bodies);
    let (mut silent, mut longest, mut covered, mut events) = (0, 0, 0, Vec::new());
    for tick in 0..4000 {
        let time = 1e-3 * f64::from(tick);
        let part = (time / 0.5).min(1.0);
        let after = (time - 0.5).max(0.0);
        let hand = Vector([
            0.0157 * (4.0 * after).sin(),
            0.01274 + 0.02 * (1.0 - part) - depth * part,
            0.0088 * (2.24 * after).sin(),
        ]);
        for (index, hz) in [(0, 1.38), (1, 2.18)] {
            let wave = (std::f64::consts::TAU * hz * time + phase * index as f64).sin() * drift;
            servo.set_pose(
                index,
                Pose::translation(poses[index].translation + drifts[index] * wave),
            );
        }
        let touch = servo.step(&[PointState::at_rest(hand)])[0];
        let is_covered = servo.held_tool().unwrap().is_covered;
        covered += u32::from(is_covered);
        if time > 0.6 && touch.wanted.norm() < 0.05 {
            silent += 1;
            longest = longest.max(silent);
            events.extend(servo.events().iter().map(|it| it.kind));
        } else {
            silent = 0;
        }
    }
    (longest, covered, events)
}

#[test]
fn a_box_on_plates_that_drift_is_pushed_out() {
    let mut bad = Vec::new();
    for depth in [0.003, 0.005, 0.007] {
        for drift in [0.0, 0.1, 0.3, 1.0] {
            for phase in [0.5, 1.5, 3.0] {
                let found = box_on_drifting_plates(depth, drift, phase);
                if found.0 > 20 {
                    bad.push(found.0);
                }
            }
        }
    }
    assert!(bad.is_empty(), "{} of 36: {bad:?}", bad.len());
}

/// Input that is no number, too large, or that comes at the wrong moment: no panic, no NaN, and an error
/// where something is refused.
#[test]
fn bad_poses_of_moving_bodies_are_refused_or_told() {
    let wild = [f64::NAN, f64::INFINITY, 1e300, -1e300, 1e15, 1e-300, 0.0];
    for is_tool in [false, true] {
        let bodies = || vec![body(cuboid([0.2, 0.02, 0.2]), 1000.0, 0.3, at(0.0, -0.01, 0.0))];
        for x in wild {
            for y in wild {
                let mut servo = if is_tool {
                    tool(stylus(0.0), bodies())
                } else {
                    point("omega", bodies())
                };
                let largest_speed = if x == 1e15 { f64::NAN } else { 2.0 };
                let options = HandoffOptions { largest_speed, ..HandoffOptions::default() };
                let (mut control, mut end) = handoff(&servo, options);
                let mut refused = 0;
                for tick in 0..300_i32 {
                    if tick == 100 {
                        let result =
                            control.set_poses(&[(0, at(x, y, 0.0))], Duration::from_millis(16));
                        refused += u32::from(result.is_err());
                        assert!(
                            control
                                .set_poses(&[(7, at(0.0, 0.0, 0.0))], Duration::ZERO)
                                .is_err()
                        );
                    }
                    if tick == 150 {
                        servo.set_pose(0, at(y, x, 0.0));
                        servo.set_pose(9, at(0.0, 0.0, 0.0));
                    }
                    if tick == 200 {
                        control.set_poses(&[(0, at(0.0, -0.01, 0.0))], Duration::MAX).unwrap();
                    }
                    if tick == 250 {
                        control.set_poses(&[(0, at(0.0, -0.01, 0.0))], Duration::ZERO).unwrap();
                    }
                    end.receive(&mut servo);
                    let hand =
                        if tick == 120 { Vector([x, y, 0.0]) } else { Vector([0.0, 0.0, 0.0]) };
                    let touch = servo.step(&[PointState::at_rest(hand)])[0];
                    assert!(
                        touch.force.is_finite() && touch.proxy.is_finite(),
                        "{x} {y} {tick}: {touch:?}"
                    );
                }
                assert!(refused > 0 || x.is_finite() && y.is_finite(), "{x} {y}");
            }
        }
    }
}

/// A plate that touches a hand goes up by 150 mm at `speed` [m/s]. Returns the largest power `F.v` of the
/// plate [W], the ticks above 1 W, its work [J], and the largest rise of the force while the power of the
/// force before already exceeds 1 W [N].
fn power_of_a_plate(speed: f64, first: f64) -> (f64, u32, f64, f64) {
    let mut servo = point(
        "omega",
        vec![body(cuboid([0.2, 0.02, 0.2]), 1000.0, 0.0, at(0.0, -0.01 - first, 0.0))],
    );
    let (mut most, mut ticks, mut work, mut rise, mut last) = (0.0_f64, 0, 0.0, 0.0_f64, 0.0);
    let mut hand = 0.0015;
    let (mut above, mut top) = (-0.01 - first, -0.01 - first);
    for tick in 0..1000 {
        if tick >= 500 {
            above = (above + speed * 1e-3).min(0.14);
        }
        servo.set_pose(0, at(0.0, above, 0.0));
        let force = servo.step(&[PointState::at_rest(Vector([0.0, hand, 0.0]))])[0].force[1];
        let power = force * (above - top) * 1e3;
        work += force * (above - top);
        most = most.max(power);
        ticks += u32::from(power > 1.01);
        if last * (above - top) * 1e3 > 1.01 {
            rise = rise.max(force - last);
        }
        (last, top) = (force, above);
        // A hand of 200 N/m that gives way, slowly.
        hand += 0.05 * ((0.0015 + force / 200.0) - hand);
    }
    (most, ticks, work, rise)
}

/// Where the power exceeds 1 W, the force falls by 0.3 N a tick, and never rises.
#[test]
fn a_plate_that_drives_a_hand_keeps_its_power() {
    let mut bad = Vec::new();
    for first in [0.0, 0.02] {
        for speed in [0.3, 0.6, 1.0, 2.0, 5.0, 15.0] {
            let found = power_of_a_plate(speed, first);
            if found.0 > 2.0 || found.3 > 1e-6 {
                bad.push(found);
            }
        }
    }
    assert!(bad.is_empty(), "{} of 12", bad.len());
}

/// A floor that rests, a tool that hovers above it, and a block that jumps onto both from 0.2 m away. Returns
/// the events from then on, in how many of 900 ticks the tool is covered, and in how many there is no force.
fn block_onto_a_hovering_tool(
    shell: Option<Shell>,
    height: f64,
    place: [f64; 3],
) -> (Vec<EventKind>, u32, u32) {
    let lowest = shell.as_ref().map_or(0.002, |shell| {
        shell.points().iter().map(|it| it.radius - it.centre[1]).fold(f64::MIN, f64::max)
    });
    let floor = body(cuboid([0.2, 0.02, 0.2]), 1000.0, 0.3, at(0.0, -0.01, 0.0));
    let block = body(cuboid([0.05, height, 0.1]), 1000.0, 0.3, at(0.0, 0.07, -0.19));
    let mut servo = match shell {
        Some(shell) => tool(shell, vec![floor, block]),
        None => point("omega", vec![floor, block]),
    };
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let (mut events, mut covered, mut silent) = (Vec::new(), 0, 0);
    for tick in 0..1000 {
        if tick == 100 {
            let poses = [(1, at(place[0], place[1], place[2]))];
            control.set_poses(&poses, Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        let hand = Vector([0.0, lowest + 0.0005, 0.0]);
        let touch = servo.step(&[PointState::at_rest(hand)])[0];
        if tick >= 100 {
            events.extend(servo.events().iter().map(|it| it.kind));
            covered += u32::from(servo.held_tool().is_some_and(|it| it.is_covered));
            silent += u32::from(touch.force.norm() < 0.05);
        }
    }
    (events, covered, silent)
}

#[test]
fn a_block_that_jumps_onto_a_hovering_tool_is_told() {
    for shell in [None, Some(stylus(0.0)), Some(short_rod()), Some(cube())] {
        for height in [0.01, 0.0135, 0.03] {
            for place in [[0.0, 0.003, 0.0], [0.01, 0.005, 0.02], [0.0, 0.0, 0.0]] {
                let (events, covered, _) =
                    block_onto_a_hovering_tool(shell.clone(), height, place);
                let is_told = events.iter().any(|it| !matches!(it, EventKind::Touch { .. }));
                assert!(is_told || covered == 0, "{height} {place:?}: {covered} {events:?}");
            }
        }
    }
}

/// A plate under a hovering tool 20 mm thick jumps into it, in a tick in which a body far away moves or does not.
/// Returns the events, and in how many of 900 ticks there is no force.
fn jump_beside_a_body_that_moves(
    shell: Option<Shell>,
    moves: bool,
    way: f64,
) -> (Vec<EventKind>, u32) {
    let lowest = shell.as_ref().map_or(0.002, |shell| {
        shell.points().iter().map(|it| it.radius - it.centre[1]).fold(f64::MIN, f64::max)
    });
    let plate = body(cuboid([0.2, 0.02, 0.2]), 1000.0, 0.0, at(0.0, -0.01, 0.0));
    let far = body(cuboid([0.01; 3]), 1000.0, 0.0, at(0.3, 0.0, 0.0));
    let bodies = vec![plate, far];
    let mut servo = match shell {
        Some(shell) => tool(shell, bodies),
        None => point("omega", bodies),
    };
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let (mut events, mut silent) = (Vec::new(), 0);
    for tick in 0..1000 {
        if moves {
            servo.set_pose(1, at(0.3 + 1e-5 * f64::from(tick), 0.0, 0.0));
        }
        if tick == 100 {
            control.set_poses(&[(0, at(0.0, way - 0.01, 0.0))], Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        let touch = servo.step(&[PointState::at_rest(Vector([0.0, lowest + 0.0005, 0.0]))])[0];
        if tick >= 100 {
            events.extend(servo.events().iter().map(|it| it.kind));
            silent += u32::from(touch.force.norm() < 0.05);
        }
    }
    (events, silent)
}

#[test]
fn a_body_that_moves_far_away_changes_nothing_of_a_jump() {
    for shell in [None, Some(stylus(0.0)), Some(cube()), Some(short_rod())] {
        for way in [0.003, 0.008, 0.012, 0.015] {
            let [alone, beside] = [false, true]
                .map(|moves| jump_beside_a_body_that_moves(shell.clone(), moves, way));
            let is_told =
                |it: &[EventKind]| it.iter().any(|it| !matches!(it, EventKind::Touch { .. }));
            assert_eq!(is_told(&alone.0), is_told(&beside.0), "{way} m: {alone:?}, {beside:?}");
        }
    }
}

/// A plate jumps onto the hand and slides away while the force rises. Once, the force rose on for four ticks
/// after the hand was free.
#[test]
fn a_hand_that_is_free_again_while_the_force_rises_is_let_go() {
    let plate = body(cuboid([0.02, 0.02, 0.1]), 1000.0, 0.0, at(0.0, -0.01, 0.0));
    let mut servo = point("omega", vec![plate]);
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let (mut last, mut most) = (0.0_f64, 0.0_f64);
    for tick in 0..500 {
        if tick == 300 {
            control.set_poses(&[(0, at(0.0, 0.005, 0.0))], Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        if tick > 339 {
            servo.set_pose(0, at(1.5e-3 * f64::from(tick - 339), 0.005, 0.0));
        }
        let touch = servo.step(&[PointState::at_rest(Vector([0.0, 0.001, 0.0]))])[0];
        let force = touch.force.norm();
        assert!(touch.contact || force <= (last - 0.5).max(0.0), "{tick}: {last} N to {force}");
        (last, most) = (force, most.max(force));
    }
    assert!(most > 1.5 && last == 0.0, "{most} N, {last} N");
}

/// The forces on a hand 2.8 mm above a plate that pulls with 2 N, before which it is put from `from` to `to`
/// [m] at tick 100, and whether `Placed` was told then.
fn pulled(from: f64, to: f64) -> (Vec<f64>, bool) {
    let magnet = Some(Magnet { description: None, force: 2.0, distance: 0.01 });
    let material = Material { stiffness: 1000.0, magnet, ..Material::default() };
    let plate = Body::new(cuboid([0.1, 0.02, 0.1]), Surface::new(&material).unwrap()).unwrap();
    let mut servo = point("omega", vec![plate.at(at(0.0, from, 0.0)).unwrap()]);
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let (mut forces, mut is_told) = (Vec::new(), false);
    for tick in 0..300 {
        if tick == 100 {
            control.set_poses(&[(0, at(0.0, to, 0.0))], Duration::ZERO).unwrap();
        }
        end.receive(&mut servo);
        let touch = servo.step(&[PointState::at_rest(Vector([0.0, 0.0048, 0.0]))])[0];
        forces.push(-touch.force[1]);
        is_told |= servo.events().iter().any(|event| event.kind == EventKind::Placed);
    }
    (forces, is_told)
}

/// Once, the whole pull came and went in one tick, and nothing told it.
#[test]
fn a_magnet_that_jumps_pulls_step_by_step() {
    let (leaving, is_told) = pulled(-0.01, -0.04);
    assert!(is_told && (leaving[99] - 1.92).abs() < 1e-12 && leaving[106] == 0.0);
    let largest = |forces: &[f64]| {
        forces.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
    };
    let step = largest(&leaving[99..]);
    assert!(step <= 0.3 + 1e-12, "{step} N");
    let (coming, is_told) = pulled(-0.06, -0.01);
    assert!(is_told && coming[99] == 0.0 && (coming[299] - 1.92).abs() < 1e-12);
    let step = largest(&coming);
    assert!(step <= 0.02 + 1e-12, "{step} N");
}
