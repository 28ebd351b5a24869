// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A thousand bodies of which some move.

use std::error::Error;
use std::time::Instant;

use palpate::field::kernel::{Ball, Cuboid, Cylinder, Ring, RoundedCuboid, Torus};
use palpate::field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate::query::{
    BodyId, Limits, PairWorkspace, Placed, QueryError, Verdict, World, WorldSettings, overlap,
};

use super::{Space, TimedRows, Turn};
use crate::fields::Rows;
use crate::random::Random;

/// Bodies in a row, each touching the one before, and rows.
const IN_A_ROW: usize = 10;
const ROWS: usize = 100;

/// How far rows are apart [m]: boxes of bodies of neighbouring rows meet.
const APART: f64 = 1.1;

/// One body of so many moves in each step, by 1 mm and 1 mrad.
const MOVING: usize = 20;

/// Steps that are timed.
const STEPS: usize = 40;

/// Keys.
const SPATIAL: &str = "world.1000_bodies";
const PLANAR: &str = "world.1000_planar_bodies";

/// Adds the rows of worlds, on one thread.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let asked = one_thread.install(|| {
        steps(SPATIAL, &in_space()?, 10, rows)?;
        steps(PLANAR, &in_the_plane()?, ROWS, rows)
    });
    asked.map_err(|error| -> Box<dyn Error> { error })
}

/// Names the median of steps as that of the world, where it is measured.
pub(super) fn name_medians(rows: &mut Rows) {
    for key in [SPATIAL, PLANAR] {
        if let Some(median) = rows.get(&format!("{key}.step.p50_ns")).copied() {
            rows.insert(format!("{key}.step_ns"), median);
        }
    }
}

/// Rows along x, `side` of them in each other direction.
fn steps<const D: usize>(
    key: &str,
    shapes: &[Shape<D>],
    side: usize,
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error + Send + Sync>>
where
    Space: Turn<D>,
{
    let mut random = Random::new(7);
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    let mut bodies: Vec<(BodyId, Pose<D>)> = Vec::new();
    for row in 0..ROWS {
        let mut place = Vector::ZERO;
        for k in 1..D {
            place[k] = (row / side.pow(k as u32 - 1) % side) as f64 * APART;
        }
        let mut before: Option<(&Shape<D>, Pose<D>)> = None;
        for i in 0..IN_A_ROW {
            let shape = &shapes[(row + i) % shapes.len()];
            let turn = <Space as Turn<D>>::any(&mut random)?;
            if let Some((other, there)) = before {
                place[0] += touching(Placed::new(other, there), shape, turn, place)?;
            }
            let pose = Pose::new(turn, place);
            bodies.push((world.add(shape.clone(), pose)?, pose));
            before = Some((shape, pose));
        }
    }
    world.step();
    let (mut times, mut pairs, mut undecided) = (Vec::new(), 0, 0);
    for step in 0..STEPS {
        let mut moves = Vec::new();
        for (body, pose) in bodies.iter_mut().skip(step % MOVING).step_by(MOVING) {
            let way: Vector<f64, D> = Vector(random.point([0.0; D], 1.0));
            let turn = <Space as Turn<D>>::by(&mut random, 1e-3)?;
            let moved = pose.translation + way * (1e-3 / way.norm());
            *pose = Pose::new(turn * pose.rotation, moved);
            moves.push((*body, *pose));
        }
        world.set_poses(&moves)?;
        let margin = world.settings().manifold.margin;
        let start = Instant::now();
        let found = world.step();
        times.push(start.elapsed().as_nanos() as f64);
        let verdicts = || found.iter().map(|pair| pair.verdict(margin));
        pairs = verdicts().filter(|verdict| *verdict == Verdict::Touching).count();
        undecided += verdicts().filter(|verdict| *verdict == Verdict::Undecided).count();
    }
    rows.add_times(&format!("{key}.step"), times);
    rows.insert(format!("{key}.pairs"), pairs as f64);
    rows.insert(format!("{key}.undecided"), undecided as f64);
    Ok(())
}

/// How far along x from `place` a turned shape touches another, coming from afar.
fn touching<const D: usize>(
    other: Placed<'_, D>,
    shape: &Shape<D>,
    turn: Rotation<D>,
    place: Vector<f64, D>,
) -> Result<f64, QueryError> {
    let limits = Limits::new(1e-5);
    let mut workspace = PairWorkspace::new();
    let (mut near, mut far) = (0.0, 2.0);
    while far - near > 1e-5 {
        let middle = 0.5 * (near + far);
        let pose = Pose::new(turn, place + Vector::unit(0) * middle);
        let found = overlap(other, Placed::new(shape, pose), &limits, &mut workspace)?;
        if found.is_hit() == Some(false) { far = middle } else { near = middle }
    }
    Ok(far)
}

fn in_space() -> Result<[Shape<3>; 4], ShapeError> {
    Ok([
        Shape::from_kernel(Ball::new(0.5)?),
        Shape::from_kernel(Cuboid::new(Vector([0.7, 0.6, 0.8]))?),
        Shape::from_kernel(Torus::new(0.4, 0.15)?),
        Shape::from_kernel(Cylinder::new(0.45, 0.8)?),
    ])
}

fn in_the_plane() -> Result<[Shape<2>; 4], ShapeError> {
    Ok([
        Shape::from_kernel(Ball::new(0.5)?),
        Shape::from_kernel(Cuboid::new(Vector([0.7, 0.6]))?),
        Shape::from_kernel(Ring::new(0.25, 0.55)?),
        Shape::from_kernel(RoundedCuboid::new(Vector([0.9, 0.8]), 0.1)?),
    ])
}
