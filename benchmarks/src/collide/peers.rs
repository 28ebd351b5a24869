// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A ball on a torus, as parry asks it of a mesh and we of a field.

use std::error::Error;
use std::hint::black_box;

use palpate::field::kernel::{Ball, Torus};
use palpate::field::{Shape, Vector};
use palpate::query::{BallWorkspace, Limits, Ray, cast_ball, contact_ball};
use parry3d_f64::math::Pose;
use parry3d_f64::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, ShapeCastOptions,
    cast_shapes,
};
use parry3d_f64::shape::{Ball as ParryBall, TriMesh};

use super::{TimedRows, fastest, pairs};
use crate::fields::Rows;
use crate::random::Random;

/// The radii of the torus and of the ball [m].
const TORUS: [f64; 2] = [0.35, 0.15];
const BALL: f64 = 0.25;

/// How deep the ball is [m].
const DEPTH: f64 = 0.005;

/// Corners of the mesh along the ring and around the tube: 6000 triangles.
const CORNERS: [u32; 2] = [75, 40];

/// Lines on which a ball of this radius moves towards the torus [m].
const LINES: usize = 200;
const CAST: f64 = 0.05;

/// How far a touch is from another of the same line at most: that of the mesh from its torus [m].
const COARSE: f64 = 5e-3;

/// Adds the rows of a ball that moves towards the torus, ours and parry's.
pub(super) fn measure_casts(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let torus = Shape::from_kernel(Torus::new(TORUS[0], TORUS[1])?);
    let (mesh, ball) = (mesh()?, ParryBall::new(CAST));
    let mut random = Random::new(15);
    let limits = Limits::new(1e-6);
    let mut workspace = BallWorkspace::new();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    while ours.len() < LINES {
        let start = Vector(random.point([0.0; 3], 1.0));
        let to = Vector(random.point([0.0; 3], 0.4));
        let way = to - start;
        if torus.distance(start) <= 2.0 * CAST {
            continue;
        }
        let line = Ray::new(start, way, 2.0)?;
        let found = cast_ball(&torus, &line, CAST, &limits, &mut workspace)?;
        if found.best.is_none() {
            continue;
        }
        ours.push(fastest(|| {
            let line = black_box(&line);
            let _ = black_box(cast_ball(&torus, line, CAST, &limits, &mut workspace));
        }));
        let [x, y, z] = start.0;
        let there = Pose::translation(x, y, z);
        let along = parry3d_f64::math::Vector::from_array(line.direction().0);
        let still = parry3d_f64::math::Vector::from_array([0.0; 3]);
        let cast = || {
            let options = ShapeCastOptions::with_max_time_of_impact(2.0);
            cast_shapes(&Pose::IDENTITY, still, &mesh, &there, along, &ball, options)
        };
        let hit = cast()?.ok_or("parry found no touch")?;
        // Grazing the mesh is another line than grazing the torus.
        if (hit.time_of_impact - found.upper).abs() > COARSE {
            ours.pop();
            continue;
        }
        theirs.push(fastest(|| {
            let _ = black_box(cast());
        }));
    }
    rows.add_times("sweep.ball.torus", ours);
    rows.add_times("parry.sweep.ball_torus", theirs);
    Ok(())
}

/// Adds the rows of the ball on the torus, ours and parry's.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let torus = Shape::from_kernel(Torus::new(TORUS[0], TORUS[1])?);
    let (of_ball, mesh) = (Shape::from_kernel(Ball::new(BALL)?), mesh()?);
    let poses = pairs::placed([&torus, &of_ball], -DEPTH)?;
    let limits = Limits::new(1e-4);
    let mut workspace = BallWorkspace::new();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let mut missed = 0;
    for [_, there] in &poses {
        let centre = there.world_from_body.translation;
        let found = contact_ball(&torus, centre, BALL, &limits, &mut workspace)?;
        missed += u32::from(found.best.is_none_or(|contact| contact.gap > 0.0));
        ours.push(fastest(|| {
            // That it is no error was seen above.
            let _ = black_box(contact_ball(
                &torus,
                black_box(centre),
                BALL,
                &limits,
                &mut workspace,
            ));
        }));
        let [x, y, z] = centre.0;
        let there = Pose::translation(x, y, z);
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let mut memory = None;
        theirs.push(fastest(|| {
            let asked = DefaultQueryDispatcher.contact_manifolds(
                black_box(&there),
                &mesh,
                &ParryBall::new(BALL),
                0.0,
                &mut manifolds,
                &mut memory,
            );
            let _ = black_box(asked);
        }));
        missed += u32::from(manifolds.iter().all(|manifold| manifold.points.is_empty()));
    }
    if missed > 0 {
        return Err(format!("{missed} contacts of a ball and a torus were not found").into());
    }
    rows.add_times("ball.torus", ours);
    rows.add_times("parry.ball_torus.manifold", theirs);
    Ok(())
}

/// Adds the ratios of the medians, where both are measured.
pub(super) fn compare(rows: &mut Rows) {
    for [ours, theirs] in [
        ["ball.torus", "parry.ball_torus.manifold"],
        ["sweep.ball.torus", "parry.sweep.ball_torus"],
    ] {
        let median = |key: &str| rows.get(&format!("{key}.p50_ns")).copied();
        if let Some((of_ours, of_theirs)) = median(ours).zip(median(theirs)) {
            rows.insert(format!("{theirs}.ours_over_parry"), of_ours / of_theirs);
        }
    }
}

/// The torus about the y axis as triangles, seen from outside counter-clockwise.
fn mesh() -> Result<TriMesh, Box<dyn Error>> {
    let [along, around] = CORNERS;
    let angle = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i % n) / f64::from(n);
    let mut points = Vec::new();
    for i in 0..along {
        for k in 0..around {
            let (ring, tube) = (angle(i, along), angle(k, around));
            let radius = TORUS[0] + TORUS[1] * tube.cos();
            let p = Vector([radius * ring.cos(), TORUS[1] * tube.sin(), radius * ring.sin()]);
            points.push(parry3d_f64::math::Vector::from_array(p.0));
        }
    }
    let corner = |i: u32, k: u32| (i % along) * around + k % around;
    let mut triangles = Vec::new();
    for i in 0..along {
        for k in 0..around {
            let [a, b, c, d] =
                [corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Ok(TriMesh::new(points, triangles)?)
}
