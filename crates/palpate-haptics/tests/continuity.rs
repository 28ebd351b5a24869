// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The force is continuous on smooth shapes, in every direction and in the plane too.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{ball, body, cases, cuboid, direction, torus, unit, vector};
use palpate_field::operator::Smooth;
use palpate_field::{Shape, Vector};
use palpate_haptics::{PointState, Probe, Servo, ServoOptions, Surface};

const STIFFNESS: f64 = 1000.0;

/// How much more than on a plane the force may change: what is left of a search, and of a rest.
const TOLERANCE: f64 = 2e-5;

/// Hands that wander about the surface of a smooth shape, at most 3 mm deep, and whose force
/// changes by at most `K ‖dx‖ (1 + d / ρ)`, with the least radius `ρ` of a hollow of the
/// surface, offset by the probe, less the depth `d`; on a bulge the closest point goes less far
/// than the hand, and the force turns no faster than for a point at that depth below it.
fn is_continuous<const D: usize>(name: &str, shape: &Shape<D>, (radius, bend): (f64, f64)) {
    let surface = Surface::smooth(STIFFNESS, 0.0).unwrap();
    let bodies = body(shape, surface);
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, max_force: f64::INFINITY, ..ServoOptions::default() };
    cases(20, |u| {
        let mut servo = Servo::new(bodies.clone(), 1, options).unwrap();
        let mut device: Vector<f64, D> = direction(u)? * 0.1;
        let mut velocity = Vector::ZERO;
        let mut last = servo.step(&[PointState::at_rest(device)])[0];
        for tick in 0..1500 {
            if tick % 50 == 0 {
                velocity = vector(u)? * 1.5e-5;
            }
            let (distance, gradient) = shape.distance_gradient(device);
            // Towards the surface, from outside and from below.
            let level = -0.001 * (1.0 + unit(u)?.abs());
            let normal = gradient.normalized().unwrap_or(Vector::ZERO);
            device += velocity - normal * ((distance - radius - level) * 0.02);
            let touch = servo.step(&[PointState::at_rest(device)])[0];
            let way = (touch.device - last.device).norm();
            let change = (touch.force - last.force).norm();
            let depth = touch.depth().max(last.depth());
            assert!(depth < 0.5 * bend, "{name}: {depth} m deep");
            let most = STIFFNESS * way * (1.0 + depth / (bend - depth));
            assert!(change <= most + TOLERANCE, "{name}: {change} N over {way} m, {touch:?}");
            last = touch;
        }
        assert!(last.contact, "{name}");
        Ok(())
    });
}

#[test]
fn on_smooth_shapes_of_space_the_force_is_continuous() {
    let apart = ball(0.03).translated(Vector([0.035, 0.0, 0.0])).unwrap();
    let flowing = Shape::smooth_union([ball(0.04), apart], Smooth::Cubic, 0.01).unwrap();
    is_continuous("a ball", &ball::<3>(0.05), (0.0, 0.05));
    is_continuous("a ball", &ball::<3>(0.05), (0.002, 0.052));
    is_continuous("a ring", &torus(0.04, 0.015), (0.002, 0.017));
    is_continuous("two balls that flow together", &flowing, (0.002, 0.02));
    is_continuous("a box", &cuboid([0.05, 0.07, 0.06]), (0.008, 0.008));
}

#[test]
fn on_smooth_shapes_of_the_plane_the_force_is_continuous() {
    is_continuous("a disc", &ball::<2>(0.05), (0.0, 0.05));
    is_continuous("a rectangle", &cuboid([0.05, 0.07]), (0.008, 0.008));
}
