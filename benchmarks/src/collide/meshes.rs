// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes that dip into a field: which of their elements touch it.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;

use palpate::field::{Point, Pose, Rotation, Shape, Vector};
use palpate::mesh::{Mesh, Outline, TriangleMesh};
use palpate::query::{Limits, MeshWorkspace, PlacedMesh, mesh_hits};

use super::{TimedRows, fastest};
use crate::random::Random;
use crate::scenes;

/// Poses of each mesh.
const POSES: usize = 40;

/// The radius of spheres and circles [m].
pub(super) const RADIUS: f64 = 0.3;

/// How deep they dip into the field [m].
const OVERLAP: [f64; 2] = [0.005, 0.025];

/// Up to which clearance a touch is looked for [m].
const TOLERANCE: f64 = 3e-7;

/// Adds the rows of meshes and outlines.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let works = scenes::spatial()?;
    let s3 = works.iter().find(|work| work.name == "S3").ok_or("no S3")?;
    for (name, mesh) in [("888", sphere(37, 13)?), ("100k", sphere(317, 160)?)] {
        let poses = poses(&s3.shape, s3.half, spatial_turn)?;
        measure_one(&format!("mesh.hits_{name}.S3"), &s3.shape, &mesh, &poses, rows)?;
    }
    let works = scenes::planar()?;
    let p3 = works.iter().find(|work| work.name == "P3").ok_or("no P3")?;
    for (name, segments) in [("888", 888), ("100k", 100_806)] {
        let poses = poses(&p3.shape, p3.half, planar_turn)?;
        let key = format!("outline.hits_{name}.P3");
        measure_one(&key, &p3.shape, &circle(segments)?, &poses, rows)?;
    }
    Ok(())
}

fn measure_one<const N: usize, const D: usize>(
    key: &str,
    shape: &Shape<D>,
    mesh: &Mesh<N, D>,
    poses: &[Pose<D>],
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error>> {
    let limits = Limits::new(TOLERANCE);
    let mut workspace = MeshWorkspace::new();
    let mut times = Vec::new();
    let (mut evaluations, mut undecided, mut hits) = (0, 0, 0);
    for pose in poses {
        let placed = PlacedMesh::new(mesh, *pose);
        let answer = mesh_hits(shape, placed, 0.0, &limits, &mut workspace)?;
        evaluations += answer.evaluations;
        undecided += answer.undecided.len();
        hits += answer.hits.len();
        times.push(fastest(|| {
            // That it is no error was seen above.
            let _ =
                black_box(mesh_hits(shape, black_box(placed), 0.0, &limits, &mut workspace));
        }));
    }
    rows.add_times(key, times);
    let count = poses.len() as f64;
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / count);
    rows.insert(format!("{key}.undecided"), undecided as f64);
    rows.insert(format!("{key}.hits"), hits as f64 / count);
    Ok(())
}

/// Poses at which a ball dips into the shape: points of a cube moved along the
/// gradient to where the value is the radius less an overlap, and turned at random.
fn poses<const D: usize>(
    shape: &Shape<D>,
    half: f64,
    turn: fn(&mut Random) -> Result<Rotation<D>, Box<dyn Error>>,
) -> Result<Vec<Pose<D>>, Box<dyn Error>> {
    let mut random = Random::new(7);
    let mut poses = Vec::with_capacity(POSES);
    while poses.len() < POSES {
        let mut centre: Point<D> = Vector(random.point([0.0; D], half));
        let value_there = RADIUS - random.between(OVERLAP[0], OVERLAP[1]);
        for _ in 0..32 {
            let (value, gradient) = shape.distance_gradient(centre);
            let steepness = gradient.dot(gradient).max(1e-9);
            centre -= gradient * ((value - value_there) / steepness);
        }
        if (shape.distance(centre) - value_there).abs() < 1e-9 {
            poses.push(Pose::new(turn(&mut random)?, centre));
        }
    }
    Ok(poses)
}

fn spatial_turn(random: &mut Random) -> Result<Rotation<3>, Box<dyn Error>> {
    Ok(Rotation::from_quaternion(random.point([0.0; 4], 1.0))?)
}

fn planar_turn(random: &mut Random) -> Result<Rotation<2>, Box<dyn Error>> {
    Ok(Rotation::from_angle(random.between(-PI, PI))?)
}

/// A sphere of meridians and parallels.
pub(super) fn sphere(meridians: u32, rings: u32) -> Result<TriangleMesh, Box<dyn Error>> {
    let mut vertices = vec![Vector([0.0, RADIUS, 0.0]), Vector([0.0, -RADIUS, 0.0])];
    for ring in 1..rings {
        let (height, width) = (f64::from(ring) / f64::from(rings) * PI).sin_cos();
        for meridian in 0..meridians {
            let (sin, cos) = (f64::from(meridian) / f64::from(meridians) * TAU).sin_cos();
            vertices.push(Vector([height * cos, width, height * sin]) * RADIUS);
        }
    }
    let at = |ring: u32, meridian: u32| 2 + (ring - 1) * meridians + meridian % meridians;
    let mut triangles = Vec::new();
    for k in 0..meridians {
        triangles.push([0, at(1, k + 1), at(1, k)]);
        triangles.push([1, at(rings - 1, k), at(rings - 1, k + 1)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, k), at(ring, k + 1)];
            let [c, d] = [at(ring + 1, k), at(ring + 1, k + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

fn circle(segments: u32) -> Result<Outline, Box<dyn Error>> {
    let at = |i: u32| {
        let (sin, cos) = (f64::from(i) / f64::from(segments) * TAU).sin_cos();
        Vector([RADIUS * cos, RADIUS * sin])
    };
    let elements = (0..segments).map(|i| [i, (i + 1) % segments]).collect();
    Ok(Outline::new((0..segments).map(at).collect(), elements)?)
}
