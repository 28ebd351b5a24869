// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Materials and scenes at the edge of what makes sense: nothing hangs, nothing is not finite.

use crate::common::wild::wave;
use crate::common::{Scaled, ball, cuboid, half_space};
use palpate_device::PointState;
use palpate_field::{BoundingBall, Pose, Promise, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Layer, Magnet, Material, Probe, Servo, ServoOptions, Surface, Texture,
    TextureKind,
};

/// Two springs of nothing, a wall of honey, glue, and other things.
fn materials() -> Vec<(&'static str, Material)> {
    let base = || Material { damping: 0.0, ..Material::default() };
    let friction = |fixed, slipping| Material {
        static_friction: fixed,
        dynamic_friction: slipping,
        ..base()
    };
    let layer =
        |depth: f64, stiffness| Layer { depth, stiffness: Some(stiffness), ..Layer::default() };
    let texture = |kind| {
        let (amplitude, wavelength) = (1e-5, 1e-4);
        Some(Texture { description: None, kind, amplitude, wavelength, direction: None })
    };
    let magnet = Some(Magnet { description: None, force: 1.0, distance: 50.0 });
    let layers = vec![layer(0.001, 1e6), layer(0.001 + 1e-9, 0.0), layer(0.001 + 2e-9, 1e3)];
    vec![
        ("no spring", Material { stiffness: 0.0, ..base() }),
        ("honey", Material { stiffness: 0.0, viscosity: 3.0, damping: 5.0, ..base() }),
        ("sticks, but slips freely", friction(0.8, 0.0)),
        ("slips harder than it sticks", friction(0.1, 0.9)),
        ("glue", friction(10.0, 10.0)),
        ("leaves", Material { layers, ..base() }),
        ("a fine grain", Material { texture: texture(TextureKind::Height), ..base() }),
        ("a fine relief", Material { texture: texture(TextureKind::Displacement), ..base() }),
        ("a magnet beyond the scene", Material { magnet, ..base() }),
        ("diamond", Material { stiffness: 1e12, ..base() }),
    ]
}

/// Plays over three bodies that touch each other; every proxy in contact stays out of all.
fn plays<const D: usize>(name: &str, material: &Material, radius: f64) {
    let at = |x: f64| Pose::translation(Vector::unit(0) * x);
    let shapes = [(cuboid([0.04; D]), -0.04), (cuboid([0.04; D]), 0.0), (ball(0.02), 0.04)];
    let body = |(shape, x): (Shape<D>, f64)| {
        Body::new(shape, Surface::new(material).unwrap())?.at(at(x))
    };
    let bodies = shapes.into_iter().map(body).collect::<Result<_, _>>().unwrap();
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, ..ServoOptions::default() };
    let mut servo = Servo::new(Bodies::new(bodies).unwrap(), 1, options).unwrap();
    let mut contacts = 0;
    for tick in 0..3000 {
        let time = f64::from(tick) / 1500.0;
        let mut position = Vector::<f64, 3>::ZERO;
        (position[0], position[1]) = (0.07 * wave(time), 0.02 + 0.003 * wave(5.0 * time));
        let velocity = Vector::unit(1) * -0.1;
        let touch = servo.step(&[PointState { position, velocity }])[0];
        assert!(touch.force.is_finite() && touch.force.norm() <= 3.3 + 1e-12, "{name}");
        assert!(servo.reactions().iter().all(|r| r.force.is_finite()), "{name}");
        if touch.contact {
            contacts += 1;
            let gap = servo.bodies().everything().look(touch.proxy).0 - radius;
            assert!(gap >= -1e-10, "{name}: {gap} {touch:?}");
        }
    }
    assert!(contacts > 500, "{name}: {contacts}");
}

#[test]
fn materials_at_the_edge_are_survived() {
    for (name, material) in materials() {
        for radius in [0.0, 0.002] {
            plays::<2>(name, &material, radius);
            plays::<3>(name, &material, radius);
        }
    }
}

