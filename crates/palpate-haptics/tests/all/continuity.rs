// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The force is continuous on smooth shapes, in every direction and in the plane too.

use crate::common::{ball, body, cases, cuboid, direction, torus, unit, vector};
use palpate_device::PointState;
use palpate_field::operator::Profile;
use palpate_field::{Shape, Vector};
use palpate_haptics::{Probe, Servo, ServoOptions, Surface};

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
        let mut last = servo.step(&[PointState::at_rest(device.in_space())])[0];
        for tick in 0..1500 {
            if tick % 50 == 0 {
                velocity = vector(u)? * 1.5e-5;
            }
            let (distance, gradient) = shape.distance_gradient(device);
            // Towards the surface, from outside and from below.
            let level = -0.001 * (1.0 + unit(u)?.abs());
            let normal = gradient.normalized().unwrap_or(Vector::ZERO);
            device += velocity - normal * ((distance - radius - level) * 0.02);
            let touch = servo.step(&[PointState::at_rest(device.in_space())])[0];
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
    let flowing = Shape::smooth_union([ball(0.04), apart], Profile::Cubic, 0.01).unwrap();
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

#[test]
fn a_free_tick_costs_one_evaluation_and_a_sliding_one_at_most_four() {
    let cup = cuboid([0.08; 3]).difference([ball(0.03)]).unwrap();
    for shape in [ball(0.05), torus(0.04, 0.015), cuboid([0.06; 3]), cup] {
        let bodies = body(&shape, Surface::smooth(STIFFNESS, 0.0).unwrap());
        let mut servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
        let (mut free, mut sliding) = ((0, 0), (0, 0));
        for tick in 0..8000 {
            // Round the shape at 0.2 m/s, in and out of it.
            let angle = 0.004 * f64::from(tick);
            let (sin, cos) = angle.sin_cos();
            let out = Vector([cos, 0.3 * (0.31 * angle).sin(), sin]).normalized().unwrap();
            let mut device = out * 0.05;
            for _ in 0..20 {
                let (distance, gradient) = shape.distance_gradient(device);
                let level = 0.01 * (0.7 * angle).sin() + 0.009;
                device -= gradient * (distance - level);
            }
            let touch = servo.step(&[PointState::at_rest(device)])[0];
            let (ticks, evaluations) = if touch.contact { &mut sliding } else { &mut free };
            *ticks += 1;
            *evaluations += touch.evaluations;
        }
        let mean = |(ticks, evaluations): (u32, u32)| f64::from(evaluations) / f64::from(ticks);
        assert!(free.0 > 500 && sliding.0 > 500, "{free:?} {sliding:?}");
        // Past an edge nearby, or away from a surface, a flight takes another look.
        assert!(mean(free) < 1.05, "{free:?}");
        assert!(mean(sliding) <= 4.0, "{sliding:?}");
    }
}
