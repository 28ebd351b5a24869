// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tools with a shape: where they rest, what they give, what they do not cross.

use crate::common::tools::{STIFFNESS, at, box_mesh, on_a_loop, rest, rough, springs, turned};
use crate::common::{ball, body, cuboid, half_space};
use palpate_field::{Point, Pose, Rotation, Shape, SpaceShape, Vector};
use palpate_haptics::{Bodies, EventKind, Shell, Surface, Tool, ToolOptions, ToolState};
use palpate_mesh::Outline;

/// The least of the field less the radius over all points of the shell.
fn least_gap(shell: &Shell, pose: &Pose<3>, shape: impl Into<SpaceShape>) -> f64 {
    let shape: SpaceShape = shape.into();
    let points = shell.points().iter();
    points
        .map(|point| shape.shape().distance(pose.transform_point(point.centre)) - point.radius)
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn a_ball_off_its_handle_gives_force_and_torque() {
    let ground = half_space([0.0, 1.0, 0.0], 0.0);
    let mut bodies = Bodies::from(ground);
    // A ball 0.1 m beside the origin would turn the tool: it is held by a stiff wrist alone.
    let ends = [Vector([0.1, 0.0, 0.0]), Vector([0.1, 0.0, 0.0])];
    let shell = Shell::capsule(ends, 0.01, 2).unwrap();
    let options = ToolOptions { angular_stiffness: Some(5.0), ..springs() };
    let mut tool = Tool::new(shell, options).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.05, 0.0]));
    let touch = rest(&mut tool, &mut bodies, &at([0.0, 0.008, 0.0]));
    // In balance: F = K y and τ = κ θ = F · 0.1 cos θ with y + 0.1 sin θ = 0.002.
    let lift = touch.pose.translation[1] - 0.008;
    let angle = touch.torque[2] / 5.0;
    assert!((touch.force - Vector([0.0, STIFFNESS * lift, 0.0])).norm() < 1e-12);
    assert!((touch.torque[2] - touch.force[1] * 0.1 * angle.cos()).abs() < 1e-9);
    assert!((lift + 0.1 * angle.sin() - 0.002).abs() < 1e-11, "{lift} {angle}");
    assert!(touch.torque[2] > 0.0);
}

#[test]
fn a_box_laid_flat_is_not_turned() {
    let mut bodies = Bodies::from(half_space([0.0, 1.0, 0.0], 0.0));
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 600, 0.0).unwrap();
    let mut tool = Tool::new(shell, springs()).unwrap();
    tool.step(&mut bodies, &at([0.01, 0.03, 0.0]));
    let touch = tool.step(&mut bodies, &at([0.01, 0.017, 0.0])).clone();
    assert!((touch.force - Vector([0.0, 0.003 * STIFFNESS, 0.0])).norm() < 1e-9, "{touch:?}");
    assert!(touch.torque.norm() < 1e-11, "{:?}", touch.torque);
    assert!((touch.pose.translation - Vector([0.01, 0.02, 0.0])).norm() < 1e-12);
    let reaction = bodies.reactions()[0];
    assert!((reaction.force + touch.force).norm() < 1e-12);
    let about_origin = touch.force[1] * 0.01;
    assert!((reaction.torque - Vector([0.0, 0.0, -about_origin])).norm() < 1e-9);
}

#[test]
fn a_box_on_its_edge_turns_onto_its_face() {
    let ground = half_space([0.0, 1.0, 0.0], 0.0);
    let mut bodies = Bodies::from(ground.clone());
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 600, 0.0).unwrap();
    let mut tool = Tool::new(shell.clone(), springs()).unwrap();
    let tilted = |height| turned([0.0, 0.0, 1.0], 0.1, [0.0, height, 0.0]);
    tool.step(&mut bodies, &tilted(0.05));
    let touch = rest(&mut tool, &mut bodies, &tilted(0.0225));
    // The corner at −x is the lowest: it lifts, which turns it back about −z.
    assert!(touch.contact && touch.torque[2] < -1e-4, "{:?}", touch.torque);
    let deep = rest(&mut tool, &mut bodies, &tilted(0.005));
    let angle = Rotation::<3>::quaternion(&deep.pose.rotation)[2];
    assert!(angle.abs() < 1e-9, "{angle}");
    assert!((deep.pose.translation[1] - 0.02).abs() < 1e-9);
    assert!(deep.torque[2] < touch.torque[2]);
    assert!(least_gap(&shell, &deep.pose, &ground) >= -1e-10);
}

