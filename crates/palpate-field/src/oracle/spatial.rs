// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pieces of definitions of space.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{Definition, Patch, from_segment, in_rounded_box, on_ball, speed};
use crate::vector::{Point, Vector};

/// A solid of revolution from the corners of its profile in (ρ, y).
pub(crate) fn turned_polyline(
    profile: &[[f64; 2]],
    contains: impl Fn(f64, f64) -> bool + 'static,
) -> Definition<3> {
    let boundary = profile
        .windows(2)
        .map(|ends| {
            let widest = ends[0][0].max(ends[1][0]);
            Patch::segment(Vector(ends[0]), Vector(ends[1])).turned(widest)
        })
        .collect();
    Definition::new(boundary, move |p| contains(p[0].hypot(p[2]), p[1]))
}

pub(crate) fn cylinder(r: f64, half: f64) -> Definition<3> {
    let profile = [[0.0, half], [r, half], [r, -half], [0.0, -half]];
    turned_polyline(&profile, move |rho, y| rho < r && y.abs() < half)
}

pub(crate) fn capped_cone(bottom: f64, top: f64, height: f64) -> Definition<3> {
    let half = 0.5 * height;
    let profile = [[0.0, half], [top, half], [bottom, -half], [0.0, -half]];
    turned_polyline(&profile, move |rho, y| {
        let share = (y + half) / height;
        y.abs() < half && rho < bottom + (top - bottom) * share
    })
}

/// A box with edges and corners rounded by `r` in the norm of an exponent.
pub(crate) fn rounded_box(half: Point<3>, r: f64, exponent: f64) -> Definition<3> {
    let core = half - Vector([r; 3]);
    let signs = [-1.0, 1.0];
    let mut boundary = Vec::new();
    for axis in 0..3 {
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        for s in signs {
            // A face, and an edge along `axis` on each side.
            boundary.push(Patch::surface([2.0 * core[j], 2.0 * core[k]], move |u, v| {
                let mut p = Vector::ZERO;
                p[axis] = s * half[axis];
                p[j] = core[j] * (2.0 * u - 1.0);
                p[k] = core[k] * (2.0 * v - 1.0);
                p
            }));
            for t in signs {
                if r == 0.0 {
                    continue;
                }
                boundary.push(Patch::surface(
                    [2.0 * core[axis], r * FRAC_PI_2 * speed::<2>(exponent)],
                    move |u, v| {
                        let (sin, cos) = (v * FRAC_PI_2).sin_cos();
                        let out = on_ball(Vector([cos, sin]), exponent);
                        let mut p = Vector::ZERO;
                        p[axis] = core[axis] * (2.0 * u - 1.0);
                        p[j] = s * (core[j] + r * out[0]);
                        p[k] = t * (core[k] + r * out[1]);
                        p
                    },
                ));
            }
        }
    }
    for corner in 0..8_u8 {
        let sign = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let signs = [sign(0), sign(1), sign(2)];
        let speed = r * FRAC_PI_2 * speed::<3>(exponent);
        boundary.push(Patch::surface([speed; 2], move |u, v| {
            let (up, turn) = (u * FRAC_PI_2, v * FRAC_PI_2);
            let out = Vector([up.cos() * turn.cos(), up.sin(), up.cos() * turn.sin()]);
            let out = on_ball(out, exponent);
            Vector(std::array::from_fn(|i| signs[i] * (core[i] + r * out[i])))
        }));
    }
    Definition::new(boundary, move |p| in_rounded_box(half, r, exponent, p))
}

/// A convex body from its triangles: points inside are behind all their planes.
pub(crate) fn hull(triangles: Vec<[Point<3>; 3]>, centre: Point<3>) -> Definition<3> {
    let planes: Vec<_> = triangles
        .iter()
        .map(|[a, b, c]| {
            let n = cross(*b - *a, *c - *a);
            let out = if (*a - centre).dot(n) < 0.0 { -n } else { n };
            (*a, out)
        })
        .collect();
    let boundary = triangles.into_iter().map(Patch::triangle).collect();
    Definition::new(boundary, move |p| planes.iter().all(|(a, n)| (p - *a).dot(*n) < 0.0))
}

pub(crate) fn cross(a: Point<3>, b: Point<3>) -> Point<3> {
    Vector([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
}

pub(crate) fn pyramid(side: f64, height: f64) -> Definition<3> {
    let (s, h) = (0.5 * side, 0.5 * height);
    let base = [[s, s], [-s, s], [-s, -s], [s, -s]].map(|[x, z]| Vector([x, -h, z]));
    let tip = Vector([0.0, h, 0.0]);
    let mut triangles = vec![[base[0], base[1], base[2]], [base[0], base[2], base[3]]];
    triangles.extend((0..4).map(|i| [base[i], base[(i + 1) % 4], tip]));
    hull(triangles, Vector([0.0, -0.5 * h, 0.0]))
}

pub(crate) fn ellipsoid(r: Point<3>) -> Definition<3> {
    let largest = r.0.iter().fold(0.0_f64, |m, r| m.max(*r));
    let surface = Patch::surface([PI * largest, TAU * largest], move |u, v| {
        let (up, turn) = (PI * (u - 0.5), TAU * v);
        Vector([r[0] * up.cos() * turn.cos(), r[1] * up.sin(), r[2] * up.cos() * turn.sin()])
    });
    Definition::new(vec![surface], move |p| {
        Vector::<f64, 3>(std::array::from_fn(|i| p[i] / r[i])).norm() < 1.0
    })
}

/// A solid from its profile in (ρ, y), which reaches to `widest`.
pub(crate) fn turned(
    profile: Vec<Patch<2>>,
    widest: f64,
    contains: impl Fn(f64, f64) -> bool + 'static,
) -> Definition<3> {
    let boundary = profile.into_iter().map(|piece| piece.turned(widest)).collect();
    Definition::new(boundary, move |p| contains(p[0].hypot(p[2]), p[1]))
}

/// A solid about the y axis, moved so that its axis is the line between two points and its
/// origin is half-way.
pub(crate) fn between(from: Point<3>, to: Point<3>, solid: Definition<3>) -> Definition<3> {
    let along = (to - from).normalized().unwrap_or(Vector::unit(1));
    let least = (0..3).min_by(|i, j| along[*i].abs().total_cmp(&along[*j].abs())).unwrap_or(0);
    let across = cross(along, Vector::unit(least)).normalized().unwrap_or(Vector::unit(0));
    let other = cross(across, along);
    let middle = (from + to) * 0.5;
    let place = move |p: Point<3>| middle + across * p[0] + along * p[1] + other * p[2];
    let boundary = solid.boundary.into_iter().map(|piece| piece.moved(place)).collect();
    let contains = solid.contains;
    Definition::new(boundary, move |p| {
        let q = p - middle;
        contains(Vector([q.dot(across), q.dot(along), q.dot(other)]))
    })
}

/// All points within `r` of the prism over a convex polygon, `|q·normal| ≤ half`.
///
/// The corners go counter-clockwise about the unit `normal`, in the plane across it
/// through the origin.
pub(crate) fn slab(
    corners: Vec<Point<3>>,
    normal: Point<3>,
    half: f64,
    r: f64,
) -> Definition<3> {
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
