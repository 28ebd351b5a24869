// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that goes round a scene, pressed into it.

use palpate::field::{Point, Shape, Vector};

use super::{DEPTH, LANDING, PROBE, TICKS};

/// How far a hand goes in a tick [m]: 0.1 m/s.
const STEP: f64 = 1e-4;

/// How far above its path the hand starts to land [m].
const HEIGHT: f64 = 0.01;

/// Steps of Newton's method back to the surface, and how often they are made from afar.
const CORRECTIONS: u32 = 3;
const APPROACH: u32 = 30;

/// The least square of a slope that is divided by.
const LEAST_SLOPE: f64 = 0.01;

/// How much the heading turns in a tick at most [rad].
const TURN: f64 = 2e-3;

/// A hand's path over ticks of 1 ms: it lands in the first ticks, and goes on below where a
/// probe rests, as deep as hands press. The probe goes over the surface, nearly straight on;
/// where it turns about an edge, it waits until the hand is round. That of another hand starts
/// elsewhere.
pub(super) fn around(shape: &Shape<3>, hand: usize) -> Vec<Point<3>> {
    let longitude = 0.7 + 2.4 * hand as f64;
    let (across, up) = (longitude.sin(), longitude.cos());
    let mut probe = start(shape, Vector([across * up, across * across, up]));
    let mut heading = Vector([up, 0.3, -across]);
    let mut path = Vec::with_capacity(LANDING + TICKS);
    let mut device = pressed(shape, probe);
    for tick in 0..LANDING {
        let lift = HEIGHT * (LANDING - tick) as f64 / LANDING as f64;
        path.push(device + (probe - device) * ((DEPTH + lift) / DEPTH));
    }
    for tick in 0..TICKS {
        path.push(device);
        let way = pressed(shape, probe) - device;
        if way.norm() > STEP {
            device += way * (STEP / way.norm());
            continue;
        }
        device += way;
        let normal = normal(shape, probe);
        let along = heading - normal * heading.dot(normal);
        let ([ax, ay, az], [nx, ny, nz]) = (along.0, normal.0);
        let left = Vector([ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax]);
        let turn = TURN * (1e-3 * tick as f64).sin();
        heading = (along + left * turn).normalized().unwrap_or(heading);
        probe = at_rest(shape, probe + heading * STEP);
    }
    path
}

/// Where the hand is that presses a probe at rest.
fn pressed(shape: &Shape<3>, probe: Point<3>) -> Point<3> {
    probe - normal(shape, probe) * DEPTH
}

fn normal(shape: &Shape<3>, p: Point<3>) -> Vector<f64, 3> {
    shape.distance_gradient(p).1.normalized().unwrap_or(Vector::unit(1))
}

/// The point nearby at which the probe rests.
fn at_rest(shape: &Shape<3>, near: Point<3>) -> Point<3> {
    (0..CORRECTIONS).fold(near, |p, _| {
        let (value, gradient) = shape.distance_gradient(p);
        let squared = gradient.dot(gradient).max(LEAST_SLOPE);
        p - gradient * ((value - PROBE) / squared)
    })
}

/// Where a probe that comes from outside, from `direction`, rests.
fn start(shape: &Shape<3>, direction: Vector<f64, 3>) -> Point<3> {
    let away = shape.promise().bounds.map_or(1.0, |bounds| bounds.radius_about_origin());
    (0..APPROACH).fold(direction * away, |p, _| at_rest(shape, p))
}
