// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that goes round a scene, pressed into it.

use palpate::field::{Point, Shape, Vector};

use super::{DEPTH, LANDING, PROBE, TICKS};

/// How far a hand goes in a tick [m]: 0.1 m/s.
const STEP: f64 = 1e-4;

/// How far above its path the hand starts to land [m].
const HEIGHT: f64 = 0.01;

/// Steps of a ray, and of Newton's method back to the path.
const RAY_STEPS: u32 = 256;
const CORRECTIONS: u32 = 3;

/// How much the heading turns in a tick at most [rad].
const TURN: f64 = 2e-3;

/// A hand's path over ticks of 1 ms: it lands in the first ticks, and goes on along the
/// surface, as deep below where a probe rests as hands press, nearly straight on. That of
/// another hand starts elsewhere.
pub(super) fn around(shape: &Shape<3>, hand: usize) -> Vec<Point<3>> {
    let longitude = 0.7 + 2.4 * hand as f64;
    let (across, up) = (longitude.sin(), longitude.cos());
    let mut here = start(shape, Vector([across * up, across * across, up]));
    let mut heading = Vector([up, 0.3, -across]);
    let mut path = Vec::with_capacity(LANDING + TICKS);
    let (_, normal) = shape.distance_gradient(here);
    for tick in 0..LANDING {
        path.push(here + normal * (HEIGHT * (LANDING - tick) as f64 / LANDING as f64));
    }
    for tick in 0..TICKS {
        path.push(here);
        let (_, normal) = shape.distance_gradient(here);
        let along = heading - normal * heading.dot(normal);
        let ([ax, ay, az], [nx, ny, nz]) = (along.0, normal.0);
        let left = Vector([ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax]);
        let turn = TURN * (1e-3 * tick as f64).sin();
        heading = (along + left * turn).normalized().unwrap_or(heading);
        here = on_path(shape, here + heading * STEP);
    }
    path
}

/// The point nearby at the depth of the path.
fn on_path(shape: &Shape<3>, near: Point<3>) -> Point<3> {
    (0..CORRECTIONS).fold(near, |p, _| {
        let (value, gradient) = shape.distance_gradient(p);
        let squared = gradient.dot(gradient).max(0.1);
        p - gradient * ((value - (PROBE - DEPTH)) / squared)
    })
}

/// Where a ray along `direction` from outside meets the path.
fn start(shape: &Shape<3>, direction: Vector<f64, 3>) -> Point<3> {
    let mut away = shape.promise().bounds.map_or(1.0, |bounds| bounds.radius_about_origin());
    for _ in 0..RAY_STEPS {
        let safe = shape.safe_radius(direction * away);
        if safe < STEP {
            break;
        }
        away -= safe;
    }
    on_path(shape, direction * away)
}
