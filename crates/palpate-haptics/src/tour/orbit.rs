// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The way about a shape from which a hand looks at it.

use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Vector};

/// Turns about the axis for each pass from end to end: enough that neighbouring turns are a
/// twelfth of the shape apart. Not a whole number, so that passes interleave.
const TURNS_A_PASS: f64 = 6.18;

/// How much of the way from the box's middle to its pole an orbit goes.
const HIGHEST_LATITUDE: f64 = 0.97;

/// How much of the way to the other pole: to where a turn begins to pass below the box, at
/// `tan⁻¹ √½` of a quarter turn.
const LOWEST_LATITUDE: f64 = 0.39;

/// Points `step` apart [m] on a box `height` [m] around everything. In space they wind from the
/// foot of the box to its upper pole and back, and none is below the box: there is the table. In
/// the plane they go round.
pub(super) fn orbit<const D: usize>(
    bounds: &Aabb<D>,
    height: f64,
    step: f64,
    count: usize,
) -> impl Iterator<Item = Point<D>> {
    let grown = bounds.grown(height);
    let (mut centre, mut half) = (grown.centre(), grown.half_extents());
    if D > 2 {
        centre.0[1] += 0.5 * height;
        half.0[1] -= 0.5 * height;
    }
    // The angle is advanced by what the last advance travelled.
    let mut angle = 0.0;
    let mut rate = step / half.norm();
    let mut here = on_box(direction(angle), centre, half);
    (0..=count).map(move |_| {
        let result = here;
        let ahead = on_box(direction(angle + rate), centre, half);
        let travelled = (ahead - here).norm();
        rate *= (step / travelled.max(0.1 * step)).clamp(0.5, 2.0);
        angle += rate;
        here = on_box(direction(angle), centre, half);
        result
    })
}

/// The unit vector of the orbit at `angle` [rad] of its turns.
fn direction<const D: usize>(angle: f64) -> Vector<f64, D> {
    let (sin, cos) = libm::sincos(angle);
    let mut direction = [0.0; D];
    match &mut direction[..] {
        [x, y] => (*x, *y) = (sin, cos),
        [x, y, z] => {
            // From the middle up to the pole, down to the foot and back.
            let pass = angle / (TAU * TURNS_A_PASS);
            let triangle = 4.0 * (0.5 - ((0.5 * pass + 0.75).fract() - 0.5).abs()) - 1.0;
            let end = if triangle > 0.0 { HIGHEST_LATITUDE } else { LOWEST_LATITUDE };
            let latitude = 0.25 * TAU * end * triangle;
            let (height, radius) = libm::sincos(latitude);
            (*x, *y, *z) = (radius * sin, height, radius * cos);
        }
        _ => {}
    }
    Vector(direction)
}

/// The point of the box `|pᵢ − cᵢ| ≤ hᵢ` in `direction`, with the box stretched to a cube.
fn on_box<const D: usize>(
    direction: Vector<f64, D>,
    centre: Point<D>,
    half: Vector<f64, D>,
) -> Point<D> {
    let largest = direction.0.into_iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    centre + Vector(std::array::from_fn(|i| half.0[i] * direction.0[i] / largest))
}
