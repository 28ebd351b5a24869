// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of the primitives of the plane.

use std::f64::consts::{PI, TAU};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::power::{norm, on_ball, speed};
use super::{Definition, Patch, number, points, vector};

/// How far test points and the sampled part of unbounded shapes reach [m].
pub(super) const FAR: f64 = 16.0;

pub(super) const AXES: [Point<2>; 2] = [Vector([1.0, 0.0]), Vector([0.0, 1.0])];

pub(super) fn arc(centre: [f64; 2], radius: f64, angles: [f64; 2]) -> Patch<2> {
    Patch::arc(Vector(centre), AXES, radius, angles)
}

/// The edges of a closed polygon.
pub(super) fn edges(corners: &[Point<2>]) -> Vec<Patch<2>> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| Patch::segment(*a, *b)).collect()
}

/// `true` if `p` is inside by the even-odd rule, along a ray in a direction that no edge in the
/// tests has.
pub(super) fn even_odd(rings: &[Vec<Point<2>>], p: Point<2>) -> bool {
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
pub(super) fn corners(count: f64, radii: &[f64]) -> Vec<Point<2>> {
    let count = count as usize * radii.len();
    (0..count)
        .map(|i| {
            let angle = TAU * i as f64 / count as f64;
            Vector([angle.sin(), angle.cos()]) * radii[i % radii.len()]
        })
        .collect()
}

pub(super) fn polygon(rings: Vec<Vec<Point<2>>>) -> Definition<2> {
    let boundary = rings.iter().flat_map(|ring| edges(ring)).collect();
    Definition::new(boundary, move |p| even_odd(&rings, p))
}

/// All points within `radius` of a segment.
fn stadium(a: Point<2>, b: Point<2>, radius: f64) -> Definition<2> {
    let along = (b - a).normalized().unwrap_or(AXES[0]);
    let across = Vector([-along[1], along[0]]);
    let caps = [(b, [along, across]), (a, [-along, -across])];
    let sides = [across * radius, across * -radius];
    let mut boundary: Vec<_> = sides.map(|s| Patch::segment(a + s, b + s)).into();
    boundary
        .extend(caps.map(|(end, axes)| Patch::arc(end, axes, radius, [-0.5 * PI, 0.5 * PI])));
    Definition::new(boundary, move |p| from_segment(a, b, p) < radius)
}

/// The distance to a segment: that to its nearest point, by clamping.
pub(super) fn from_segment<const D: usize>(a: Point<D>, b: Point<D>, p: Point<D>) -> f64 {
    let along = b - a;
    let square = along.dot(along);
    let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + along * t)).norm()
}

