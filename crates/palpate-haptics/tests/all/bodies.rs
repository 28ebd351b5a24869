// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move, and many of them.

use crate::common::{ball, body, cases, cuboid, half_space, unit, vector};
use palpate_device::{DeviceProfile, PointState};
use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, Material, Probe, Protection, Servo, ServoOptions, Surface, Touch,
    Unprotected,
};

fn options(radius: f64) -> ServoOptions {
    ServoOptions {
        probe: Probe::new(radius).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    }
}

fn touch(servo: &mut Servo<Unprotected>, device: Vector<f64, 3>) -> Touch {
    servo.step(&[PointState::at_rest(device)])[0]
}

fn rough(stiffness: f64) -> Surface {
    let (static_friction, dynamic_friction) = (0.8, 0.6);
    let material = Material {
        stiffness,
        damping: 0.0,
        static_friction,
        dynamic_friction,
        ..Material::default()
    };
    Surface::new(&material).unwrap()
}

#[test]
fn a_body_that_moves_carries_the_hand_by_friction() {
    let mut servo = Servo::new(body(cuboid([1.0, 0.125, 1.0]), rough(512.0)), 1, options(0.0));
    let servo = servo.as_mut().unwrap();
    let device = Vector([0.0, 0.0625 - 0.0078125, 0.0]);
    touch(servo, Vector([0.0, 0.5, 0.0]));
    touch(servo, device);
    for tick in 1..=4 {
        let way = 0.001 * f64::from(tick);
        servo.set_pose(0, Pose::translation(Vector([way, 0.0, 0.0])));
        let held = touch(servo, device);
        assert!((held.proxy - Vector([way, 0.0625, 0.0])).norm() < 1e-9);
        // Dragged along by the spring, and the hand drags the body back.
        assert!((held.force[0] - 512.0 * way).abs() < 1e-6);
        assert!((servo.reactions()[0].force + held.force).norm() == 0.0);
        // 1 mm a tick.
        assert!((held.velocity - Vector([-1.0, 0.0, 0.0])).norm() < 1e-9);
    }
    // A body at rest again does not drag any further.
    let still = touch(servo, device);
    assert_eq!(still.velocity, Vector::ZERO);
}

#[test]
fn a_body_that_turns_takes_the_hand_round() {
    let mut servo = Servo::new(body(ball::<3>(0.05), rough(512.0)), 1, options(0.0)).unwrap();
    touch(&mut servo, Vector([0.1, 0.0, 0.0]));
    let mut held = touch(&mut servo, Vector([0.049, 0.0, 0.0]));
    for tick in 1..=100 {
        let angle = 0.01 * f64::from(tick);
        let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), angle).unwrap();
        servo.set_pose(0, Pose::rotation(turn));
        held = touch(&mut servo, turn.rotate(Vector([0.049, 0.0, 0.0])));
        let proxy = turn.rotate(Vector([0.05, 0.0, 0.0]));
        assert!((held.proxy - proxy).norm() < 1e-9, "{tick}");
    }
    assert!((held.force.norm() - 0.512).abs() < 1e-6);
}

#[test]
fn a_plate_that_strikes_the_hand_does_not_pass_it() {
    // Plates of 0.1 mm, thrown at a hand at rest at up to 20 m/s from every side.
    cases(300, |u| {
        let thickness = 1e-4;
        let plate = cuboid([0.2, thickness, 0.2]);
        let mut servo = Servo::new(body(&plate, rough(512.0)), 1, options(0.001)).unwrap();
        let quaternion = [unit(u)?, unit(u)?, unit(u)?, unit(u)?];
        let turn = Rotation::from_quaternion(quaternion);
        let turn = turn.map_err(|_| arbitrary::Error::IncorrectFormat)?;
        let hand: Vector<f64, 3> = vector(u)? * 0.05;
        let out = turn.rotate(Vector([0.0, 1.0, 0.0]));
        let speed = 0.02 * (unit(u)?.abs() + 0.01);
        let at = |way: f64| Pose::new(turn, hand + out * way);
        let mut way = 0.05;
        servo.set_pose(0, at(way));
        touch(&mut servo, hand);
        while way > -0.01 {
            way -= speed;
            servo.set_pose(0, at(way));
            let held = touch(&mut servo, hand);
            // The proxy stays below the plate, which came from above.
            let side = out.dot(held.proxy - hand) - way;
            assert!(side <= -(0.5 * thickness + 0.001) + 1e-9, "{side:e} at {way:e}");
        }
        let force = touch(&mut servo, hand).force;
        assert!(out.dot(force) < 0.0);
        Ok(())
    });
}

