// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of tubes about curves in the plane of x and z.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::from_segment;
use super::{Definition, Patch, number};

/// The point of a circle at an angle from +z towards +x, and the direction out of it.
fn on_circle(angle: f64) -> Point<3> {
    Vector([angle.sin(), 0.0, angle.cos()])
}

/// The tube of radius `r` about an arc, from one angle to another.
fn tube(centre: Point<3>, ring: f64, r: f64, [from, to]: [f64; 2]) -> Patch<3> {
    Patch::surface([(ring + r) * (to - from), TAU * r], move |u, v| {
        let out = on_circle(from + (to - from) * u);
        let (sin, cos) = (TAU * v).sin_cos();
        centre + out * (ring + r * cos) + Vector::unit(1) * (r * sin)
    })
}

/// The distance from an arc, by its nearest angle.
fn from_arc(centre: Point<3>, ring: f64, half: f64, p: Point<3>) -> f64 {
    let q = p - centre;
    let angle = q[0].atan2(q[2]).clamp(-half, half);
    (q - on_circle(angle) * ring).norm()
}

fn capped_torus(ring: f64, r: f64, angle: f64) -> Definition<3> {
    let half = 0.5 * angle;
    let mut boundary = vec![tube(Vector::ZERO, ring, r, [-half, half])];
    for side in [1.0, -1.0] {
        let end = on_circle(side * half);
        let onwards = on_circle(side * (half + FRAC_PI_2));
        if angle < TAU {
            boundary.push(Patch::surface([FRAC_PI_2 * r, TAU * r], move |u, v| {
                let (sin, cos) = (TAU * v).sin_cos();
                let flat = end * cos + Vector::unit(1) * sin;
                let (up, across) = (FRAC_PI_2 * u).sin_cos();
                end * ring + flat * (r * across) + onwards * (r * up)
            }));
        }
    }
    let gap = 2.0 * ring * half.sin();
    let overlaps_itself = r > ring || (half > FRAC_PI_2 && angle < TAU && gap < 2.0 * r);
    let definition =
        Definition::new(boundary, move |p| from_arc(Vector::ZERO, ring, half, p) < r);
    Definition { overlaps_itself, ..definition }
}

fn link(ring: f64, r: f64, length: f64) -> Definition<3> {
    let bow = Vector([0.0, 0.0, 0.5 * length]);
    let mut boundary = vec![
        tube(bow, ring, r, [-FRAC_PI_2, FRAC_PI_2]),
        tube(-bow, ring, r, [FRAC_PI_2, 3.0 * FRAC_PI_2]),
    ];
    let side = Vector([ring, 0.0, 0.0]);
    for middle in [side, -side] {
        boundary.push(Patch::surface([length, TAU * r], move |u, v| {
            let (sin, cos) = (TAU * v).sin_cos();
            middle + bow * (2.0 * u - 1.0) + Vector([r * cos, r * sin, 0.0])
        }));
    }
    Definition::new(boundary, move |p| {
        let turned = Vector([p[0], p[1], -p[2]]);
        let sides = [side, -side].map(|s| from_segment(s - bow, s + bow, p));
        let bows = [p, turned].map(|q| from_arc(bow, ring, 0.5 * PI, q));
        sides.into_iter().chain(bows).fold(f64::INFINITY, f64::min) < r
    })
}

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<3>> {
    let n = |i: usize| number(a, i);
    match name {
        "capped_torus" => Some(capped_torus(n(0), n(1), n(2))),
        "link" => Some(link(n(0), n(1), n(2))),
        _ => None,
    }
}