#[test]
fn a_floor_without_bounds_is_felt_among_many_bodies() {
    let surface = || Surface::smooth(512.0, 0.0).unwrap();
    let mut bodies = vec![Body::new(half_space([0.0, 1.0, 0.0], 0.0), surface()).unwrap()];
    for i in 0..30 {
        let at = Pose::translation(Vector([0.05 * f64::from(i), 0.1, 0.3]));
        bodies.push(Body::new(ball::<3>(0.02), surface()).unwrap().at(at).unwrap());
    }
    let probe = Probe::new(0.002).unwrap();
    let options = ServoOptions { probe, ..ServoOptions::default() };
    let mut servo = Servo::new(Bodies::new(bodies).unwrap(), 1, options).unwrap();
    for x in [-100.0, 0.0, 0.3, 100.0] {
        servo.step(&[PointState::at_rest(Vector([x, 0.05, 0.0]))]);
        let touch = servo.step(&[PointState::at_rest(Vector([x, 0.001, 0.0]))])[0];
        assert!(touch.contact && touch.body == 0);
        assert!((touch.proxy - Vector([x, 0.002, 0.0])).norm() < 1e-6, "{touch:?}");
    }
}

#[test]
fn twisted_and_bent_bodies_are_felt_among_many() {
    let surface = || Surface::smooth(512.0, 0.0).unwrap();
    let screw = || cuboid([0.02, 0.06, 0.04]).twisted(20.0).unwrap();
    let bow = || cuboid([0.08, 0.02, 0.04]).bent(10.0).unwrap();
    let bodies = (0..12).map(|i| {
        let shape = if i % 2 == 0 { screw() } else { bow() };
        let at = Pose::translation(Vector([0.15 * f64::from(i), 0.0, 0.0]));
        Body::new(shape, surface())?.at(at)
    });
    let bodies = Bodies::new(bodies.collect::<Result<_, _>>().unwrap()).unwrap();
    let options = ServoOptions { probe: Probe::new(0.002).unwrap(), ..ServoOptions::default() };
    let mut servo = Servo::new(bodies, 1, options).unwrap();
    for i in 0..12 {
        let x = 0.15 * f64::from(i);
        servo.step(&[PointState::at_rest(Vector([x, 0.3, 0.0]))]);
        let mut touch = servo.step(&[PointState::at_rest(Vector([x, 0.1, 0.0]))])[0];
        for tick in 0..100 {
            let y = 0.1 - 0.001 * f64::from(tick);
            touch = servo.step(&[PointState::at_rest(Vector([x, y, 0.0]))])[0];
        }
        assert!(touch.contact && touch.body == i as u32, "{i}: {touch:?}");
        let gap = servo.bodies().everything().look(touch.proxy).0 - 0.002;
        assert!(gap >= -1e-9);
    }
}

#[test]
fn bodies_known_in_regions_apart_touch_nothing_and_enter_nothing() {
    // Each is known to be no steeper than 1 around itself alone. Together they are proven
    // nowhere, so nothing is felt; a hand that is lost feels no force.
    let known = |x: f64| {
        let shape = ball::<3>(0.02);
        let region = BoundingBall { centre: Vector::ZERO, radius: 0.03 };
        let promise = Promise::lipschitz(shape.promise().bounds, 1.0).with_region(region);
        let shape = Shape::custom(Scaled { shape, factor: 1.0, promise });
        let at = Pose::translation(Vector([x, 0.0, 0.0]));
        Body::new(shape, Surface::default()).unwrap().at(at).unwrap()
    };
    let bodies = Bodies::new(vec![known(-0.1), known(0.1)]).unwrap();
    let mut servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
    for tick in 0..1000 {
        let x = 0.2 * wave(f64::from(tick) / 500.0);
        let touch = servo.step(&[PointState::at_rest(Vector([x, 0.01, 0.0]))])[0];
        assert!(touch.force.is_finite() && !touch.contact);
    }
}
