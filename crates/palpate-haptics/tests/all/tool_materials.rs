// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a tool with a shape feels of materials and of bodies that move, and what it tells.

use crate::common::tools::{STIFFNESS, at, box_mesh, on_a_loop, rest, rough, smooth, springs};
use crate::common::{ball, body, cuboid, half_space};
use palpate_field::{Pose, Rotation, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, Layer, Material, Shell, Surface, Tool, ToolOptions, ToolState,
    ToolTouch,
};

#[test]
fn a_box_tells_where_it_slips_and_where_it_sticks_again() {
    let (mut bodies, mut tool) = rough(&half_space([0.0, 1.0, 0.0], 0.0));
    let mut told = Vec::new();
    let mut go = |tool: &mut Tool, x: f64, y: f64| {
        tool.step(&mut bodies, &at([x, y, 0.0]));
        told.extend(tool.events().iter().map(|event| (event.tick, event.body, event.kind)));
    };
    go(&mut tool, 0.0, 0.03);
    go(&mut tool, 0.0, 0.016);
    // Beyond μ = 0.5 of 4 mm; then back to where it rests.
    for _ in 0..20 {
        go(&mut tool, 0.003, 0.016);
    }
    let x = tool.touch().pose.translation[0];
    go(&mut tool, x, 0.016);
    go(&mut tool, x, 0.03);
    let expected = [
        (1, 0, EventKind::Touch { speed: 0.0 }),
        (2, 0, EventKind::Slip),
        (3, 0, EventKind::Stick),
        (23, 0, EventKind::Leave),
    ];
    assert_eq!(told, expected);
}

/// A tool on ground of a material, after it was pressed to `depth` there.
fn pressed(material: &Material, depth: f64, velocity: [f64; 3]) -> ToolTouch {
    let surface = Surface::new(material).unwrap();
    let mut bodies = body(half_space([0.0, 1.0, 0.0], 0.0), surface);
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 600, 0.0).unwrap();
    let mut tool = Tool::new(shell, springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.03, 0.0]));
    let velocity = Vector(velocity);
    let state = ToolState { velocity, ..at([0.0, 0.02 - depth, 0.0]) };
    let touch = tool.step(&mut bodies, &state).clone();
    // What the hand gets, the body gives.
    assert!((bodies.reactions()[0].force + touch.force).norm() < 1e-12);
    touch
}

#[test]
fn the_layers_of_a_body_are_felt_as_far_as_the_coupling_bears_them() {
    let layer =
        |depth, stiffness| Layer { depth, stiffness: Some(stiffness), ..Layer::default() };
    let up = |material: &Material, depth| {
        let force = pressed(material, depth, [0.0; 3]).force;
        assert!(Vector([force[0], 0.0, force[2]]).norm() < 1e-12);
        force[1]
    };
    let soft = Material { stiffness: 100.0, ..smooth() };
    assert!((up(&soft, 0.003) - 0.3).abs() < 1e-9);
    let hard = Material { stiffness: 5000.0, ..smooth() };
    assert!((up(&hard, 0.003) - 0.003 * STIFFNESS).abs() < 1e-9);
    // 100 N/m for 1 mm, 2000 N/m, of which the coupling lets 500 through, for 2 mm, then none.
    let layers = vec![layer(0.001, 2000.0), layer(0.003, 0.0)];
    let layered = Material { layers, ..soft };
    for (depth, force) in [(0.0005, 0.05), (0.001, 0.1), (0.002, 0.6), (0.004, 1.1)] {
        assert!((up(&layered, depth) - force).abs() < 1e-9, "{depth}");
    }
}

#[test]
fn a_closed_path_over_a_soft_layered_body_gives_no_energy() {
    let layer = Layer { depth: 0.003, stiffness: Some(400.0), ..Layer::default() };
    let material = Material { stiffness: 150.0, layers: vec![layer], ..smooth() };
    let mut bodies = body(ball::<3>(0.05), Surface::new(&material).unwrap());
    let shell = Shell::from_mesh(&box_mesh([0.03, 0.02, 0.04]), 300, 0.001).unwrap();
    let mut tool = Tool::new(shell, springs()).unwrap();
    let ticks = 20_000;
    let state = |tick: i32| on_a_loop(f64::from(tick) / f64::from(ticks));
    tool.step(&mut bodies, &at([0.0, 0.2, 0.0]));
    rest(&mut tool, &mut bodies, &state(0).1);
    let (mut work, mut last, mut force) = (0.0, state(0).0, tool.touch().force);
    for tick in 1..=ticks {
        let (place, state) = state(tick);
        let now = tool.step(&mut bodies, &state).force;
        assert!(tool.touch().contact);
        work += ((force + now) * 0.5).dot(place - last);
        (force, last) = (now, place);
    }
    assert!(work < 1e-9 && work > -1e-6, "{work}");
}

