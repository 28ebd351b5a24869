// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of flat convex polygons with a height and a radius.

use std::f64::consts::FRAC_PI_2;

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::from_segment;
use super::spatial::cross;
use super::{Definition, Patch, number, points, vector};

/// All points within `r` of the prism over a convex polygon, `|q·normal| ≤ half`.
///
/// The corners go counter-clockwise about the unit `normal`, in the plane across it
/// through the origin.
fn slab(corners: Vec<Point<3>>, normal: Point<3>, half: f64, r: f64) -> Definition<3> {
    let count = corners.len();
    let next = |i: usize| corners[(i + 1) % count];
    let outwards: Vec<Point<3>> = (0..count)
        .map(|i| cross(next(i) - corners[i], normal).normalized().unwrap_or(normal))
        .collect();
    let mut boundary = Vec::new();
    for i in 0..count {
        let (from, to, out) = (corners[i], next(i), outwards[i]);
        let before = outwards[(i + count - 1) % count];
        let turn = before.dot(out).clamp(-1.0, 1.0).acos();
        let left = cross(normal, before);
        let around = move |t: f64| before * (turn * t).cos() + left * (turn * t).sin();
        let length = (to - from).norm();
        // The wall, and that of the rounded corner.
        boundary.push(Patch::surface([length, 2.0 * half], move |u, v| {
            from + (to - from) * u + out * r + normal * (half * (2.0 * v - 1.0))
        }));
        boundary.push(Patch::surface([r * turn, 2.0 * half], move |u, v| {
            from + around(u) * r + normal * (half * (2.0 * v - 1.0))
        }));
        for side in [1.0, -1.0] {
            let up = normal * side;
            let cap = [corners[0], from, to].map(|c| c + up * (half + r));
            boundary.push(Patch::triangle(cap));
            boundary.push(Patch::surface([length, r * FRAC_PI_2], move |u, v| {
                let (sin, cos) = (FRAC_PI_2 * v).sin_cos();
                from + (to - from) * u + out * (r * cos) + up * (half + r * sin)
            }));
            boundary.push(Patch::surface([r * turn, r * FRAC_PI_2], move |u, v| {
                let (sin, cos) = (FRAC_PI_2 * v).sin_cos();
                from + around(u) * (r * cos) + up * (half + r * sin)
            }));
        }
    }
    Definition::new(boundary, move |p| {
        let height = p.dot(normal);
        let flat = p - normal * height;
        let ends = || (0..count).map(|i| (corners[i], corners[(i + 1) % count]));
        let behind = (0..count).all(|i| (flat - corners[i]).dot(outwards[i]) < 0.0);
        let beside =
            ends().map(|(a, b)| from_segment(a, b, flat)).fold(f64::INFINITY, f64::min);
        let beside = if behind { 0.0 } else { beside };
        let past = (height.abs() - half).max(0.0);
        if r == 0.0 { behind && height.abs() < half } else { beside.hypot(past) < r }
    })
}

/// The slab without height on `corners`, in their own plane.
fn sheet(corners: &[Point<3>], r: f64) -> Option<Definition<3>> {
    let origin = corners[0];
    let crossing = (2..corners.len())
        .map(|i| cross(corners[i - 1] - origin, corners[i] - origin))
        .fold(Vector::ZERO, |sum, area| sum + area);
    let normal = crossing.normalized()?;
    let flat = corners.iter().map(|c| *c - origin).collect();
    let slab = slab(flat, normal, 0.0, r);
    let boundary =
        slab.boundary.into_iter().map(|piece| piece.moved(move |p| p + origin)).collect();
    let contains = slab.contains;
    Some(Definition::new(boundary, move |p| contains(p - origin)))
}

/// The rhombus with its faces moved inwards by `r`, then grown by `r`.
fn rhombus_prism(size: Point<3>, r: f64) -> Definition<3> {
    let [a, half, b] = (size * 0.5).0;
    let slope = b.atan2(a);
    let face = a * slope.sin() - r;
    let (a, b) = (face / slope.sin(), face / slope.cos());
    // About y, from z to x.
    let corners = [[0.0, b], [a, 0.0], [0.0, -b], [-a, 0.0]].map(|[x, z]| Vector([x, 0.0, z]));
    slab(corners.to_vec(), Vector::unit(1), half - r, r)
}

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<3>> {
    match name {
        "rhombus_prism" => Some(rhombus_prism(vector(a, 0), number(a, 1))),
        "triangle_sheet" | "quad_sheet" => sheet(&points(a, 0), number(a, 1)),
        _ => None,
    }
}
