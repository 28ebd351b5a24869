// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of solids of revolution, about the y axis and between two points.

use std::f64::consts::{FRAC_PI_2, PI};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::FAR;
use super::spatial::{capped_cone, cross, cylinder};
use super::{Definition, Patch, number, vector};

const AXES: [Point<2>; 2] = [Vector([1.0, 0.0]), Vector([0.0, 1.0])];

/// Pieces of the surface of a cone without a base, each half as long towards the tip.
const PIECES: i32 = 12;

/// Halvings of the range that holds the minimum of a convex function.
const STEPS: usize = 200;

/// Part of a circle about a centre on the y axis or beside it, in (ρ, y), between two
/// angles from +ρ.
fn arc(centre: [f64; 2], radius: f64, angles: [f64; 2]) -> Patch<2> {
    Patch::arc(Vector(centre), AXES, radius, angles)
}

fn line(from: [f64; 2], to: [f64; 2]) -> Patch<2> {
    Patch::segment(Vector(from), Vector(to))
}

/// A solid from its profile in (ρ, y), which reaches to `widest`.
fn turned(
    profile: Vec<Patch<2>>,
    widest: f64,
    contains: impl Fn(f64, f64) -> bool + 'static,
) -> Definition<3> {
    let boundary = profile.into_iter().map(|piece| piece.turned(widest)).collect();
    Definition::new(boundary, move |p| contains(p[0].hypot(p[2]), p[1]))
}

/// In pieces, each reaching twice as far out as the one before, so that samples near the tip
/// are dense.
fn infinite_cone(angle: f64) -> Definition<3> {
    let half = 0.5 * angle;
    let at = |along: f64| [along * half.sin(), -along * half.cos()];
    let piece = |k: i32| {
        let far = FAR * 0.5_f64.powi(k);
        let near = if k < PIECES { 0.5 * far } else { 0.0 };
        line(at(near), at(far)).turned(far * half.sin())
    };
    let boundary = (0..=PIECES).map(piece).collect();
    Definition::new(boundary, move |p: Point<3>| p[0].hypot(p[2]).atan2(-p[1]) < half)
}

fn solid_angle(radius: f64, angle: f64) -> Definition<3> {
    let half = 0.5 * angle;
    let rim = [radius * half.sin(), radius * half.cos()];
    let profile =
        vec![line([0.0; 2], rim), arc([0.0; 2], radius, [FRAC_PI_2 - half, FRAC_PI_2])];
    turned(profile, radius, move |rho, y| rho.hypot(y) < radius && rho.atan2(y) < half)
}

fn cut_ball(radius: f64, height: f64) -> Definition<3> {
    let rim = (height / radius).asin();
    let width = radius * rim.cos();
    let profile =
        vec![arc([0.0; 2], radius, [rim, FRAC_PI_2]), line([0.0, height], [width, height])];
    turned(profile, radius, move |rho, y| rho.hypot(y) < radius && y > height)
}

/// The middle of the wall and its rim, thickened.
fn bowl(radius: f64, height: f64, thickness: f64) -> Definition<3> {
    let (rim, half) = ((height / radius).asin(), 0.5 * thickness);
    let on_rim = [radius * rim.cos(), radius * rim.sin()];
    let profile = vec![
        arc([0.0; 2], radius - half, [-FRAC_PI_2, rim]),
        arc([0.0; 2], radius + half, [-FRAC_PI_2, rim]),
        arc(on_rim, half, [rim, rim + PI]),
    ];
    turned(profile, radius + half, move |rho, y| {
        let angle = y.atan2(rho).min(rim);
        (rho - radius * angle.cos()).hypot(y - radius * angle.sin()) < half
    })
}

fn death_star(radius: f64, cut_radius: f64, distance: f64) -> Definition<3> {
    // By the cosine rule, about either centre.
    let opposite =
        |a: f64, b: f64, c: f64| ((b - c).mul_add(b + c, a * a) / (2.0 * a * b)).acos();
    let rim = FRAC_PI_2 - opposite(distance, radius, cut_radius);
    let bite = opposite(distance, cut_radius, radius) - FRAC_PI_2;
    let profile = vec![
        arc([0.0; 2], radius, [-FRAC_PI_2, rim]),
        arc([0.0, distance], cut_radius, [-FRAC_PI_2, bite]),
    ];
    turned(profile, radius, move |rho, y| {
        rho.hypot(y) < radius && rho.hypot(y - distance) > cut_radius
    })
}

/// All balls between two, whose centre and radius are interpolated linearly.
fn round_cone(bottom: f64, top: f64, height: f64) -> Definition<3> {
    let low = -0.5 * height;
    let lean = ((bottom - top) / height).asin();
    let touch = |centre: f64, r: f64| [r * lean.cos(), centre + r * lean.sin()];
    let profile = vec![
        arc([0.0, low], bottom, [-FRAC_PI_2, lean]),
        arc([0.0, -low], top, [lean, FRAC_PI_2]),
        line(touch(low, bottom), touch(-low, top)),
    ];
    turned(profile, bottom.max(top), move |rho, y| {
        let out_of = |t: f64| rho.hypot(y - low - height * t) - bottom - (top - bottom) * t;
        let (mut from, mut to) = (0.0, 1.0);
        for _ in 0..STEPS {
            let third = (to - from) / 3.0;
            if out_of(from + third) < out_of(to - third) {
                to -= third;
            } else {
                from += third;
            }
        }
        out_of(from).min(out_of(0.0)).min(out_of(1.0)) < 0.0
    })
}

fn spindle(length: f64, width: f64) -> Definition<3> {
    let (h, w) = (0.5 * length, 0.5 * width);
    let centre = (h - w) * (h + w) / (2.0 * w);
    let radius = centre + w;
    let tip = h.atan2(centre);
    turned(vec![arc([-centre, 0.0], radius, [-tip, tip])], w, move |rho, y| {
        (rho + centre).hypot(y) < radius
    })
}

/// A solid about the y axis, moved so that its axis is the line between two points and its
/// origin is half-way.
fn between(from: Point<3>, to: Point<3>, solid: Definition<3>) -> Definition<3> {
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

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<3>> {
    let n = |i: usize| number(a, i);
    let ends = || {
        let (from, to) = (vector::<3>(a, 0), vector::<3>(a, 1));
        (from, to, (to - from).norm())
    };
    Some(match name {
        "infinite_cone" => infinite_cone(n(0)),
        "solid_angle" => solid_angle(n(0), n(1)),
        "cut_ball" => cut_ball(n(0), n(1)),
        "cut_hollow_sphere" => bowl(n(0), n(1), n(2)),
        "death_star" => death_star(n(0), n(1), n(2)),
        "round_cone" => round_cone(n(0), n(1), n(2)),
        "cylinder_between" => {
            let (from, to, length) = ends();
            between(from, to, cylinder(n(2), 0.5 * length))
        }
        "capped_cone_between" => {
            let (from, to, length) = ends();
            between(from, to, capped_cone(n(2), n(3), length))
        }
        "round_cone_between" => {
            let (from, to, length) = ends();
            between(from, to, round_cone(n(2), n(3), length))
        }
        "vesica_segment" => {
            let (from, to, length) = ends();
            between(from, to, spindle(length, n(2)))
        }
        _ => return None,
    })
}
