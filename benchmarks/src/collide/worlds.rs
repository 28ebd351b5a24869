// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A thousand bodies of which some move.

use std::error::Error;
use std::time::Instant;

use palpate::field::kernel::{Ball, Cuboid, Cylinder, Torus};
use palpate::field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate::query::{BodyId, Verdict, World, WorldSettings};

use crate::fields::Rows;
use crate::random::Random;

/// Bodies along each side of a cube of them, 1 m apart.
const SIDE: usize = 10;

/// One body of so many moves in each step, by 1 mm and 1 mrad.
const MOVING: usize = 20;

/// Steps that are timed.
const STEPS: usize = 40;

/// Adds the rows of worlds, on one thread.
pub(super) fn measure(rows: &mut Rows) -> Result<(), Box<dyn Error>> {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one_thread.install(|| steps(rows)).map_err(|error| -> Box<dyn Error> { error })
}

fn steps(rows: &mut Rows) -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut random = Random::new(7);
    let shapes = shapes()?;
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    let mut bodies: Vec<(BodyId, Pose<3>)> = Vec::new();
    for i in 0..SIDE.pow(3) {
        let place = [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE].map(|k| k as f64);
        let axis: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
        let turn = Rotation::from_axis_angle(axis, random.between(-3.0, 3.0))?;
        let pose = Pose::new(turn, Vector(place));
        bodies.push((world.add(shapes[i % shapes.len()].clone(), pose)?, pose));
    }
    world.step();
    let (mut times, mut pairs, mut undecided) = (Vec::new(), 0, 0);
    for step in 0..STEPS {
        let mut moves = Vec::new();
        for (body, pose) in bodies.iter_mut().skip(step % MOVING).step_by(MOVING) {
            let way: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
            let axis: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
            let turn = Rotation::from_axis_angle(axis, 1e-3)?;
            let step = Vector(way.0) * (1e-3 / way.norm());
            *pose = Pose::new(turn * pose.rotation, pose.translation + step);
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
    super::summarise("world.1000_bodies.step", &mut times, rows);
    // The median, so that a step during which another program ran does not count.
    rows.insert("world.1000_bodies.step_ns".into(), times[times.len() / 2]);
    rows.insert("world.1000_bodies.pairs".into(), pairs as f64);
    rows.insert("world.1000_bodies.undecided".into(), undecided as f64);
    Ok(())
}

/// Bodies as large as the distance between them.
fn shapes() -> Result<[Shape<3>; 4], ShapeError> {
    Ok([
        Shape::from_kernel(Ball::new(0.5)?),
        Shape::from_kernel(Cuboid::new(Vector([0.7, 0.6, 0.8]))?),
        Shape::from_kernel(Torus::new(0.4, 0.15)?),
        Shape::from_kernel(Cylinder::new(0.45, 0.8)?),
    ])
}
