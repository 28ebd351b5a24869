// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo's step allocates nothing and stays in its budget.

use std::time::Duration;

use crate::common::wild::{bodies, servo, step};
use crate::common::{ball, cuboid, protected, torus};
use assert_no_alloc::assert_no_alloc;
use palpate_device::{Buttons, DeviceProfile, PointState, Reading};
use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, Guide, GuideOptions, HandoffOptions, Material, Progress,
    Protection, Servo, ServoOptions, Shell, Surface, Tool, ToolOptions, ToolState, handoff,
};
use palpate_sim::Tour;

#[test]
fn a_step_allocates_and_frees_nothing() {
    let cup = cuboid([0.08, 0.09, 0.08])
        .difference([cuboid([0.07, 0.09, 0.07]).translated(Vector([0.0, 0.01, 0.0])).unwrap()])
        .unwrap();
    let at = |shape: Shape<3>, x: f64| shape.translated(Vector([x, 0.0, 0.0])).unwrap();
    let bodies = [cup, at(ball(0.04), 0.1), at(torus(0.03, 0.012), -0.1)];
    let shape = Shape::union(bodies).unwrap();
    let bounds = shape.promise().bounds.unwrap().aabb;
    let path = Tour::new(bounds, 10.0).unwrap().over(&shape).unwrap();
    let mut servo = Servo::new(shape.clone(), 3, ServoOptions::default()).unwrap();
    let budget = servo.options().probe.budget();
    let mut next = Some(Bodies::from(shape));
    for tick in 0..10_000 {
        let time = f64::from(tick) * 1e-3;
        let states = [
            path.state_at(time),
            path.state_at(10.0 - time),
            PointState::at_rest(Vector([f64::NAN; 3])),
        ];
        let old = assert_no_alloc(|| {
            let touches = servo.step(&states);
            assert!(touches.iter().all(|t| t.evaluations <= budget && t.force.is_finite()));
            match next.take() {
                Some(shape) if tick % 1000 == 0 => Some(servo.replace_bodies(shape)),
                other => other,
            }
        });
        next = old;
    }
}

#[test]
fn a_tick_with_its_hand_off_allocates_and_frees_nothing() {
    let scene = |count: usize| {
        let body = |_| Body::new(ball::<3>(0.04), Surface::default());
        Bodies::new((0..count).map(body).collect::<Result<_, _>>().unwrap()).unwrap()
    };
    let mut servo = Servo::new(scene(1), 2, ServoOptions::default()).unwrap();
    let room = HandoffOptions { events: 10, bodies: 100, ..HandoffOptions::default() };
    let (mut control, mut end) = handoff(&servo, room);
    let switch = control.stop_switch();
    for tick in 0..2000_usize {
        // Scenes come and go, some unseen, some not collected for long; events find no room.
        if tick % 3 == 0 {
            control.replace_bodies(scene(1 + tick % 100)).unwrap();
        }
        if tick % 2 == 0 {
            let pose = Pose::translation(Vector([0.0, 1e-5 * tick as f64, 0.0]));
            control.set_poses(&[(0, pose)], Duration::ZERO).unwrap();
        }
        if tick % 5 == 0 {
            control.lift(tick % 10 == 0);
            let plane = Guide::to_point(Vector([0.0, 0.1, 0.0]), GuideOptions::default());
            control.replace_guides(&vec![plane.unwrap(); tick % 4]).unwrap();
        }
        let height = if tick % 10 < 5 { 0.06 } else { 0.035 };
        let states = [PointState::at_rest(Vector([0.0, height, 0.0])); 2];
        let mut progress = Progress::default();
        progress.ticks = tick as u64 + 1;
        let forces = assert_no_alloc(|| {
            if tick % 100 == 99 {
                switch.stop();
            }
            end.receive(&mut servo);
            servo.step(&states);
            end.publish(&servo, &progress);
            switch.release();
            servo.forces().len()
        });
        assert_eq!(forces, 2);
        let snapshot = control.latest().unwrap();
        assert_eq!(snapshot.progress.ticks, tick as u64 + 1);
        assert_eq!(snapshot.reactions, servo.reactions());
    }
    assert!(control.latest().unwrap().events_lost > 0);
    assert_no_alloc(|| end.finish());
    assert!(control.has_ended());
}

#[test]
fn a_step_of_a_tool_allocates_and_frees_nothing() {
    let rough = Surface::new(&Material::default()).unwrap();
    let bodies = (0..6).map(|i| {
        let place = Pose::translation(Vector([0.05 * f64::from(i), 0.0, 0.0]));
        Body::new(ball::<3>(0.04), rough.clone()).unwrap().at(place).unwrap()
    });
    let mut bodies = Bodies::new(bodies.collect()).unwrap();
    let shell = Shell::from_field(&torus(0.03, 0.01), 700, 0.0).unwrap();
    let options = ToolOptions { budget: 4000, ..ToolOptions::default() };
    let mut tool = Tool::new(shell, options).unwrap();
    let mut touched = 0;
    for tick in 0..3000 {
        let t = f64::from(tick) * 1e-3;
        let turn = Rotation::from_axis_angle(Vector([0.3, 1.0, 0.2]), 2.0 * t).unwrap();
        let height = if tick % 500 == 0 { f64::NAN } else { 0.05 + 0.03 * (5.0 * t).sin() };
        let state = ToolState::at_rest(Pose::new(turn, Vector([0.1 * t, height, 0.0])));
        let lift = Vector([0.1, 0.01 * (7.0 * t).sin(), 0.0]);
        assert_no_alloc(|| {
            bodies.set_pose(2, Pose::translation(lift));
            let touch = tool.step(&mut bodies, &state);
            assert!(touch.evaluations <= 4000 && touch.force.is_finite());
            touched += u32::from(touch.contact);
        });
    }
    assert!(touched > 1000, "{touched}");
}

