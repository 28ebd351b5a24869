// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where meshes and grids are asked.

use palpate::field::{Point, Vector};
use palpate::mesh::TriangleMesh;

use super::QUESTIONS;
use crate::random::Random;

/// Half the side of the box about the origin [m].
const HALF: f64 = 0.7;

/// How far off the surface points are near it, and where they touch [m].
const NEAR: [f64; 2] = [1e-4, 5e-2];
const TOUCHING: [f64; 2] = [1e-7, 1e-4];

/// A step of a hand's path [m], and its height over the surface's corners [m].
const STEP: f64 = 1e-4;
const HEIGHT: f64 = 2e-3;

/// Points by the names of their rows.
pub(super) fn places(mesh: &TriangleMesh) -> [(&'static str, Vec<Point<3>>); 4] {
    let mut random = Random::new(7);
    let near = off(mesh, &mut random, QUESTIONS, NEAR);
    let touching = off(mesh, &mut random, QUESTIONS, TOUCHING);
    let anywhere = (0..QUESTIONS).map(|_| Vector(random.point([0.0; 3], HALF))).collect();
    [("near", near), ("box", anywhere), ("touching", touching), ("path", path())]
}

/// Points near the surface.
pub(super) fn near(mesh: &TriangleMesh, count: usize) -> Vec<Point<3>> {
    off(mesh, &mut Random::new(11), count, NEAR)
}

/// Points off random triangles, on both sides, by distances that are uniform in their logarithm.
fn off(
    mesh: &TriangleMesh,
    random: &mut Random,
    count: usize,
    [least, most]: [f64; 2],
) -> Vec<Point<3>> {
    let faces = mesh.elements().len();
    let mut point = || {
        let [a, b, c] = mesh.corners(random.between(0.0, faces as f64) as usize);
        let (u, v) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let normal = (b - a).cross(c - a).normalized().unwrap_or(Vector::unit(0));
        let far = random.between(least.ln(), most.ln()).exp();
        let side = if random.between(0.0, 1.0) < 0.5 { -far } else { far };
        a + (b - a) * u + (c - a) * v + normal * side
    };
    (0..count).map(|_| point()).collect()
}

/// A hand that goes round at the height of the bumps.
fn path() -> Vec<Point<3>> {
    let radius = 0.5 + HEIGHT;
    (0..QUESTIONS)
        .map(|step| {
            let angle = step as f64 * STEP / radius;
            let (across, along) = angle.sin_cos();
            Vector([along, across * 0.8, across * 0.6]) * radius
        })
        .collect()
}
