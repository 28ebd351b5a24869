// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Balls, triangles, meshes and bodies that move: when they touch first.

use std::error::Error;
use std::hint::black_box;

use palpate::field::{Pose, Screw, Shape, Vector};
use palpate::mesh::{Solid, TriangleMesh};
use palpate::query::{
    BallWorkspace, Element, ElementSweep, Limits, Motion, Moving, Placed, Ray, SweepSettings,
    SweepWorkspace, cast_ball, sweep, sweep_element, sweep_mesh,
};

use super::pairs::placed;
use super::triangles::SIZES;
use super::{Space, TimedRows, Turn, fastest, meshes, peers};
use crate::random::Random;
use crate::scenes::{self, Work};

/// Paths of each kind.
const COUNT: usize = 400;

/// The length of a path, and the radius of the ball on it [m].
const LENGTH: f64 = 1.0;
const RADIUS: f64 = 0.05;

/// Bounds are together, and bodies touch, at this [m].
const TOLERANCE: f64 = 1e-6;

/// The clearances in the middle of paths that graze [m].
const GRAZING: [f64; 4] = [1e-3, 1e-5, -1e-5, -1e-3];

/// Triangles that move, of each size.
const TRIANGLES: usize = 200;

/// Pairs that move.
const PAIRS: usize = 40;

/// Adds the rows of balls, and of S3 against itself.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let spatial = scenes::spatial()?;
    for work in &spatial {
        let Work { name, shape, .. } = work;
        cast(&format!("sweep.ball.{name}.random"), shape, &random_paths(shape)?, rows)?;
        cast(&format!("sweep.ball.{name}.grazing"), shape, &grazing_paths(shape)?, rows)?;
        for size in SIZES {
            triangles(&format!("sweep.triangle.{name}.{size}"), shape, size, rows)?;
        }
    }
    let found = spatial.iter().find(|work| work.name == "S3");
    let Work { shape, .. } = found.ok_or("no S3")?;
    mesh("sweep.mesh_888.S3", shape, rows)?;
    peers::measure_casts(rows)?;
    pairs("sweep.pair.S3_S3", shape, rows)?;
    beside_flat_sides(rows)
}

/// Bodies that go by at 1 mm over flat sides that are meshes, each over the time of the same motion of cuboids.
fn beside_flat_sides(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let ball = Shape::ball(0.1)?;
    let [floor, cube] = [[4.0, 0.2, 4.0], [1.0; 3]];
    let [mesh_floor, mesh_cube] = [of_triangles(floor)?, of_triangles(cube)?];
    let [floor, cube] = [Shape::cuboid(floor)?, Shape::cuboid(cube)?];
    let over =
        |far: f64, height: f64| [-far, far].map(|x| Pose::<3>::translation([x, height, 0.0]));
    let way = over(3.0, 0.201);
    let times = [(&mesh_floor, &ball), (&floor, &ball)].map(|pair| passing(pair, way));
    let [(time, undecided), (of_cuboid, _)] = both(times)?;
    rows.insert("sweep.mesh_floor.ball.over_cuboid".into(), time / of_cuboid);
    rows.insert("sweep.mesh_floor.ball.undecided".into(), undecided);
    let way = over(4.0, 1.001);
    let times = [(&mesh_cube, &mesh_cube), (&cube, &cube)].map(|pair| passing(pair, way));
    let [(time, undecided), (of_cuboids, _)] = both(times)?;
    rows.insert("sweep.mesh_cubes.1mm.over_cuboids".into(), time / of_cuboids);
    rows.insert("sweep.mesh_cubes.1mm.undecided".into(), undecided);
    Ok(())
}

/// Both answers, or the first error.
fn both<T>([a, b]: [Result<T, Box<dyn Error>>; 2]) -> Result<[T; 2], Box<dyn Error>> {
    Ok([a?, b?])
}

