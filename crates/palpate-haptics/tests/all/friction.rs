// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Friction: how it holds a hand, and that it only takes energy.

use crate::common::{ball, body, cuboid, half_space, torus};
use palpate_device::PointState;
use palpate_field::{Point, Shape, SpaceShape, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, Material, Probe, Servo, ServoOptions, Surface, Touch, Unprotected,
};

const STIFFNESS: f64 = 512.0;

fn rough(shape: impl Into<SpaceShape>, friction: [f64; 2], radius: f64) -> Servo<Unprotected> {
    let shape: SpaceShape = shape.into();
    let material = Material {
        stiffness: STIFFNESS,
        damping: 0.0,
        static_friction: friction[0],
        dynamic_friction: friction[1],
        ..Material::default()
    };
    let options = ServoOptions {
        probe: Probe::new(radius).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    };
    Servo::new(body(shape, Surface::new(&material).unwrap()), 1, options).unwrap()
}

fn touch(servo: &mut Servo<Unprotected>, device: Point<3>) -> Touch {
    servo.step(&[PointState::at_rest(device)])[0]
}

#[test]
fn a_hand_sticks_within_the_cone_and_slips_beyond_it() {
    let mut servo = rough(half_space([0.0, 1.0, 0.0], 0.0), [0.5, 0.25], 0.0);
    let depth = 0.0078125;
    let at = |x: f64| Vector([x, -depth, 0.0]);
    touch(&mut servo, Vector([0.0, 0.1, 0.0]));
    let landed = touch(&mut servo, at(0.0)).proxy;
    assert!(landed.norm() < 1e-10);
    // Within half of the depth to the side, the proxy does not move at all.
    for x in [0.25, 0.5, -0.5, 0.0, 0.375] {
        let held = touch(&mut servo, at(x * depth));
        assert_eq!(held.proxy, landed);
        let force = Vector([-x, 1.0, 0.0]) * (STIFFNESS * depth);
        assert!((held.force - force).norm() < 1e-7);
        assert!(!held.is_slipping);
    }
    // Beyond, the tangential force is a quarter of the normal one, against the motion.
    for x in [0.75, 2.0, 5.0] {
        let held = touch(&mut servo, at(x * depth));
        assert!((held.force - Vector([-0.25, 1.0, 0.0]) * (STIFFNESS * depth)).norm() < 1e-7);
        assert!(held.is_slipping);
        let kinds: Vec<_> = servo.events().iter().map(|event| event.kind).collect();
        assert_eq!(kinds, if x == 0.75 { vec![EventKind::Slip] } else { vec![] });
    }
    // It sticks again when the hand goes back.
    let held = touch(&mut servo, at(4.75 * depth));
    assert_eq!(servo.events()[0].kind, EventKind::Stick);
    assert!((held.proxy - Vector([4.75 * depth, 0.0, 0.0])).norm() < 1e-10);
    assert!((held.force - Vector([0.0, STIFFNESS * depth, 0.0])).norm() < 1e-7);
}

/// The work that the force does on a hand over a closed path [J], and what is taken of it as
/// heat if there is friction. The force is held over a tick, as a device holds it.
fn work(servo: &mut Servo<Unprotected>, path: impl Fn(f64) -> Point<3>) -> f64 {
    const TICKS: u32 = 40_000;
    let mut last: Option<Touch> = None;
    let mut work = 0.0;
    for tick in 0..=3 * TICKS {
        let touch = touch(servo, path(f64::from(tick) / f64::from(TICKS)));
        if let Some(last) = last.filter(|_| tick > TICKS) {
            // The trapezoidal rule: the work of the force itself, and not of holding it.
            work += 0.5 * (touch.force + last.force).dot(touch.device - last.device);
        }
        last = Some(touch);
    }
    work
}

/// Loops that enter a shape of 50 mm and leave it again.
fn loops(seed: u32) -> impl Fn(f64) -> Point<3> {
    let turn = f64::from(seed);
    move |time: f64| {
        let angle = 2.0 * std::f64::consts::PI * time;
        let (wide, deep) = (0.01, 0.003);
        let out = Vector([turn.sin(), turn.cos(), 0.3]).normalized().unwrap();
        let side = Vector([out[1], -out[0], 0.0]).normalized().unwrap();
        let up = Vector([0.0, 0.0, 1.0]);
        let height = 0.051 - deep * angle.cos() * (2.0 + (turn * 0.7).sin());
        out * height + side * (wide * angle.sin()) + up * (wide * (2.0 * angle).sin())
    }
}

#[test]
fn without_friction_a_closed_path_gives_no_energy() {
    for seed in 0..4 {
        let mut servo = rough(ball::<3>(0.05), [0.0, 0.0], 0.002);
        let work = work(&mut servo, loops(seed));
        assert!(work.abs() < 1e-9, "{work:e} J");
    }
}