/// A tool in a protected servo, on bodies that move and are swapped, with its hand-off.
#[test]
fn a_servo_with_a_tool_allocates_and_frees_nothing() {
    let scene = |count: usize| {
        let rough = Surface::new(&Material::default()).unwrap();
        let body = |i: usize| {
            let place = Pose::translation(Vector([0.05 * i as f64, 0.0, 0.0]));
            Body::new(ball::<3>(0.04), rough.clone()).and_then(|body| body.at(place))
        };
        Bodies::new((0..count).map(body).collect::<Result<_, _>>().unwrap()).unwrap()
    };
    let shell = Shell::from_field(&torus(0.03, 0.01), 500, 0.0).unwrap();
    let tool = Tool::new(shell, ToolOptions::default()).unwrap();
    let servo = Servo::with_tool(scene(6), tool, ServoOptions::default()).unwrap();
    let profile = DeviceProfile {
        least_damping: 0.3,
        encoder_step: 1e-5,
        max_force: 3.0,
        ..DeviceProfile::unlimited("example")
    };
    let mut servo = servo.protected(&Protection::new(profile)).unwrap();
    let room = HandoffOptions { events: 10, bodies: 10, ..HandoffOptions::default() };
    let (mut control, mut end) = handoff(&servo, room);
    let (mut contacts, mut events) = (0, 0);
    for tick in 0..2000_usize {
        let t = 1e-3 * tick as f64;
        if tick % 400 == 399 {
            control.replace_bodies(scene(4 + tick % 3)).unwrap();
        }
        let lift = Pose::translation(Vector([0.1, 0.01 * (7.0 * t).sin(), 0.0]));
        control.set_poses(&[(2, lift)], Duration::ZERO).unwrap();
        let height = if tick % 500 == 0 { f64::NAN } else { 0.05 + 0.03 * (5.0 * t).sin() };
        let states = [PointState::at_rest(Vector([0.1 * t, height, 0.0]))];
        assert_no_alloc(|| {
            end.receive(&mut servo);
            servo.step(&states);
            end.publish(&servo, &Progress::default());
        });
        assert!(servo.forces()[0].norm() <= 3.0 + 1e-9);
        contacts += usize::from(servo.touches()[0].contact);
        events += servo.events().len();
        let held = control.latest().unwrap().tool;
        assert_eq!(held, servo.tool().map(Tool::held));
    }
    assert!(contacts > 500 && events > 20, "{contacts} contacts, {events} events");
}

/// Twenty bodies that move, with textures, magnets, layers that give way and rings, guides on
/// each of 24 points, safety chains and estimated velocities, and scenes swapped in between.
#[test]
fn a_step_with_everything_at_once_allocates_and_frees_nothing() {
    const POINTS: usize = 24;
    let mut servo = protected(servo::<3>(20, POINTS, 1.0));
    let mut states = [PointState::at_rest(Vector::ZERO); POINTS];
    let mut next = servo.accept(bodies::<3>(20, 1.0)).unwrap();
    let (mut contacts, mut events, mut presses) = (0, 0, 0);
    for tick in 0..3000 {
        assert_no_alloc(|| {
            servo.set_late(if tick % 97 == 0 { 0.002 } else { 0.0 });
            servo.set_reading(match tick % 31 {
                7 => Reading::Stale,
                9 => Reading::NotReady,
                _ => Reading::Fresh { time: 1e-3 * f64::from(tick) },
            });
            servo.set_buttons(Buttons::from_bits(if tick % 5 == 0 { u32::MAX } else { 0 }));
            if tick % 500 == 250 {
                servo.stop(tick % 1000 == 250);
            }
            servo.rehearse(&states);
            step::<3>(&mut servo, &mut states, (tick, 1.0));
            if tick % 300 == 0 {
                assert_eq!(servo.replace_bodies(&mut next), Ok(()));
            }
        });
        contacts += servo.touches().iter().filter(|touch| touch.contact).count();
        for event in servo.events() {
            match event.kind {
                EventKind::ButtonDown { .. } => presses += 1,
                EventKind::ButtonUp { .. } => {}
                _ => events += 1,
            }
        }
    }
    assert!(contacts > 1000 && events > 50, "{contacts} contacts, {events} events");
    assert_eq!(presses, 600 * u32::from(Buttons::MOST));
}
