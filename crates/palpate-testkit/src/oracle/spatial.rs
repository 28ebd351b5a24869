// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of the primitives of space.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::{FAR, corners, edges, even_odd, from_segment, in_rounded_box};
use super::power::{on_ball, speed};
use super::{
    Definition, Outside, Patch, number, points, power, revolved, slab, thread, tube, vector,
};

/// A solid of revolution from the corners of its profile in (ρ, y).
fn turned(
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

pub(super) fn cylinder(r: f64, half: f64) -> Definition<3> {
    let profile = [[0.0, half], [r, half], [r, -half], [0.0, -half]];
    turned(&profile, move |rho, y| rho < r && y.abs() < half)
}

pub(super) fn capped_cone(bottom: f64, top: f64, height: f64) -> Definition<3> {
    let half = 0.5 * height;
    let profile = [[0.0, half], [top, half], [bottom, -half], [0.0, -half]];
    turned(&profile, move |rho, y| {
        let share = (y + half) / height;
        y.abs() < half && rho < bottom + (top - bottom) * share
    })
}

/// A box with edges and corners rounded by `r` in the norm of an exponent.
pub(super) fn rounded_box(half: Point<3>, r: f64, exponent: f64) -> Definition<3> {
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

/// The bars along the edges of a box: in each octant, the four rectangles across each axis that
/// bound them.
fn frame(half: Point<3>, thickness: f64) -> Definition<3> {
    let hole = half - Vector([thickness; 3]);
    let mut boundary = Vec::new();
    for octant in 0..8_u8 {
        let sign = move |axis: usize| if octant >> axis & 1 == 1 { 1.0 } else { -1.0 };
        for axis in 0..3 {
            let others = [(axis + 1) % 3, (axis + 2) % 3];
            let mut rectangle = |at: f64, ranges: [[f64; 2]; 2]| {
                let [[a, b], [c, d]] = ranges;
                boundary.push(Patch::surface([b - a, d - c], move |u, v| {
                    let mut p = Vector::ZERO;
                    p[axis] = at * sign(axis);
                    p[others[0]] = (a + (b - a) * u) * sign(others[0]);
                    p[others[1]] = (c + (d - c) * v) * sign(others[1]);
                    p
                }));
            };
            let [i, j] = others;
            // The face of the box, without its window.
            rectangle(half[axis], [[hole[i], half[i]], [0.0, half[j]]]);
            rectangle(half[axis], [[0.0, hole[i]], [hole[j], half[j]]]);
            // Behind it, the faces of the bars that are visible through another window.
            rectangle(hole[axis], [[hole[i], half[i]], [0.0, hole[j]]]);
            rectangle(hole[axis], [[0.0, hole[i]], [hole[j], half[j]]]);
        }
    }
    Definition::new(boundary, move |p| {
        let in_box = (0..3).all(|i| p[i].abs() < half[i]);
        in_box && (0..3).filter(|i| p[*i].abs() > hole[*i]).count() >= 2
    })
}

/// A convex body from its triangles: points inside are behind all their planes.
fn hull(triangles: Vec<[Point<3>; 3]>, centre: Point<3>) -> Definition<3> {
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

pub(super) fn cross(a: Point<3>, b: Point<3>) -> Point<3> {
    Vector([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
}

fn prism(sides: f64, radius: f64, height: f64) -> Definition<3> {
    let half = 0.5 * height;
    let ring = corners(sides, &[radius]);
    let mut boundary: Vec<_> = edges(&ring).into_iter().map(|e| e.raised(half)).collect();
    for y in [-half, half] {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let [a, b, o] = [*a, *b, Vector([0.0, 0.0])].map(|q| Vector([q[0], y, q[1]]));
            boundary.push(Patch::triangle([o, a, b]));
        }
    }
    let rings = [ring];
    Definition::new(boundary, move |p| {
        p[1].abs() < half && even_odd(&rings, Vector([p[0], p[2]]))
    })
}

fn pyramid(side: f64, height: f64) -> Definition<3> {
    let (s, h) = (0.5 * side, 0.5 * height);
    let base = [[s, s], [-s, s], [-s, -s], [s, -s]].map(|[x, z]| Vector([x, -h, z]));
    let tip = Vector([0.0, h, 0.0]);
    let mut triangles = vec![[base[0], base[1], base[2]], [base[0], base[2], base[3]]];
    triangles.extend((0..4).map(|i| [base[i], base[(i + 1) % 4], tip]));
    hull(triangles, Vector([0.0, -0.5 * h, 0.0]))
}

/// All points within `r` of a segment.
fn rod(a: Point<3>, b: Point<3>, r: f64) -> Definition<3> {
    let along = (b - a).normalized().unwrap_or(Vector::unit(1));
    let least = (0..3).min_by(|i, j| along[*i].abs().total_cmp(&along[*j].abs())).unwrap_or(0);
    let across = cross(along, Vector::unit(least)).normalized().unwrap_or(Vector::unit(0));
    let other = cross(along, across);
    let around = move |v: f64| across * (TAU * v).cos() + other * (TAU * v).sin();
    let mut boundary = vec![Patch::surface([(b - a).norm(), TAU * r], move |u, v| {
        a + (b - a) * u + around(v) * r
    })];
    for (end, out) in [(b, along), (a, -along)] {
        boundary.push(Patch::surface([FRAC_PI_2 * r, TAU * r], move |u, v| {
            let up = FRAC_PI_2 * u;
            end + out * (r * up.sin()) + around(v) * (r * up.cos())
        }));
    }
    Definition::new(boundary, move |p| from_segment(a, b, p) < r)
}

fn half_space(normal: Point<3>, offset: f64) -> Option<Definition<3>> {
    let normal = normal.normalized()?;
    let least = (0..3).min_by(|i, j| normal[*i].abs().total_cmp(&normal[*j].abs()))?;
    let x = cross(normal, Vector::unit(least)).normalized()?;
    let y = cross(normal, x);
    let plane = Patch::surface([2.0 * FAR; 2], move |u, v| {
        normal * offset + x * (FAR * (2.0 * u - 1.0)) + y * (FAR * (2.0 * v - 1.0))
    });
    Some(Definition::new(vec![plane], move |p| p.dot(normal) < offset))
}

fn ellipsoid(r: Point<3>) -> Definition<3> {
    let largest = r.0.iter().fold(0.0_f64, |m, r| m.max(*r));
    let surface = Patch::surface([PI * largest, TAU * largest], move |u, v| {
        let (up, turn) = (PI * (u - 0.5), TAU * v);
        Vector([r[0] * up.cos() * turn.cos(), r[1] * up.sin(), r[2] * up.cos() * turn.sin()])
    });
    Definition::new(vec![surface], move |p| {
        Vector::<f64, 3>(std::array::from_fn(|i| p[i] / r[i])).norm() < 1.0
    })
}

fn rounded_cylinder(r: f64, half: f64, rounding: f64) -> Definition<3> {
    let profile = super::planar::rounded_rectangle(Vector([r, half]), rounding, 2.0);
    // Turning the whole cross-section covers the surface twice.
    let boundary = profile.into_iter().map(|piece| piece.turned(r)).collect();
    Definition::new(boundary, move |p| {
        let q = Vector([p[0].hypot(p[2]), p[1]]);
        in_rounded_box(Vector([r, half]), rounding, 2.0, q)
    })
}

fn octahedron(r: f64) -> Definition<3> {
    let mut triangles = Vec::new();
    for x in [-r, r] {
        for y in [-r, r] {
            for z in [-r, r] {
                triangles.push([
                    Vector([x, 0.0, 0.0]),
                    Vector([0.0, y, 0.0]),
                    Vector([0.0, 0.0, z]),
                ]);
            }
        }
    }
    hull(triangles, Vector::ZERO)
}

fn tetrahedron(corners: &[Point<3>]) -> Definition<3> {
    let centre = corners.iter().fold(Vector::ZERO, |sum, c| sum + *c * 0.25);
    let triangles = (0..4)
        .map(|i| [corners[(i + 1) % 4], corners[(i + 2) % 4], corners[(i + 3) % 4]])
        .collect();
    hull(triangles, centre)
}

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<3>> {
    let n = |i: usize| number(a, i);
    let bound = |d: Definition<3>| Definition { outside: Outside::Bound, ..d };
    Some(match name {
        "ball" => ellipsoid(Vector([n(0); 3])),
        "cuboid" => rounded_box(vector::<3>(a, 0) * 0.5, 0.0, 2.0),
        "rounded_cuboid" => rounded_box(vector::<3>(a, 0) * 0.5, n(1), 2.0),
        "capsule" => {
            let end = Vector([0.0, 0.5 * n(1) - n(0), 0.0]);
            rod(-end, end, n(0))
        }
        "segment" => rod(vector(a, 0), vector(a, 1), n(2)),
        "half_space" => half_space(vector(a, 0), n(1))?,
        "tetrahedron" => tetrahedron(&points(a, 0)),
        "ellipsoid" => ellipsoid(vector(a, 0)),
        "cylinder" => cylinder(n(0), 0.5 * n(1)),
        "rounded_cylinder" => rounded_cylinder(n(0), 0.5 * n(1), n(2)),
        "infinite_cylinder" => {
            let r = n(0);
            let wall = Patch::segment(Vector([r, -FAR]), Vector([r, FAR])).turned(r);
            Definition::new(vec![wall], move |p| p[0].hypot(p[2]) < r)
        }
        "capped_cone" => capped_cone(n(0), n(1), n(2)),
        "cone" => capped_cone(n(0), 0.0, n(1)),
        "pyramid" => pyramid(n(0), n(1)),
        "torus" => {
            let (ring, r) = (n(0), n(1));
            let tube = Patch::arc(
                Vector([ring, 0.0]),
                [Vector([1.0, 0.0]), Vector([0.0, 1.0])],
                r,
                [0.0, TAU],
            );
            Definition::new(vec![tube.turned(ring + r)], move |p| {
                (p[0].hypot(p[2]) - ring).hypot(p[1]) < r
            })
        }
        "hexagonal_prism" => prism(6.0, n(0), n(1)),
        "triangular_prism" => prism(3.0, n(0) / 3.0_f64.sqrt(), n(1)),
        "octahedron" => octahedron(n(0)),
        "cube_approximation" => bound(rounded_box(Vector([0.5 * n(0); 3]), 0.0, 2.0)),
        "cylinder_approximation" => bound(cylinder(n(0), 0.5 * n(1))),
        "cone_approximation" => bound(capped_cone(n(0), 0.0, n(1))),
        "pyramid_approximation" => bound(pyramid(n(0), n(1))),
        "screw_thread" => bound(thread::definition(a)),
        "cuboid_frame" => frame(vector::<3>(a, 0) * 0.5, n(1)),
        _ => {
            return revolved::definition(name, a)
                .or_else(|| slab::definition(name, a))
                .or_else(|| tube::definition(name, a))
                .or_else(|| power::spatial(name, a));
        }
    })
}