/// The profile of a box with corners rounded in the norm of an exponent.
pub(super) fn rounded_rectangle(half: Point<2>, r: f64, exponent: f64) -> Vec<Patch<2>> {
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
pub(super) fn in_rounded_box<const D: usize>(
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

/// The fourteen strokes of the Cool S, two units high, as drawn on paper: three lines above,
/// three below, each joined to the next, and roofs.
fn cool_s(height: f64) -> Definition<2> {
    let at = |x: f64, y: f64| Vector([x, y]) * (0.5 * height);
    let columns = [-0.4, 0.0, 0.4];
    let mut strokes = Vec::new();
    for x in columns {
        strokes.push((at(x, 0.2), at(x, 0.6)));
        strokes.push((at(x, -0.2), at(x, -0.6)));
    }
    for side in [1.0, -1.0] {
        for x in [-0.4, 0.4] {
            strokes.push((at(x, 0.6 * side), at(0.0, side)));
        }
    }
    strokes.push((at(-0.4, 0.2), at(0.0, -0.2)));
    strokes.push((at(0.0, 0.2), at(0.4, -0.2)));
    // The visible parts of the two strokes that pass behind.
    strokes.push((at(0.4, 0.2), at(0.2, 0.0)));
    strokes.push((at(-0.4, -0.2), at(-0.2, 0.0)));
    let outline = [
        (0.0, 1.0),
        (0.4, 0.6),
        (0.4, 0.2),
        (0.2, 0.0),
        (0.4, -0.2),
        (0.4, -0.6),
        (0.0, -1.0),
        (-0.4, -0.6),
        (-0.4, -0.2),
        (-0.2, 0.0),
        (-0.4, 0.2),
        (-0.4, 0.6),
    ];
    let outline = vec![outline.map(|(x, y)| at(x, y)).to_vec()];
    let boundary = strokes.into_iter().map(|(a, b)| Patch::segment(a, b)).collect();
    Definition::new(boundary, move |p| even_odd(&outline, p))
}

/// All points within `r` of an arc. Where the tube meets itself, parts of these pieces lie
/// inside.
fn tube(ring: f64, angle: f64, r: f64) -> Definition<2> {
    let half = 0.5 * angle;
    // Angles here are from +x, those of the arc from +y.
    let span = [0.5 * PI - half, 0.5 * PI + half];
    let ends = span.map(|a| [ring * a.cos(), ring * a.sin()]);
    let mut boundary = Vec::new();
    for radius in [ring - r, ring + r] {
        boundary.push(arc([0.0; 2], radius.abs(), span));
    }
    if angle < TAU {
        for (end, from) in ends.into_iter().zip([span[0] - PI, span[1]]) {
            boundary.push(arc(end, r, [from, from + PI]));
        }
    }
    let gap = 2.0 * ring * half.sin();
    let overlaps_itself = r > ring || (half > 0.5 * PI && angle < TAU && gap < 2.0 * r);
    let tube = Definition::new(boundary, move |p: Point<2>| {
        let turned = p[0].abs().atan2(p[1]);
        let on_arc = Vector([half.sin(), half.cos()]) * ring;
        let from_arc = if turned <= half {
            (p.norm() - ring).abs()
        } else {
            (Vector([p[0].abs(), p[1]]) - on_arc).norm()
        };
        from_arc < r
    });
    Definition { overlaps_itself, ..tube }
}

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<2>> {
    let n = |i: usize| number(a, i);
    Some(match name {
        "ball" => {
            let r = n(0);
            Definition::new(vec![arc([0.0; 2], r, [0.0, TAU])], move |p| p.norm() < r)
        }
        "cuboid" | "rounded_cuboid" => {
            let half = vector::<2>(a, 0) * 0.5;
            let r = if name == "cuboid" { 0.0 } else { n(1) };
            Definition::new(rounded_rectangle(half, r, 2.0), move |p| {
                in_rounded_box(half, r, 2.0, p)
            })
        }
        "capsule" => {
            let end = Vector([0.0, 0.5 * n(1) - n(0)]);
            stadium(-end, end, n(0))
        }
        "segment" => stadium(vector(a, 0), vector(a, 1), n(2)),
        "half_space" => {
            let normal = vector::<2>(a, 0).normalized()?;
            let offset = n(1);
            let along = Vector([-normal[1], normal[0]]) * FAR;
            let foot = normal * offset;
            let line = Patch::segment(foot - along, foot + along);
            Definition::new(vec![line], move |p| p.dot(normal) < offset)
        }
        "triangle" => polygon(vec![points(a, 0)]),
        "ellipse" => {
            let r = vector::<2>(a, 0);
            let curve = Patch::curve(TAU * r[0].max(r[1]), move |t| {
                Vector([r[0] * (TAU * t).cos(), r[1] * (TAU * t).sin()])
            });
            Definition::new(vec![curve], move |p| (p[0] / r[0]).hypot(p[1] / r[1]) < 1.0)
        }
        "ring" => {
            let (inner, outer) = (n(0), n(1));
            let circles = [inner, outer].map(|r| arc([0.0; 2], r, [0.0, TAU]));
            let between = move |p: Point<2>| inner < p.norm() && p.norm() < outer;
            Definition::new(circles.into(), between)
        }
        "arc" => tube(n(0), n(1), n(2)),
        "regular_polygon" => polygon(vec![corners(n(0), &[n(1)])]),
        "regular_star" => polygon(vec![corners(n(0), &[n(1), n(2)])]),
        "polygon" => match &a[0] {
            Argument::Rings(rings) => polygon(
                rings
                    .iter()
                    .map(|ring| ring.iter().map(|p| super::point(p)).collect())
                    .collect(),
            ),
            _ => return None,
        },
        "cool_s" => cool_s(n(0)),
        _ => {
            return super::outlines::definition(name, a)
                .or_else(|| super::curves::definition(name, a))
                .or_else(|| super::power::planar(name, a));
        }
    })
}