#[test]
fn a_body_that_moves_onto_the_hand_presses_gently() {
    let mut servo = Servo::new(body(cuboid([0.1; 3]), rough(512.0)), 1, options(0.0)).unwrap();
    let hand = Vector([0.0, 0.0625, 0.0]);
    assert!(!touch(&mut servo, hand).contact);
    servo.set_pose(0, Pose::translation(Vector([0.0, 0.02, 0.0])));
    let first = touch(&mut servo, hand);
    assert!(first.contact && first.force == Vector::ZERO);
    for _ in 0..100 {
        touch(&mut servo, hand);
    }
    assert!((touch(&mut servo, hand).force[1] - 512.0 * 0.0075).abs() < 1e-6);
}

#[test]
fn many_bodies_feel_like_their_union() {
    cases(20, |u| {
        let mut bodies = Vec::new();
        let mut shapes = Vec::new();
        for i in 0..60 {
            let shape = if i % 2 == 0 { ball(0.02) } else { cuboid([0.03, 0.02, 0.05]) };
            let place: Vector<f64, 3> = vector(u)? * 0.2;
            shapes.push(shape.clone().translated(place).unwrap());
            let body = Body::new(shape, rough(512.0)).unwrap();
            bodies.push(body.at(Pose::translation(place)).unwrap());
        }
        let union = body(Shape::union(shapes).unwrap(), rough(512.0));
        let mut many = Servo::new(Bodies::new(bodies).unwrap(), 2, options(0.002)).unwrap();
        let mut one = Servo::new(union, 2, options(0.002)).unwrap();
        let from: Vector<f64, 3> = vector(u)?;
        let way: Vector<f64, 3> = vector(u)?;
        // A proxy that slips off an edge jumps. In which of two ticks, rounding decides.
        let mut parted = [false; 2];
        for tick in 0..1000 {
            let part = 1e-3 * f64::from(tick);
            let at = |phase: f64| {
                let height = 0.3 - 0.3 * (3.0 * (part + phase)).sin();
                PointState::at_rest(from * height + way * (0.2 * part))
            };
            let states = [at(0.0), at(0.3)];
            let forces = many.step(&states).iter().map(|t| t.force).collect::<Vec<_>>();
            let others = one.step(&states).iter().map(|t| t.force).collect::<Vec<_>>();
            for ((force, other), parted) in forces.iter().zip(&others).zip(&mut parted) {
                let differ = (*force - *other).norm() > 1e-3 * (1.0 + other.norm());
                assert!(!(differ && *parted), "{tick}: {force:?} {other:?}");
                *parted = differ;
            }
        }
        Ok(())
    });
}

#[test]
fn a_body_far_away_is_not_in_the_way() {
    // Broad phase: nothing is near at first, and the hand is fast.
    let place = |i: i32| Pose::translation(Vector([0.1 * f64::from(i), 0.0, 0.0]));
    let bodies = (1..=20).map(|i| Body::new(ball::<3>(0.04), rough(512.0))?.at(place(i)));
    let bodies = Bodies::new(bodies.collect::<Result<_, _>>().unwrap()).unwrap();
    // A clone once had no room for the numbers of what is near, and felt nothing.
    let mut servo = Servo::new(bodies.clone(), 1, options(0.001)).unwrap().clone();
    touch(&mut servo, Vector([-5.0, 0.0, 0.0]));
    // 7 m in a tick, through all twenty: the first one stops the proxy.
    let held = touch(&mut servo, Vector([2.5, 0.0, 0.0]));
    assert!(held.proxy[0] <= 0.06 - 0.001 + 1e-9, "{:?}", held.proxy);
    let held = touch(&mut servo, Vector([0.061, 0.0, 0.0]));
    assert!(held.contact && (held.proxy[0] - 0.059).abs() < 1e-6, "{:?}", held.proxy);
}

#[test]
fn a_membrane_pops_and_holds_again() {
    let pop_through =
        Some(palpate_haptics::PopThrough { description: None, force: 2.0, distance: 0.003 });
    let material =
        Material { stiffness: 1000.0, damping: 0.0, pop_through, ..Material::default() };
    let surface = Surface::new(&material).unwrap();
    let membrane = cuboid([0.2, 0.002, 0.2]);
    let mut servo = Servo::new(body(&membrane, surface), 1, options(0.001)).unwrap();
    let at = |y: f64| Vector([0.0, y, 0.0]);
    touch(&mut servo, at(0.01));
    // The proxy rests at 2 mm; 1.9 mm deeper is 1.9 N.
    assert!((touch(&mut servo, at(1e-4)).force[1] - 1.9).abs() < 1e-6);
    let last = touch(&mut servo, at(-1e-4));
    assert!((last.force[1] - 2.1).abs() < 1e-6);
    let events = servo.events().to_vec();
    assert!(matches!(events[0].kind, EventKind::Pop { force } if (force - 2.1).abs() < 1e-6));
    // Through: free, inside and below, until 3 mm away.
    for y in [-2e-4, -0.001, -0.003, -0.0049] {
        let free = touch(&mut servo, at(y));
        assert_eq!((free.force, free.contact), (Vector::ZERO, false), "{y}");
    }
    // 1 mm of half thickness, 1 mm of probe and 3 mm.
    touch(&mut servo, at(-0.0051));
    touch(&mut servo, at(-0.004));
    let back = touch(&mut servo, at(-0.001));
    assert!(back.contact && (back.proxy[1] + 0.002).abs() < 1e-9);
    assert!((back.force[1] + 1.0).abs() < 1e-6);
}