#[test]
fn damping_takes_from_the_approach_and_viscosity_from_every_motion() {
    let damped = Material { damping: 3.0, ..smooth() };
    let spring = 0.004 * STIFFNESS;
    let felt = |material: &Material, velocity| pressed(material, 0.004, velocity).force;
    let force = felt(&damped, [0.2, -0.1, 0.0]);
    assert!((force - Vector([0.0, spring + 0.3, 0.0])).norm() < 1e-9, "{force:?}");
    let force = felt(&damped, [0.2, 0.1, 0.0]);
    assert!((force - Vector([0.0, spring, 0.0])).norm() < 1e-9, "{force:?}");
    let viscous = Material { viscosity: 2.0, ..smooth() };
    let force = felt(&viscous, [0.2, 0.1, 0.0]);
    assert!((force - Vector([-0.4, spring - 0.2, 0.0])).norm() < 1e-9, "{force:?}");
}

#[test]
fn what_is_dragged_below_the_hand_turns_it() {
    // A ball 0.1 m below the origin is dragged through what it touches.
    let ends = [Vector([0.0, -0.1, 0.0]); 2];
    let shell = Shell::capsule(ends, 0.01, 2).unwrap();
    let options = ToolOptions { angular_stiffness: Some(50.0), ..springs() };
    let mut tool = Tool::new(shell, options).unwrap();
    let viscous = Material { viscosity: 2.0, ..smooth() };
    let mut bodies = body(half_space([0.0, 1.0, 0.0], 0.0), Surface::new(&viscous).unwrap());
    tool.step(&mut bodies, &at([0.0, 0.2, 0.0]));
    rest(&mut tool, &mut bodies, &at([0.0, 0.106, 0.0]));
    let along = Vector([0.1, 0.0, 0.0]);
    let touch = tool.step(&mut bodies, &ToolState { velocity: along, ..at([0.0, 0.106, 0.0]) });
    // 2 N·s/m at 0.1 m/s; the arm points down: (0, −0.1, 0) × (−0.2, 0, 0).
    assert!((touch.force[0] + 0.2).abs() < 1e-9, "{:?}", touch.force);
    assert!((touch.torque[2] + 0.02).abs() < 1e-9, "{:?}", touch.torque);
}

#[test]
fn a_body_that_moves_takes_along_the_tool_that_sticks_to_it() {
    let (mut bodies, mut tool) = rough(&cuboid([1.0, 0.1, 1.0]));
    let place = |x: f64, y: f64, turn: f64| {
        let rotation = Rotation::from_axis_angle(Vector([0.0, 1.0, 0.0]), turn).unwrap();
        Pose::new(rotation, Vector([x, y, 0.0]))
    };
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    tool.step(&mut bodies, &at([0.0, 0.066, 0.0]));
    for tick in 1..=100 {
        // To the side, up and round, all of it within the cone.
        let t = f64::from(tick);
        let carrier = place(1e-5 * t, 2e-6 * t, 2e-5 * t);
        bodies.set_pose(0, carrier);
        let touch = tool.step(&mut bodies, &at([0.0, 0.066, 0.0]));
        assert!(touch.contact && !touch.is_slipping, "{tick}");
        let expected = carrier * Pose::translation(Vector([0.0, 0.07, 0.0]));
        let probe = Vector([0.03, -0.02, 0.025]);
        let error = touch.pose.transform_point(probe) - expected.transform_point(probe);
        assert!(error.norm() < 1e-9, "{tick}: {error:?}");
    }
    // 1 mm to the side, and 0.2 mm up.
    let force = tool.touch().force;
    assert!((force - Vector([0.001, 0.0042, 0.0]) * STIFFNESS).norm() < 1e-6, "{force:?}");
}