/// The time of a sweep [ns], and 1 if it is undecided.
fn passing(
    (still, moving): (&Shape<3>, &Shape<3>),
    [from, to]: [Pose<3>; 2],
) -> Result<(f64, f64), Box<dyn Error>> {
    let settings = SweepSettings::of_size(1.0);
    let moving = Moving::new(moving, Screw::new(from, to, 0)?);
    let mut workspace = SweepWorkspace::new();
    let answer = sweep(still, moving, &settings, &mut workspace)?;
    let time = fastest(|| {
        let _ = black_box(sweep(still, black_box(moving), &settings, &mut workspace));
    });
    Ok((time, f64::from(u32::from(answer.touches().is_none()))))
}

/// A box with these edges [m], of 12 triangles.
fn of_triangles(size: [f64; 3]) -> Result<Shape<3>, Box<dyn Error>> {
    let corners = (0..8_u32)
        .map(|i| Vector(std::array::from_fn(|k| size[k] * (f64::from(i >> k & 1) - 0.5))));
    // Each as counter-clockwise corners, seen from outside.
    let sides =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let mesh = TriangleMesh::new(corners.collect(), faces.collect())?;
    let (solid, _) = Solid::from_mesh(&mesh)?;
    Ok(solid.into())
}

fn cast(
    key: &str,
    shape: &Shape<3>,
    paths: &[Ray<3>],
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error>> {
    let limits = Limits::new(TOLERANCE);
    let mut workspace = BallWorkspace::new();
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    for path in paths {
        let answer = cast_ball(shape, path, RADIUS, &limits, &mut workspace)?;
        evaluations += answer.evaluations;
        undecided += u32::from(answer.stop.is_early());
        times.push(fastest(|| {
            let _ =
                black_box(cast_ball(shape, black_box(path), RADIUS, &limits, &mut workspace));
        }));
    }
    rows.add_times(key, times);
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / paths.len() as f64);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    Ok(())
}

/// Paths from anywhere to anywhere, which begin free.
fn random_paths(shape: &Shape<3>) -> Result<Vec<Ray<3>>, Box<dyn Error>> {
    let mut random = Random::new(11);
    let mut paths = Vec::with_capacity(COUNT);
    while paths.len() < COUNT {
        let start = Vector(random.point([0.0; 3], 1.0));
        let way = Vector(random.point([0.0; 3], 1.0));
        if shape.distance(start) > RADIUS {
            paths.push(Ray::new(start, way, LENGTH)?);
        }
    }
    Ok(paths)
}

/// Paths along the surface, with a clearance in their middle.
fn grazing_paths(shape: &Shape<3>) -> Result<Vec<Ray<3>>, Box<dyn Error>> {
    let mut random = Random::new(12);
    let mut paths = Vec::with_capacity(COUNT);
    while paths.len() < COUNT {
        let clearance = GRAZING[paths.len() % GRAZING.len()];
        let start = Vector(random.point([0.0; 3], 1.0));
        let (distance, gradient) = shape.distance_gradient(start);
        let height = RADIUS + clearance;
        let middle =
            start - gradient * ((distance - height) / gradient.dot(gradient).max(1e-9));
        let (distance, gradient) = shape.distance_gradient(middle);
        let side = Vector(random.point([0.0; 3], 1.0));
        let along = side.cross(gradient);
        if (distance - height).abs() > 1e-9 || along.norm() < 1e-3 {
            continue;
        }
        let from = middle - along * (0.5 * LENGTH / along.norm());
        if shape.distance(from) > RADIUS {
            paths.push(Ray::new(from, along, LENGTH)?);
        }
    }
    Ok(paths)
}