#[test]
fn a_magnet_pulls_from_outside_alone() {
    let magnet =
        Some(palpate_haptics::Magnet { description: None, force: 1.0, distance: 0.008 });
    let material = Material { stiffness: 1000.0, damping: 0.0, magnet, ..Material::default() };
    let surface = Surface::new(&material).unwrap();
    let floor = half_space([0.0, 1.0, 0.0], 0.0);
    let mut servo = Servo::new(body(&floor, surface), 1, options(0.0)).unwrap();
    let mut pull = |y: f64| touch(&mut servo, Vector([0.0, y, 0.0])).force[1];
    let pulls = [0.01, 0.008, 0.005, 0.002, 0.001].map(&mut pull);
    for (pull, expected) in pulls.iter().zip([0.0, 0.0, -0.5, -1.0, -0.5]) {
        assert!((pull - expected).abs() < 1e-12, "{pulls:?}");
    }
    assert!((pull(-0.001) - 1.0).abs() < 1e-6);
}

#[test]
fn touches_and_leaves_come_in_pairs() {
    // From one body to the next in one tick, and a reading that is lost, once left no leave.
    let place = |x: f64| Pose::translation(Vector([x, 0.0, 0.0]));
    let bodies =
        [0.0, 0.1].map(|x| Body::new(ball::<3>(0.05), rough(512.0)).unwrap().at(place(x)));
    let bodies = Bodies::new(bodies.into_iter().collect::<Result<_, _>>().unwrap()).unwrap();
    let mut servo = Servo::new(bodies, 1, options(0.001)).unwrap();
    let (mut touches, mut leaves) = (0, 0);
    for tick in 0..4000 {
        let x = 0.05 + 0.08 * (0.01 * f64::from(tick)).sin();
        let y = if tick % 700 == 650 { f64::NAN } else { 0.045 };
        touch(&mut servo, Vector([x, y, 0.0]));
        for event in servo.events() {
            touches += u32::from(matches!(event.kind, EventKind::Touch { .. }));
            leaves += u32::from(event.kind == EventKind::Leave);
            assert!(touches - leaves <= 1, "tick {tick}: {event:?}");
        }
    }
    touch(&mut servo, Vector([0.0, 0.5, 0.0]));
    leaves += servo.events().len() as u32;
    assert!(touches > 5 && touches == leaves, "{touches} touches, {leaves} leaves");
}

/// The safety chain took every body for one of the stiffest material, and stepped by 2.8 N a tick where
/// nothing was to be done: a hand that pressed foam gave back more than steel would have stored.
#[test]
fn a_stiff_body_elsewhere_changes_nothing() {
    let profile = DeviceProfile {
        least_damping: 2.5,
        mass: 0.25,
        max_stiffness: 5000.0,
        ..DeviceProfile::unlimited("example")
    };
    let forces = |stiffnesses: &[f64]| {
        let bodies = stiffnesses.iter().enumerate().map(|(number, stiffness)| {
            let at = Vector([number as f64, 0.0, 0.0]);
            let ball = Shape::ball(0.05).unwrap().translated(at).unwrap();
            Body::new(ball, Surface::smooth(*stiffness, 0.0).unwrap()).unwrap()
        });
        let bodies = Bodies::new(bodies.collect()).unwrap();
        let servo = Servo::new(bodies, 1, options(0.0)).unwrap();
        let mut servo = servo.protected(&Protection::new(profile.clone())).unwrap();
        let mut forces = Vec::new();
        for tick in 0..4000 {
            let time = 1e-3 * f64::from(tick);
            let height = 0.055 - 0.01 * (6.0 * std::f64::consts::PI * time).sin();
            servo.step(&[PointState::at_rest(Vector([0.0, height, 0.0]))]);
            forces.push(servo.touches()[0].force.0);
        }
        assert_eq!(servo.safety()[0].passivity.effect.ticks, 0, "{stiffnesses:?}");
        forces
    };
    let alone = forces(&[1000.0]);
    assert!(alone.iter().any(|force| force[1] > 4.0));
    for (force, expected) in forces(&[1000.0, 5000.0]).into_iter().zip(alone) {
        assert!((Vector(force) - Vector(expected)).norm() < 1e-4, "{force:?}, {expected:?}");
    }
}