#[test]
fn with_friction_a_closed_path_takes_energy() {
    let shapes = [ball(0.05), cuboid([0.09, 0.09, 0.09]), torus(0.04, 0.012)];
    for shape in &shapes {
        for seed in 0..4 {
            let mut servo = rough(shape, [0.5, 0.3], 0.004);
            let work = work(&mut servo, loops(seed));
            assert!(work <= 1e-12, "{work:e} J");
        }
    }
}

#[test]
fn along_a_crease_both_walls_hold_back() {
    // Two walls at right angles, pressed alike: each with the depth, together √2 of it.
    let groove =
        Shape::union([half_space([1.0, 0.0, 0.0], 0.0), half_space([0.0, 1.0, 0.0], 0.0)])
            .unwrap();
    let mut servo = rough(&groove, [0.5, 0.25], 0.0078125);
    let radius = 0.0078125;
    let depth = 0.001953125;
    let at = |z: f64| Vector([radius - depth, radius - depth, z]);
    touch(&mut servo, Vector([0.05, 0.05, 0.0]));
    for _ in 0..10 {
        touch(&mut servo, at(0.0));
    }
    let mut held = touch(&mut servo, at(0.0));
    for tick in 1..200 {
        held = touch(&mut servo, at(1e-4 * f64::from(tick)));
    }
    let along = held.force[2] / (STIFFNESS * depth * std::f64::consts::SQRT_2);
    assert!((along + 0.25).abs() < 1e-6, "{along}");
    assert!((held.proxy[0] - radius).abs() < 1e-9 && (held.proxy[1] - radius).abs() < 1e-9);
}

/// The force of a damped and rough body in a hand that slides by `velocity` [m/s], after it has
/// slipped for a while.
fn dragged(bodies: Bodies, start: Point<3>, velocity: Vector<f64, 3>) -> Touch {
    let options = ServoOptions {
        probe: Probe::new(0.002).unwrap(),
        max_force: f64::INFINITY,
        rise_time: 1e-9,
        ..ServoOptions::default()
    };
    let mut servo = Servo::new(bodies, 1, options).unwrap();
    servo.step(&[PointState::at_rest(Vector([0.1, 0.1, 0.0]))]);
    servo.step(&[PointState::at_rest(start)]);
    for tick in 1..=200 {
        let position = start + velocity * (1e-3 * f64::from(tick));
        servo.step(&[PointState { position, velocity }]);
    }
    servo.touches()[0]
}

fn rubber() -> Surface {
    let (static_friction, dynamic_friction) = (0.9, 0.75);
    let rubber = Material { static_friction, dynamic_friction, ..Material::default() };
    Surface::new(&Material { stiffness: 300.0, damping: 2.0, ..rubber }).unwrap()
}

/// Once the damper acted along the stretch, which friction tilts: 0.55 N at 0.2 mm and 0.5 m/s.
#[test]
fn a_slide_at_a_constant_depth_feels_no_damper() {
    let floor = || body(half_space([0.0, 1.0, 0.0], 0.0), rubber());
    let start = Vector([0.0, 0.0018, 0.0]);
    for speed in [0.01, 0.1, 0.5] {
        let force = dragged(floor(), start, Vector([speed, 0.0, 0.0])).force;
        // K d, and the friction of a slip times that.
        let expected = Vector([-0.75, 1.0, 0.0]) * 0.06;
        assert!((force - expected).norm() < 1e-6, "{speed} m/s: {force:?}");
    }
    // The damper takes the speed towards the surface, and pushes along its normal.
    let slow = Vector([0.5, -0.001, 0.0]);
    let touch = dragged(floor(), start, slow);
    let depth = 0.002 - touch.device[1];
    let expected = Vector([-0.75, 1.0, 0.0]) * (300.0 * depth) + Vector([0.0, 0.002, 0.0]);
    assert!((touch.force - expected).norm() < 1e-6, "{:?}", touch.force);
}

#[test]
fn a_slide_along_a_crease_of_two_bodies_feels_no_damper() {
    let normals = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let walls = normals.map(|normal| Body::new(half_space(normal, 0.0), rubber()).unwrap());
    let start = Vector([0.0018, 0.0018, 0.0]);
    let walls = Bodies::new(walls.into()).unwrap();
    let force = dragged(walls, start, Vector([0.0, 0.0, 0.5])).force;
    // Friction holds 0.75 of the press of both walls together.
    let expected = Vector([0.06, 0.06, -0.75 * 0.06 * std::f64::consts::SQRT_2]);
    assert!((force - expected).norm() < 1e-5, "{force:?}");
}