#[test]
fn a_tool_is_not_carried_through_a_wall() {
    // A belt under the tool, and a thin wall that stands beside it.
    let material = Material { static_friction: 0.9, dynamic_friction: 0.9, ..smooth() };
    let surface = Surface::new(&material).unwrap();
    let belt = Body::new(cuboid([4.0, 0.1, 1.0]), surface.clone()).unwrap();
    let wall = Body::new(cuboid([0.001, 0.5, 1.0]), surface).unwrap();
    let wall = wall.at(Pose::translation(Vector([0.035, 0.301, 0.0]))).unwrap();
    let mut bodies = Bodies::new(vec![belt, wall]).unwrap();
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 600, 0.0).unwrap();
    let mut tool = Tool::new(shell, springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.1, 0.0]));
    tool.step(&mut bodies, &at([0.0, 0.05, 0.0]));
    for tick in 1..=50 {
        bodies.set_pose(0, Pose::translation(Vector([0.01 * f64::from(tick), 0.0, 0.0])));
        let touch = tool.step(&mut bodies, &at([0.0, 0.05, 0.0]));
        let front = touch.pose.translation[0] + 0.03;
        assert!(front < 0.0345 + 1e-9, "{tick}: {front}");
    }
    assert!(tool.touch().pose.translation[0] > 0.0043, "{:?}", tool.touch());
}

/// What is known of points far from a body answers for a while; it was not forgotten when the
/// body moved in a tick in which the device was nowhere, and the tool went through it.
#[test]
fn a_body_that_moves_while_the_device_is_nowhere_is_touched_after() {
    let mut bodies = Bodies::from(cuboid([0.4, 0.02, 0.4]));
    let mut tool = Tool::new(Shell::ball(0.01).unwrap(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 1.0, 0.0]));
    bodies.set_pose(0, Pose::translation(Vector([0.0, 0.95, 0.0])));
    tool.step(&mut bodies, &at([f64::NAN, 1.0, 0.0]));
    let touch = tool.step(&mut bodies, &at([0.0, 0.9, 0.0]));
    assert!(touch.contact && touch.pose.translation[1] > 0.96, "{touch:?}");
}

/// A tool that lost its device in contact touched again later without ever having left.
#[test]
fn a_device_that_gets_lost_leaves() {
    let mut bodies = Bodies::from(ball::<3>(0.05));
    let mut tool = Tool::new(Shell::ball(0.01).unwrap(), springs()).unwrap();
    let mut told = Vec::new();
    for height in [0.2, 0.05, f64::NAN, 0.05] {
        tool.step(&mut bodies, &at([0.0, height, 0.0]));
        told.extend(tool.events().iter().map(|event| (event.tick, event.kind)));
    }
    let touch = EventKind::Touch { speed: 0.0 };
    assert_eq!(told, [(1, touch), (2, EventKind::Leave), (3, touch)]);
}

#[test]
fn the_friction_is_that_of_the_layer_at_the_depth_of_the_hand() {
    let layer = Layer {
        depth: 0.002,
        static_friction: Some(0.9),
        dynamic_friction: Some(0.8),
        ..Layer::default()
    };
    let slick = Material { static_friction: 0.1, dynamic_friction: 0.1, ..smooth() };
    let layered = Material { layers: vec![layer], ..slick };
    let mut bodies = body(half_space([0.0, 1.0, 0.0], 0.0), Surface::new(&layered).unwrap());
    for (depth, is_slipping) in [(0.0015, true), (0.004, false)] {
        let mut tool = Tool::new(Shell::ball(0.01).unwrap(), springs()).unwrap();
        tool.step(&mut bodies, &at([0.0, 0.02, 0.0]));
        tool.step(&mut bodies, &at([0.0, 0.01 - depth, 0.0]));
        // Half the depth to the side: beyond the outer cone, within the inner.
        let touch = tool.step(&mut bodies, &at([0.5 * depth, 0.01 - depth, 0.0]));
        assert_eq!((touch.contact, touch.is_slipping), (true, is_slipping), "{depth}");
    }
}

/// Once it lost the body in every other tick: the tangent plane alone held it, and counted as none of
/// its contacts.
#[test]
fn a_tool_that_sticks_under_a_hand_straight_above_keeps_its_contact() {
    let material = Material { static_friction: 0.4, dynamic_friction: 0.3, ..smooth() };
    let mut bodies = body(half_space([0.0, 1.0, 0.0], 0.0), Surface::new(&material).unwrap());
    let mut tool = Tool::new(Shell::ball(0.01).unwrap(), springs()).unwrap();
    tool.step(&mut bodies, &at([0.0, 0.02, 0.0]));
    for tick in 0..10 {
        let touch = tool.step(&mut bodies, &at([0.0, 0.008, 0.0]));
        assert!(touch.contact && touch.force[1] > 0.0, "{tick}: {touch:?}");
    }
}
