// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move far, fast, many at a time, or while nobody looks.

use crate::common::{ball, body, cuboid};
use palpate_device::PointState;
use palpate_field::{Point, Pose, Rotation, Shape, Vector};
use palpate_haptics::{Bodies, Body, Probe, Servo, ServoOptions, Surface, Touch, Unprotected};

const STIFFNESS: f64 = 512.0;

fn servo(shapes: Vec<(Shape<3>, Point<3>)>, radius: f64) -> Servo<Unprotected> {
    let surface = || Surface::smooth(STIFFNESS, 0.0).unwrap();
    let bodies = shapes
        .into_iter()
        .map(|(shape, place)| Body::new(shape, surface())?.at(Pose::translation(place)));
    let bodies = Bodies::new(bodies.collect::<Result<_, _>>().unwrap()).unwrap();
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, max_force: f64::INFINITY, ..ServoOptions::default() };
    Servo::new(bodies, 1, options).unwrap()
}

fn touch(servo: &mut Servo<Unprotected>, device: Point<3>) -> Touch {
    servo.step(&[PointState::at_rest(device)])[0]
}

fn at(x: f64, y: f64, z: f64) -> Pose<3> {
    Pose::translation(Vector([x, y, z]))
}

#[test]
fn a_body_that_is_far_away_hides_no_wall() {
    // Its rounding, 1e-6 m at 1e9 m, was once that of all bodies, and stayed when it came back.
    let plate = (cuboid([0.2, 0.1, 0.2]), Vector::ZERO);
    let other = (ball(0.05), Vector([0.3, 0.0, 0.0]));
    let mut servo = servo(vec![plate, other], 0.0);
    for place in [at(1e9, 0.0, 0.0), at(1e15, 0.0, 0.0), at(0.3, 0.0, 0.0)] {
        servo.set_pose(1, place);
        touch(&mut servo, Vector([0.0, 0.1, 0.0]));
        let held = touch(&mut servo, Vector([0.0, 0.05 - 1e-6, 0.0]));
        assert!(held.contact);
        assert!((held.proxy[1] - 0.05).abs() < 1e-10, "{held:?}");
    }
}

#[test]
fn a_body_that_moves_while_the_hand_is_lost_is_seen() {
    let mut servo = servo(vec![(cuboid([0.1; 3]), Vector::ZERO)], 0.0);
    let hand = Vector([0.0, 0.0625, 0.0]);
    assert!(!touch(&mut servo, hand).contact);
    servo.set_pose(0, at(0.0, 0.02, 0.0));
    touch(&mut servo, Vector([f64::NAN; 3]));
    let held = touch(&mut servo, hand);
    assert!(held.contact && held.force == Vector::ZERO, "{held:?}");
    assert!((held.proxy[1] - 0.07).abs() < 1e-9);
}

#[test]
fn a_crowd_that_moves_costs_nothing_beside_it() {
    // More bodies than a tick has evaluations, all of them within the horizon.
    let mut shapes = vec![(cuboid([0.2, 0.1, 0.2]), Vector::ZERO)];
    for i in 0..100 {
        shapes.push((ball(0.005), Vector([0.011 * f64::from(i) - 0.55, 0.1, 0.0])));
    }
    let mut servo = servo(shapes, 0.004);
    let hand = Vector([0.0, 0.053, 0.0]);
    touch(&mut servo, Vector([0.0, 0.07, 0.0]));
    let budget = servo.options().probe.budget();
    for tick in 0..50 {
        for i in 0..100 {
            let x = 0.011 * f64::from(i) - 0.55 + 1e-4 * f64::from(tick);
            servo.set_pose(1 + i as usize, at(x, 0.1, 0.0));
        }
        let held = touch(&mut servo, hand);
        assert!(held.contact && held.evaluations < budget / 4, "{held:?}");
        assert!((held.force - Vector([0.0, STIFFNESS * 0.001, 0.0])).norm() < 1e-6);
    }
}