/// Triangles that begin free, move by a metre and turn by up to 1.5 rad, any way.
fn triangles(
    key: &str,
    shape: &Shape<3>,
    size: f64,
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error>> {
    let mut random = Random::new(14);
    let settings =
        SweepSettings { gap: 1e-4, time_tolerance: 1e-3, ..SweepSettings::of_size(1.0) };
    let mut workspace = ElementSweep::new();
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    while times.len() < TRIANGLES {
        let corners = [(); 3].map(|()| Vector(random.point([0.0; 3], size)));
        let element = Element::new(corners)?;
        let from = Pose::translation(Vector(random.point([0.0; 3], 1.0)));
        let way = Vector(random.point([0.0; 3], 1.0));
        let turn = <Space as Turn<3>>::by(&mut random, 1.5)?;
        let to = from * Pose::new(turn, way * (LENGTH / way.norm()));
        let there = from.transform_point(element.at(&[1.0 / 3.0; 3]));
        if shape.distance(there) <= size {
            continue;
        }
        let motion = Motion::from(Screw::new(from, to, 0)?);
        let answer = sweep_element(shape, &element, motion, &settings, &mut workspace)?;
        evaluations += answer.evaluations;
        undecided += u32::from(answer.stop.is_early());
        times.push(fastest(|| {
            let motion = black_box(motion);
            let _ =
                black_box(sweep_element(shape, &element, motion, &settings, &mut workspace));
        }));
    }
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / times.len() as f64);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    rows.add_times(key, times);
    Ok(())
}

/// A sphere of 888 triangles that begins free, moves by a metre and turns by up to 1.5 rad, any way.
fn mesh(key: &str, shape: &Shape<3>, rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let mut random = Random::new(16);
    let settings =
        SweepSettings { gap: 1e-4, time_tolerance: 1e-3, ..SweepSettings::of_size(1.0) };
    let sphere = meshes::sphere(37, 13)?;
    let mut workspace = ElementSweep::new();
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    while times.len() < PAIRS {
        let from = Pose::translation(Vector(random.point([0.0; 3], 1.2)));
        let way = Vector(random.point([0.0; 3], 1.0));
        let turn = <Space as Turn<3>>::by(&mut random, 1.5)?;
        let to = from * Pose::new(turn, way * (LENGTH / way.norm()));
        if shape.distance(from.translation) <= meshes::RADIUS {
            continue;
        }
        let motion = Motion::from(Screw::new(from, to, 0)?);
        let answer = sweep_mesh(shape, &sphere, motion, &settings, &mut workspace)?;
        evaluations += answer.evaluations;
        undecided += u32::from(answer.stop.is_early());
        times.push(fastest(|| {
            let motion = black_box(motion);
            let _ = black_box(sweep_mesh(shape, &sphere, motion, &settings, &mut workspace));
        }));
    }
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / times.len() as f64);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    rows.add_times(key, times);
    Ok(())
}

/// Bodies 50 mm apart, of which one moves by 0.3 m and turns by a radian, any way.
fn pairs(key: &str, shape: &Shape<3>, rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let mut random = Random::new(13);
    let settings =
        SweepSettings { gap: 1e-4, time_tolerance: 1e-3, ..SweepSettings::of_size(1.0) };
    let mut workspace = SweepWorkspace::new();
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    let placed = placed([shape, shape], 0.05)?;
    for [a, b] in placed.iter().take(PAIRS) {
        let from = b.world_from_body;
        let way = Vector(random.point([0.0; 3], 1.0));
        let turn = <Space as Turn<3>>::by(&mut random, 1.0)?;
        let to = from * Pose::new(turn, way * (0.3 / way.norm()));
        let Placed { shape, .. } = *b;
        let moving = Moving::new(shape, Screw::new(from, to, 0)?);
        let answer = sweep(*a, moving, &settings, &mut workspace)?;
        evaluations += answer.evaluations;
        undecided += u32::from(answer.touches().is_none());
        times.push(fastest(|| {
            let _ = black_box(sweep(*a, black_box(moving), &settings, &mut workspace));
        }));
    }
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / times.len() as f64);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    rows.add_times(key, times);
    Ok(())
}
