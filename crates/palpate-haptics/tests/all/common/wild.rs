// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A scene with everything in it at once, at any scale, and hands that play with it.

use super::AnyServo;
use palpate_device::PointState;
use palpate_field::{Point, Pose, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Guide, GuideOptions, Impact, Layer, Magnet, Material, PopThrough, Probe,
    Servo, ServoOptions, Surface, Texture, TextureKind, Unprotected,
};

use super::{ball, cuboid};

/// Ticks a second.
pub(crate) const RATE: f64 = 1000.0;

/// A wave from −1 to 1 that turns at ±1 and is made of exact operations alone.
pub(crate) fn wave(time: f64) -> f64 {
    let part = time - time.floor();
    let corner = 1.0 - 4.0 * (part - 0.5).abs();
    // Smooth where it turns.
    corner * (1.5 - 0.5 * corner * corner)
}

fn layer(depth: f64) -> Layer {
    Layer {
        description: None,
        depth,
        stiffness: Some(1500.0),
        damping: None,
        static_friction: Some(0.2),
        dynamic_friction: None,
        viscosity: None,
        pop_through: None,
    }
}

/// The material of body `i` in a scene that is `scale` times as large; forces scale alike.
fn material(i: usize, scale: f64) -> Material {
    let texture = |kind, amplitude: f64| Texture {
        description: None,
        kind,
        amplitude: amplitude * scale,
        wavelength: 0.004 * scale,
        direction: None,
    };
    let (static_friction, dynamic_friction) = [(0.0, 0.0), (0.6, 0.4), (0.3, 0.3)][i % 3];
    let mut material = Material {
        stiffness: 500.0,
        damping: 0.5,
        static_friction,
        dynamic_friction,
        viscosity: 0.1,
        ..Material::default()
    };
    match i % 5 {
        0 => material.texture = Some(texture(TextureKind::Height, 1e-4)),
        1 => material.texture = Some(texture(TextureKind::Displacement, 5e-5)),
        2 => {
            let (force, distance) = (0.5 * scale, 0.01 * scale);
            material.magnet = Some(Magnet { description: None, force, distance });
        }
        3 => {
            let (force, distance) = (0.8 * scale, 0.002 * scale);
            material.pop_through = Some(PopThrough { description: None, force, distance });
            material.layers = vec![layer(0.004 * scale)];
        }
        _ => {
            let (amplitude, frequency, decay) = (0.5, 120.0, 60.0);
            material.impact = Some(Impact { description: None, amplitude, frequency, decay });
            material.layers = vec![layer(0.001 * scale)];
        }
    }
    material
}

fn shape<const D: usize>(i: usize, scale: f64) -> Shape<D> {
    let size = 0.02 * scale;
    match i % 4 {
        0 => ball(size),
        1 => cuboid([1.8 * size; D]),
        // No hollow that hooks a proxy and keeps it far from its hand.
        2 => Shape::union([cuboid([1.6 * size; D]), ball(size)]).unwrap(),
        _ => {
            let mut factors = [1.0; D];
            factors[1] = 0.25;
            ball(1.2 * size).stretched(factors).unwrap()
        }
    }
}

/// The place of body `i`: rows of three, apart from each other, so that which of two bodies is
/// touched is never a matter of rounding.
fn place<const D: usize>(i: usize) -> Point<D> {
    let rows = [i % 3, (i / 3) % 3, i / 9];
    Vector(std::array::from_fn(|axis| 0.07 * (rows.get(axis).map_or(0, |r| *r) as f64 - 1.0)))
}

/// Where body `i` is at a tick: every other one goes to and fro.
pub(crate) fn pose<const D: usize>(i: usize, tick: u32, scale: f64) -> Pose<3> {
    let mut at = place::<D>(i);
    if i.is_multiple_of(2) {
        at[i % D] += 0.01 * wave(f64::from(tick) / 900.0 + 0.1 * i as f64);
    }
    Pose::translation((at * scale).in_space())
}

pub(crate) fn bodies<const D: usize>(count: usize, scale: f64) -> Bodies {
    let body = |i: usize| {
        let surface = Surface::new(&material(i, scale)).unwrap();
        Body::new(shape::<D>(i, scale), surface).unwrap().at(pose::<D>(i, 0, scale)).unwrap()
    };
    Bodies::new((0..count).map(body).collect()).unwrap()
}

/// A servo of so many bodies and points, guided to the middle.
pub(crate) fn servo<const D: usize>(
    count: usize,
    points: usize,
    scale: f64,
) -> Servo<Unprotected> {
    let options = ServoOptions {
        rate: RATE,
        probe: Probe::new(0.002 * scale).unwrap(),
        max_force: 5.0 * scale,
        ..ServoOptions::default()
    };
    let mut servo = Servo::new(bodies::<D>(count, scale), points, options).unwrap();
    let options = GuideOptions {
        stiffness: 50.0,
        max_force: 0.2 * scale,
        snap_distance: 0.03 * scale,
        release_distance: Some(0.04 * scale),
        ..GuideOptions::default()
    };
    servo.guide(&[Guide::to_point(Vector::ZERO, options).unwrap()]);
    servo
}

/// The same shapes in the same places with one surface, for hands without guides.
pub(crate) fn plain<const D: usize>(
    count: usize,
    points: usize,
    surface: &Surface,
) -> Servo<Unprotected> {
    let body = |i: usize| {
        let body = Body::new(shape::<D>(i, 1.0), surface.clone()).unwrap();
        body.at(pose::<D>(i, 0, 1.0)).unwrap()
    };
    let bodies = Bodies::new((0..count).map(body).collect()).unwrap();
    let probe = Probe::new(0.002).unwrap();
    let options = ServoOptions { rate: RATE, probe, max_force: 5.0, ..ServoOptions::default() };
    Servo::new(bodies, points, options).unwrap()
}

/// The hands at a tick: each on a path of its own through the scene.
pub(crate) fn hands<const D: usize>(tick: u32, states: &mut [PointState], scale: f64) {
    for (i, state) in states.iter_mut().enumerate() {
        let at = |tick: f64| {
            let place: Point<D> = Vector(std::array::from_fn(|axis| {
                let pace = 1.0 + 0.37 * axis as f64 + 0.11 * i as f64;
                0.095
                    * scale
                    * wave(pace * tick / 3000.0 + 0.13 * i as f64 + 0.29 * axis as f64)
            }));
            place.in_space()
        };
        let (now, before) = (at(f64::from(tick)), at(f64::from(tick) - 1.0));
        *state = PointState { position: now, velocity: (now - before) * RATE };
    }
}

/// Moves what moves and takes a step.
pub(crate) fn step<const D: usize>(
    servo: &mut impl AnyServo,
    states: &mut [PointState],
    (tick, scale): (u32, f64),
) {
    for i in (0..servo.bodies().bodies().len()).step_by(2) {
        servo.set_pose(i, pose::<D>(i, tick, scale));
    }
    step_hands::<D>(servo, states, (tick, scale));
}

/// Takes a step in which no body moves.
pub(crate) fn step_hands<const D: usize>(
    servo: &mut impl AnyServo,
    states: &mut [PointState],
    (tick, scale): (u32, f64),
) {
    hands::<D>(tick, states, scale);
    for state in &mut *states {
        // No hand goes deeper than 3 mm.
        let (distance, gradient) = servo.bodies().everything().look(state.position);
        state.position -= gradient * (distance + 0.003 * scale).min(0.0);
    }
    servo.step(states);
}