#[test]
fn a_peg_stays_in_the_middle_of_its_hole() {
    let block = cuboid([0.1, 0.06, 0.1]);
    let hole = cuboid([0.022, 0.1, 0.022]);
    let plate = block.difference([hole]).unwrap();
    let mut bodies = Bodies::from(plate.clone());
    let shell = Shell::from_mesh(&box_mesh([0.02, 0.08, 0.02]), 800, 0.0005).unwrap();
    let mut tool = Tool::new(shell.clone(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    for tick in 0..=1000 {
        let t = f64::from(tick) / 1000.0;
        // The hand trembles and tilts by more than there is room for.
        let trembling = if t < 0.5 { 0.0 } else { 1.0 };
        let [x, z] = [0.002 * (40.0 * t).sin(), 0.0015 * (33.0 * t).cos()];
        let place = [trembling * x, 0.1 - 0.1 * t, trembling * z];
        let angle = 0.05 * trembling * (25.0 * t).sin();
        let state = turned([0.3, 0.0, 1.0], angle, place);
        let touch = tool.step(&mut bodies, &state);
        assert!(!touch.is_degraded && !touch.is_covered);
        let pose = touch.pose;
        let gap = least_gap(&shell, &pose, &plate);
        assert!(gap >= -1e-9 * 0.1, "{tick}: {gap}");
        if t > 0.75 {
            let [x, _, z] = pose.translation.0;
            assert!(x.abs() < 0.0007 && z.abs() < 0.0007, "{tick}: {x} {z}");
        }
    }
    let touch = rest(&mut tool, &mut bodies, &at([0.0; 3]));
    assert!(!touch.contact && touch.pose == Pose::identity());
}

#[test]
fn a_strike_does_not_pass_a_thin_plate() {
    for (thickness, spin) in [(1e-4, 0.0), (1e-4, 0.4), (1e-3, -0.9)] {
        let plate = cuboid([0.3, thickness, 0.3]);
        for radius in [0.0, 0.0003] {
            let mut bodies = Bodies::from(plate.clone());
            let mesh = box_mesh([0.03, 0.02, 0.04]);
            let shell = Shell::from_mesh(&mesh, 300, radius).unwrap();
            let mut tool = Tool::new(shell.clone(), springs()).unwrap();
            for tick in 0..12 {
                // 10 m/s, and up to 900 rad/s.
                let t = f64::from(tick);
                let place = [0.001 * t, 0.0543 - 0.01 * t, 0.0];
                let state = turned([0.2, 1.0, 0.4], spin * t, place);
                let touch = tool.step(&mut bodies, &state);
                let gap = least_gap(&shell, &touch.pose, &plate);
                assert!(touch.pose.translation[1] > 0.0, "{thickness} {spin} {radius} {tick}");
                assert!(gap >= -1e-9, "{gap}");
            }
            let touch =
                rest(&mut tool, &mut bodies, &turned([1.0, 0.0, 0.0], 0.0, [0.0, -0.05, 0.0]));
            assert!((touch.pose.translation[1] - 0.01 - radius - 0.5 * thickness).abs() < 1e-8);
            assert!(
                (touch.force[1] - STIFFNESS * (0.06 + radius + 0.5 * thickness)).abs() < 2e-3
            );
        }
    }
}

/// A tool that is pressed into a scene `size` times as large, and moved and turned over it.
fn path(size: f64) -> Vec<(Vector<f64, 3>, Vector<f64, 3>, bool)> {
    let shape =
        Shape::union([ball(0.05 * size), cuboid([0.04 * size, 0.12 * size, 0.03 * size])])
            .unwrap();
    // The same force at the same depth, in parts of the scene.
    let surface = Surface::smooth(STIFFNESS / size, 0.0).unwrap();
    let mut bodies = body(&shape, surface);
    let edges = [0.03 * size, 0.02 * size, 0.04 * size];
    let shell = Shell::from_mesh(&box_mesh(edges), 300, 0.0005 * size).unwrap();
    let options = ToolOptions { stiffness: STIFFNESS / size, ..springs() };
    let options = ToolOptions { angular_stiffness: Some(0.1 * size), ..options };
    let mut tool = Tool::new(shell, options).unwrap();
    let mut felt = Vec::new();
    for tick in 0..400 {
        let t = f64::from(tick) / 400.0;
        let place = [0.06 - 0.1 * t, 0.075 - 0.02 * t, 0.02 * t].map(|x| x * size);
        let touch = tool.step(&mut bodies, &turned([0.3, 1.0, -0.2], 1.5 * t, place)).clone();
        felt.push((touch.force, touch.torque, touch.contact));
    }
    felt
}

#[test]
fn scenes_of_all_sizes_feel_alike() {
    let plain = path(1.0);
    assert!(plain.iter().filter(|felt| felt.2).count() > 200);
    for size in [0.01, 100.0] {
        for (tick, (felt, plain)) in path(size).iter().zip(&plain).enumerate() {
            assert!((felt.0 - plain.0).norm() < 1e-3, "{size} {tick}: {felt:?} {plain:?}");
        }
    }
}

#[test]
fn the_same_hand_feels_the_same_bits() {
    assert_eq!(path(1.0), path(1.0));
}

#[test]
fn out_of_budget_a_tool_gets_coarser_and_says_so() {
    let ground = half_space([0.0, 1.0, 0.0], 0.0);
    let mut bodies = Bodies::from(ground.clone());
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 1000, 0.001).unwrap();
    let options = ToolOptions { budget: 50, ..springs() };
    let mut tool = Tool::new(shell.clone(), options).unwrap();
    let mut degraded = 0;
    for tick in 0..300 {
        let t = f64::from(tick) / 300.0;
        let state = turned([0.3, 1.0, 0.8], 2.0 * t, [0.02 * t, 0.05 - 0.04 * t, 0.0]);
        let touch = tool.step(&mut bodies, &state);
        assert!(touch.evaluations <= 50 && !touch.is_covered);
        assert!(touch.is_degraded || touch.points_known == touch.points);
        assert!(!touch.is_degraded || touch.resolution > shell.resolution(1000));
        degraded += u32::from(touch.is_degraded);
        // What the report says is true.
        let gap = least_gap(&shell, &touch.pose, &ground);
        assert!(gap >= -touch.resolution - 0.001 - 1e-9, "{tick}: {gap} {touch:?}");
        let first = shell.points().iter().take(16).map(|point| {
            ground.distance(touch.pose.transform_point(point.centre)) - point.radius
        });
        assert!(first.fold(f64::INFINITY, f64::min) >= -1e-10, "{tick}");
    }
    assert!(degraded > 100, "{degraded}");
    assert!(tool.touch().contact);
}

#[test]
fn a_closed_path_gives_no_energy() {
    let shape = Shape::union([ball(0.05), cuboid([0.04, 0.12, 0.03])]).unwrap();
    let mut bodies = Bodies::from(shape);
    let shell = Shell::from_mesh(&box_mesh([0.03, 0.02, 0.04]), 300, 0.001).unwrap();
    let mut tool = Tool::new(shell, springs()).unwrap();
    let ticks = 20_000;
    let state = |tick: i32| on_a_loop(f64::from(tick) / f64::from(ticks));
    tool.step(&mut bodies, &at([0.0, 0.2, 0.0]));
    rest(&mut tool, &mut bodies, &state(0).1);
    let (mut work, mut last, mut most) = (0.0, state(0).0, 0.0_f64);
    let mut force = tool.touch().force;
    for tick in 1..=ticks {
        let (place, state) = state(tick);
        let now = tool.step(&mut bodies, &state).force;
        assert!(tool.touch().contact);
        work += ((force + now) * 0.5).dot(place - last);
        most = most.max(now.norm());
        (force, last) = (now, place);
    }
    assert!(most > 3.0, "{most}");
    // What the hand gets; that a tick stops short of its end costs it a little.
    assert!(work < 1e-9 && work > -1e-6, "{work}");
}

#[test]
fn a_rectangle_lies_on_a_line_in_the_plane() {
    let mut bodies = Bodies::from(half_space([0.0, 1.0], 0.0));
    let corners = [[-0.03, -0.02], [0.03, -0.02], [0.03, 0.02], [-0.03, 0.02]];
    let sides = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
    let outline = Outline::new(corners.map(Vector).to_vec(), sides).unwrap();
    let shell = Shell::from_mesh(&outline, 100, 0.0).unwrap();
    let mut tool = Tool::new(shell.clone(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    let touch = tool.step(&mut bodies, &at([0.0, 0.015, 0.0])).clone();
    assert!((touch.force - Vector([0.0, 0.005 * STIFFNESS, 0.0])).norm() < 1e-9);
    assert!(touch.torque.norm() < 1e-11);
    let tilted = Pose::new(Rotation::from_angle(0.3).unwrap().in_space(), [0.0, 0.025, 0.0]);
    let touch = rest(&mut tool, &mut bodies, &ToolState::at_rest(tilted));
    assert!(touch.torque[2] < 0.0 && touch.torque[0] == 0.0 && touch.torque[1] == 0.0);
    assert!(least_gap(&shell, &touch.pose, half_space([0.0, 1.0], 0.0)) >= -1e-9);
}

#[test]
fn fields_and_capsules_are_tools_too() {
    let mut bodies = Bodies::from(ball::<3>(0.05));
    let cone = cuboid([0.02, 0.02, 0.02]).offset(0.002).unwrap();
    let mut tool = Tool::new(Shell::from_field(&cone, 400, 0.0).unwrap(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    let touch = rest(&mut tool, &mut bodies, &at([0.0, 0.055, 0.0]));
    assert!(touch.contact && touch.force[1] > 1.0);
    let ends = [Vector([-0.03, 0.0, 0.0]), Vector([0.03, 0.0, 0.0])];
    let mut tool = Tool::new(Shell::capsule(ends, 0.005, 61).unwrap(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    let touch = rest(&mut tool, &mut bodies, &at([0.0, 0.053, 0.0]));
    assert!((touch.force[1] - 0.002 * STIFFNESS).abs() < 1e-9, "{:?}", touch.force);
}

#[test]
fn touching_and_leaving_is_told() {
    let surface = Surface::smooth(STIFFNESS, 0.0).unwrap();
    let mut bodies = body(half_space([0.0, 1.0, 0.0], 0.0), surface);
    let mut tool = Tool::new(Shell::ball(0.01).unwrap(), springs()).unwrap();
    let mut told = Vec::new();
    for height in [0.03, 0.009, 0.008, 0.02] {
        let down: Point<3> = Vector([0.0, -0.5, 0.0]);
        let state = ToolState { velocity: down, ..at([0.0, height, 0.0]) };
        tool.step(&mut bodies, &state);
        told.extend(tool.events().iter().map(|event| (event.tick, event.kind)));
    }
    assert_eq!(told, [(1, EventKind::Touch { speed: 0.5 }), (3, EventKind::Leave)]);
}

#[test]
fn a_device_that_is_nowhere_touches_nothing() {
    let mut bodies = Bodies::from(ball::<3>(0.05));
    let mut tool = Tool::new(Shell::ball(0.01).unwrap(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.2, 0.0]));
    assert!(tool.step(&mut bodies, &at([0.0, 0.05, 0.0])).contact);
    let touch = tool.step(&mut bodies, &at([f64::NAN, 0.05, 0.0]));
    assert_eq!((touch.contact, touch.force), (false, Vector::ZERO));
    assert!(tool.step(&mut bodies, &at([0.0, 0.05, 0.0])).contact);
}

#[test]
fn a_box_sticks_within_its_cone_and_never_creeps() {
    let (mut bodies, mut tool) = rough(&half_space([0.0, 1.0, 0.0], 0.0));
    tool.step(&mut bodies, &at([0.0, 0.03, 0.0]));
    let pressed = tool.step(&mut bodies, &at([0.0, 0.016, 0.0])).clone();
    for tick in 0..1000 {
        // Less than half of the depth to the side, and a little round.
        let t = 0.01 * f64::from(tick);
        let place = [0.0015 * t.sin(), 0.016, 0.0005 * (1.7 * t).cos()];
        let state = turned([0.0, 1.0, 0.0], 0.001 * (0.6 * t).sin(), place);
        let touch = tool.step(&mut bodies, &state);
        assert!(touch.contact && !touch.is_slipping, "{tick}");
        assert_eq!(touch.pose, pressed.pose);
        assert!((touch.force[0] + STIFFNESS * place[0]).abs() < 1e-9);
    }
}

#[test]
fn a_box_that_slips_is_held_back_by_coulomb() {
    let (mut bodies, mut tool) = rough(&half_space([0.0, 1.0, 0.0], 0.0));
    tool.step(&mut bodies, &at([0.0, 0.03, 0.0]));
    tool.step(&mut bodies, &at([0.0, 0.016, 0.0]));
    for tick in 1..500 {
        let x = 1e-4 * f64::from(tick);
        let touch = tool.step(&mut bodies, &at([x, 0.016, 0.0]));
        let [along, up, across] = touch.force.0;
        assert!((up - 0.004 * STIFFNESS).abs() < 1e-9, "{tick} {up}");
        // It sticks to μ = 0.5, then slips with 0.25.
        let expected = if touch.is_slipping { 0.25 * up } else { STIFFNESS * x };
        assert!((along + expected).abs() < 2e-2 * up, "{tick}: {along} {expected}");
        assert!(across.abs() < 2e-2 * up, "{tick}: {across}");
        assert_eq!(touch.is_slipping, tick >= 20, "{tick}");
    }
}

/// Once, a clone had room for nothing: it looked at few points, and went through the ground.
#[test]
fn a_clone_feels_what_the_tool_feels() {
    let ground = half_space([0.0, 1.0, 0.0], 0.0);
    let (mut bodies, mut others) = (Bodies::from(ground.clone()), Bodies::from(ground.clone()));
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 600, 0.0005).unwrap();
    let mut tool = Tool::new(shell.clone(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    let mut clone = tool.clone();
    for tick in 0..200 {
        let t = f64::from(tick) / 200.0;
        let state = turned([0.3, 1.0, 0.8], t, [0.02 * t, 0.1 - 0.09 * t, 0.0]);
        let touch = tool.step(&mut bodies, &state);
        let other = clone.step(&mut others, &state);
        assert!(least_gap(&shell, &other.pose, &ground) > -1e-9, "{tick}");
        assert_eq!(
            (touch.pose, touch.force, touch.torque),
            (other.pose, other.force, other.torque)
        );
        assert_eq!(touch.contacts.len(), other.contacts.len());
    }
    assert!(clone.touch().contact);
}

#[test]
fn a_tool_that_slides_asks_only_the_points_that_could_touch() {
    let hill = ball::<3>(0.5);
    let mut bodies = Bodies::from(hill.clone());
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 1000, 0.0005).unwrap();
    let mut tool = Tool::new(shell.clone(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.54, 0.0]));
    let mut most = 0;
    for tick in 0..500 {
        let t = f64::from(tick) * 1e-3;
        // It lands on an edge, and slides at 0.1 m/s.
        let height = 0.54 - 0.02 * (10.0 * t).min(1.0);
        let touch =
            tool.step(&mut bodies, &turned([0.0, 0.0, 1.0], 0.3, [0.1 * t, height, 0.0]));
        assert_eq!(touch.points_known, touch.points);
        assert!(tick < 200 || touch.contact);
        most = most.max(if tick < 200 { 0 } else { touch.evaluations });
        let gap = least_gap(&shell, &touch.pose, &hill);
        assert!(gap >= -1e-9, "{tick}: {gap}");
    }
    // A tick has six turns at most; the edge has some ten points.
    assert!(most <= 60, "{most}");
}