#[test]
fn a_tray_does_not_take_the_hand_through_a_wall() {
    // The tray glides on the hand's side through a slot of the wall; the proxy does not fit.
    let tray = (cuboid([0.2, 0.02, 0.2]), Vector([0.0, -0.01, 0.0]));
    let wall = cuboid([1e-4, 0.2, 0.2]);
    let wall = (wall, Vector([0.05, 0.101, 0.0]));
    for speed in [0.002, 0.01, 0.1] {
        let mut servo = servo(vec![tray.clone(), wall.clone()], 0.002);
        touch(&mut servo, Vector([0.0, 0.05, 0.0]));
        touch(&mut servo, Vector([0.0, 0.001, 0.0]));
        let mut x = 0.0;
        while x + speed < 0.12 {
            x += speed;
            servo.set_pose(0, at(x, -0.01, 0.0));
            let held = touch(&mut servo, Vector([x, 0.001, 0.0]));
            assert!(held.proxy[0] <= 0.05 - 0.5e-4 - 0.002 + 1e-9, "{held:?}");
            assert!(held.proxy[1] >= 0.002 - 1e-9, "{held:?} at {speed}");
        }
    }
}

#[test]
fn a_small_body_that_flies_past_takes_the_hand_along() {
    // Ten bodies, so that only those near are looked at; 5 cm a tick, of a ball of 1 cm.
    let far = |i: i32| Vector([0.0, 0.0, 5.0 + f64::from(i)]);
    let mut shapes: Vec<_> = (0..9).map(|i| (ball(0.01), far(i))).collect();
    shapes.push((ball(0.01), Vector([0.025, 0.0, 0.0])));
    let mut servo = servo(shapes, 0.0);
    let hand = Vector([0.0, 0.001, 0.0]);
    for _ in 0..3 {
        assert!(!touch(&mut servo, hand).contact);
    }
    servo.set_pose(9, at(-0.025, 0.0, 0.0));
    let held = touch(&mut servo, hand);
    // Taken to the far side, the proxy is on its way back round the ball.
    assert!(held.body == 9 && held.proxy[0] < -0.02, "{held:?}");
}

#[test]
fn between_two_jaws_the_hand_is_in_neither() {
    for radius in [0.0, 0.002] {
        let jaw = cuboid([0.1, 0.02, 0.1]);
        let ends = [0.05, -0.05];
        let jaws = ends.map(|y| (jaw.clone(), Vector([0.0, y, 0.0])));
        let mut servo = servo(jaws.to_vec(), radius);
        let hand = Vector([0.01, 0.001, 0.0]);
        touch(&mut servo, hand);
        for tick in 0..60 {
            let way = 1e-3 * f64::from(tick);
            servo.set_pose(0, at(0.0, 0.05 - way, 0.0));
            servo.set_pose(1, at(0.0, -0.05 + way, 0.0));
            let held = touch(&mut servo, hand);
            assert!(held.force.is_finite());
            // The jaws that leave no room yield.
            let yielding: Vec<_> = servo.squeezed_by(0).collect();
            assert!(tick > 37 || yielding.is_empty(), "{tick}");
            assert!(!(42..46).contains(&tick) || !yielding.is_empty(), "{tick}");
            if held.contact {
                let bodies = (0..).zip(servo.bodies().bodies());
                for (_, body) in bodies.filter(|(index, _)| !yielding.contains(index)) {
                    let place = body.world_from_body().inverse().transform_point(held.proxy);
                    let gap = body.shape().distance(place) - radius;
                    assert!(gap >= -1e-9, "{gap} in tick {tick}: {held:?}");
                }
            }
        }
    }
}

#[test]
fn a_propeller_at_a_hundred_radians_a_second_does_not_pass_the_hand() {
    // 0.1 rad a tick: its tip goes 10 mm a tick, and is 1 mm thick.
    let blade = cuboid([0.2, 0.001, 0.02]);
    let mut servo = Servo::new(body(&blade, Surface::default()), 1, ServoOptions::default());
    let servo = servo.as_mut().unwrap();
    let hand = Vector([0.08, 0.02, 0.0]);
    touch(servo, hand);
    for tick in 0..200 {
        let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.1 * f64::from(tick));
        servo.set_pose(0, Pose::rotation(turn.unwrap()));
        let held = touch(servo, hand);
        let place = servo.bodies().bodies()[0].world_from_body().inverse();
        let gap = blade.distance(place.transform_point(held.proxy)) - 0.002;
        assert!(!held.contact || gap >= -1e-9, "{gap} in tick {tick}");
        assert!(held.force.is_finite() && held.force.norm() <= 3.3 + 1e-12);
    }
}
