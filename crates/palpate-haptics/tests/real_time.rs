// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo's step allocates nothing and stays in its budget.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests compare exact numbers")]

mod common;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use common::wild::{bodies, servo, step};
use common::{ball, cuboid, torus};
use palpate_field::{Shape, Vector};
use palpate_haptics::{
    Bodies, DeviceProfile, PointState, Protection, Servo, ServoOptions, Tour,
};

/// Aborts on an allocation where none is allowed.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

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

/// Twenty bodies that move, with textures, magnets, layers that give way and rings, guides on
/// each of 24 points, safety chains and estimated velocities, and scenes swapped in between.
#[test]
fn a_step_with_everything_at_once_allocates_and_frees_nothing() {
    const POINTS: usize = 24;
    let mut servo = servo::<3>(20, POINTS, 1.0);
    let profile = DeviceProfile {
        max_force: 4.0,
        continuous_force: 1.5,
        max_force_rate: 2000.0,
        mass: 0.05,
        least_damping: 0.3,
        friction: 0.1,
        encoder_step: 1e-5,
        ..DeviceProfile::unlimited("everything")
    };
    servo.protect(&Protection::new(profile)).unwrap();
    let mut states = [PointState::at_rest(Vector::ZERO); POINTS];
    let mut next = Some(bodies::<3>(20, 1.0));
    let (mut contacts, mut events) = (0, 0);
    for tick in 0..3000 {
        let old = assert_no_alloc(|| {
            servo.set_late(tick % 97 == 0);
            if tick % 500 == 250 {
                servo.stop(tick % 1000 == 250);
            }
            step(&mut servo, &mut states, (tick, 1.0));
            match next.take() {
                Some(bodies) if tick % 300 == 0 => Some(servo.replace_bodies(bodies)),
                other => other,
            }
        });
        next = old;
        contacts += servo.touches().iter().filter(|touch| touch.contact).count();
        events += servo.events().len();
    }
    assert!(contacts > 1000 && events > 50, "{contacts} contacts, {events} events");
}
