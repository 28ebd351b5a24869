// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of shapes in the norms of higher powers.

use std::f64::consts::{PI, TAU};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::{in_rounded_box, rounded_rectangle};
use super::spatial::rounded_box;
use super::{Definition, Outside, Patch, number, vector};

/// `(Σ|xᵢ|^e)^(1/e)`, computed as written.
pub(super) fn norm<const D: usize>(x: Point<D>, exponent: f64) -> f64 {
    x.0.iter().map(|x| x.abs().powf(exponent)).sum::<f64>().powf(1.0 / exponent)
}

/// The point of the unit ball's surface in a direction of length one.
pub(super) fn on_ball<const D: usize>(direction: Point<D>, exponent: f64) -> Point<D> {
    direction * (1.0 / norm(direction, exponent))
}

/// The largest ratio of the motion of the point on the ball to that of its direction.
///
/// With the norm `n` of the direction, the point moves `1/n` times as far across the direction.
/// Along it the ratio is `√(1 − n²)/n²`, because the gradient of the norm is at most one long
/// and its part along the direction is `n`. Together this is `1/n²`, which is largest where all
/// components are equal.
pub(super) fn speed<const D: usize>(exponent: f64) -> f64 {
    (D as f64).powf(1.0 - 2.0 / exponent)
}

fn bound<const D: usize>(definition: Definition<D>) -> Definition<D> {
    Definition { outside: Outside::Bound, ..definition }
}

fn disc(radius: f64, exponent: f64) -> Definition<2> {
    let circle = Patch::curve(TAU * radius * speed::<2>(exponent), move |t| {
        let (sin, cos) = (TAU * t).sin_cos();
        on_ball(Vector([cos, sin]), exponent) * radius
    });
    bound(Definition::new(vec![circle], move |p| norm(p, exponent) < radius))
}

fn ball(radius: f64, exponent: f64) -> Definition<3> {
    let speed = radius * speed::<3>(exponent);
    let surface = Patch::surface([PI * speed, TAU * speed], move |u, v| {
        let ((up, across), (sin, cos)) = ((PI * (u - 0.5)).sin_cos(), (TAU * v).sin_cos());
        on_ball(Vector([across * cos, up, across * sin]), exponent) * radius
    });
    bound(Definition::new(vec![surface], move |p| norm(p, exponent) < radius))
}

fn torus(ring: f64, r: f64, [about, across]: [f64; 2]) -> Definition<3> {
    // Along the diagonals of the ring, its points move farther than those of the tube.
    let wider = speed::<2>(about).sqrt();
    let along = TAU * (ring + r) * speed::<2>(about);
    let around = TAU * r * speed::<2>(across) * wider;
    let surface = Patch::surface([along, around], move |u, v| {
        let ((sin, cos), (up, out)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let [x, z] = on_ball(Vector([cos, sin]), about).0;
        let [out, up] = on_ball(Vector([out, up]), across).0;
        let from_axis = ring + r * out;
        Vector([x * from_axis, r * up, z * from_axis])
    });
    let inside = move |p: Point<3>| {
        let from_ring = norm(Vector([p[0], p[2]]), about) - ring;
        norm(Vector([from_ring, p[1]]), across) < r
    };
    let definition = Definition::new(vec![surface], inside);
    if about.max(across) > 2.0 { bound(definition) } else { definition }
}

/// Definitions of the plane.
pub(super) fn planar(name: &str, a: &[Argument]) -> Option<Definition<2>> {
    let n = |i: usize| number(a, i);
    Some(match name {
        "power_ball" => disc(n(0), n(1)),
        "power_cuboid" => {
            let (half, r, exponent) = (vector::<2>(a, 0) * 0.5, n(1), n(2));
            bound(Definition::new(rounded_rectangle(half, r, exponent), move |p| {
                in_rounded_box(half, r, exponent, p)
            }))
        }
        _ => return None,
    })
}

/// Definitions of space.
pub(super) fn spatial(name: &str, a: &[Argument]) -> Option<Definition<3>> {
    let n = |i: usize| number(a, i);
    Some(match name {
        "power_ball" => ball(n(0), n(1)),
        "power_cuboid" => bound(rounded_box(vector::<3>(a, 0) * 0.5, n(1), n(2))),
        "power_torus" => torus(n(0), n(1), [n(2), n(3)]),
        _ => return None,
    })
}
