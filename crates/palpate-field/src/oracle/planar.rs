// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pieces of definitions of the plane.

use std::f64::consts::{PI, TAU};

use super::{Definition, Patch, norm, on_ball, speed};
use crate::vector::{Point, Vector};

/// How far test points and the sampled part of unbounded shapes reach [m].
pub(crate) const FAR: f64 = 16.0;

pub(crate) const AXES: [Point<2>; 2] = [Vector([1.0, 0.0]), Vector([0.0, 1.0])];

pub(crate) fn arc(centre: [f64; 2], radius: f64, angles: [f64; 2]) -> Patch<2> {
    Patch::arc(Vector(centre), AXES, radius, angles)
}

/// The edges of a closed polygon.
pub(crate) fn edges(corners: &[Point<2>]) -> Vec<Patch<2>> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| Patch::segment(*a, *b)).collect()
}

/// `true` if `p` is inside by the even-odd rule, along a ray in a direction that no edge in the
/// tests has.
pub(crate) fn even_odd(rings: &[Vec<Point<2>>], p: Point<2>) -> bool {
    let ray = Vector([0.817_263_9, 0.576_258_1]);
    let side = |q: Point<2>| ray[0] * (q[1] - p[1]) - ray[1] * (q[0] - p[0]);
    let mut inside = false;
    for ring in rings {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let (sa, sb) = (side(*a), side(*b));
            if (sa > 0.0) != (sb > 0.0) {
                let crossing = *a + (*b - *a) * (sa / (sa - sb)) - p;
                inside ^= crossing.dot(ray) > 0.0;
            }
        }
    }
    inside
}

/// The corners of a regular polygon, one on +y, every other one at `inner`.
pub(crate) fn corners(count: f64, radii: &[f64]) -> Vec<Point<2>> {
    let count = count as usize * radii.len();
    (0..count)
        .map(|i| {
            let angle = TAU * i as f64 / count as f64;
            Vector([angle.sin(), angle.cos()]) * radii[i % radii.len()]
        })
        .collect()
}

pub(crate) fn polygon(rings: Vec<Vec<Point<2>>>) -> Definition<2> {
    let boundary = rings.iter().flat_map(|ring| edges(ring)).collect();
    Definition::new(boundary, move |p| even_odd(&rings, p))
}

/// The distance to a segment: that to its nearest point, by clamping.
pub(crate) fn from_segment<const D: usize>(a: Point<D>, b: Point<D>, p: Point<D>) -> f64 {
    let along = b - a;
    let square = along.dot(along);
    let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + along * t)).norm()
}

/// The profile of a box with corners rounded in the norm of an exponent.
pub(crate) fn rounded_rectangle(half: Point<2>, r: f64, exponent: f64) -> Vec<Patch<2>> {
    let mut boundary = Vec::new();
    for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
        let speed = 0.5 * PI * r * speed::<2>(exponent);
        boundary.push(Patch::curve(speed, move |t| {
            let (sin, cos) = (0.5 * PI * t).sin_cos();
            let out = on_ball(Vector([cos, sin]), exponent);
            Vector(std::array::from_fn(|i| signs[i] * (half[i] - r + r * out[i])))
        }));
    }
    for s in [1.0, -1.0] {
        let (x, y) = (half[0] - r, half[1] - r);
        boundary.push(Patch::segment(Vector([-x, s * half[1]]), Vector([x, s * half[1]])));
        boundary.push(Patch::segment(Vector([s * half[0], -y]), Vector([s * half[0], y])));
    }
    boundary
}

/// `true` in a box with corners rounded by `r` in the norm of an exponent.
pub(crate) fn in_rounded_box<const D: usize>(
    half: Point<D>,
    r: f64,
    exponent: f64,
    p: Point<D>,
) -> bool {
    let nearest = Vector(std::array::from_fn(|i| {
        let core = half[i] - r;
        p[i].clamp(-core, core)
    }));
    if r == 0.0 {
        (0..D).all(|i| p[i].abs() < half[i])
    } else {
        norm(p - nearest, exponent) < r
    }
}

pub(crate) fn line(a: [f64; 2], b: [f64; 2]) -> Patch<2> {
    Patch::segment(Vector(a), Vector(b))
}

/// The pieces on the right, and their mirror images on the left.
pub(crate) fn both_sides(
    right: Vec<Patch<2>>,
    contains: impl Fn(Point<2>) -> bool + 'static,
) -> Definition<2> {
    let mut boundary = Vec::new();
    for piece in right {
        let (kept, mirrored) = piece.mirrored();
        boundary.extend([kept, mirrored]);
    }
    Definition::new(boundary, contains)
}

pub(crate) fn corners_of(corners: &[[f64; 2]]) -> Definition<2> {
    polygon(vec![corners.iter().map(|c| Vector(*c)).collect()])
}

/// Samples of a curve, before the search for the nearest point between them.
pub(crate) const LOOKS: usize = 256;

/// Steps of this search, each of which keeps two thirds of the interval.
pub(crate) const THIRDS: usize = 80;

/// The least distance of `p` from a curve over `[0, 1]`: samples the curve, and searches around
/// each sample that is nearer than its neighbours.
pub(crate) fn from_curve(p: Point<2>, at: impl Fn(f64) -> Point<2>) -> f64 {
    let distance = |t: f64| (p - at(t)).norm();
    let place = |i: usize| i as f64 / LOOKS as f64;
    let looks: Vec<f64> = (0..=LOOKS).map(|i| distance(place(i))).collect();
    let mut least = f64::INFINITY;
    for (i, here) in looks.iter().enumerate() {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(LOOKS));
        if looks[before] < *here || looks[after] < *here {
            continue;
        }
        let (mut low, mut high) = (place(before), place(after));
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            if distance(low + third) < distance(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        least = least.min(distance(low));
    }
    least
}

/// The region above the graph of an even function on `|x| ≤ reach`, which is steepest at the
/// ends.
pub(crate) fn over(
    graph: impl Fn(f64) -> f64 + Copy + 'static,
    reach: f64,
    steepest: f64,
) -> Definition<2> {
    let curve = Patch::curve(2.0 * reach * steepest.hypot(1.0), move |t| {
        let x = reach * (2.0 * t - 1.0);
        Vector([x, graph(x)])
    });
    Definition::new(vec![curve], move |p| p[1] > graph(p[0]))
}

/// The point, and the derivative, of the curve of three control points by de
/// Casteljau's lines.
pub(crate) fn bezier([a, b, c]: [Point<2>; 3], t: f64) -> [Point<2>; 2] {
    let (first, second) = (a + (b - a) * t, b + (c - b) * t);
    [first + (second - first) * t, (second - first) * 2.0]
}

/// A box with corners rounded by `r` in the norm of an exponent.
pub(crate) fn rounded_area(half: Point<2>, r: f64, exponent: f64) -> Definition<2> {
    Definition::new(rounded_rectangle(half, r, exponent), move |p| {
        in_rounded_box(half, r, exponent, p)
    })
}
