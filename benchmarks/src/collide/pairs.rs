// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies at known separations: whether they overlap, and how far they are apart.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use palpate::field::kernel::{Cuboid, Ring, Torus};
use palpate::field::{Pose, Shape, Vector};
use palpate::query::{
    Certified, Limits, Nearest, PairWorkspace, Placed, QueryError, Track, overlap, separation,
};

use super::{Space, TimedRows, fastest};
use crate::random::Random;
use crate::scenes::{self, Work};

/// Poses of each pair.
const POSES: usize = 40;

/// How close to the gap that is asked for bodies are put [m].
const PLACED: f64 = 1e-6;

/// Farther apart than any two bodies here touch [m].
const FAR: f64 = 3.0;

/// Steps of bodies that are followed.
const STEPS: usize = 50;

/// Two bodies.
pub(super) type Pair<'a, const D: usize> = [Placed<'a, D>; 2];

/// A way of asking.
type Ask<'a, const D: usize> = fn(
    Placed<'a, D>,
    Placed<'a, D>,
    &Limits,
    &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError>;

/// Adds the rows of pairs, in space and in the plane.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let find = |name: &'static str| move || format!("no {name}");
    let spatial = scenes::spatial()?;
    of(spatial.iter().find(|work| work.name == "S3").ok_or_else(find("S3"))?, rows)?;
    let planar = scenes::planar()?;
    of(planar.iter().find(|work| work.name == "P3").ok_or_else(find("P3"))?, rows)?;
    let [plate, torus] = plate_and_torus()?;
    let pairs = placed([&plate, &torus], -0.001)?;
    ask("pair.sign.plate_torus.-1mm", overlap, 1e-7, &pairs, rows)?;
    let bar = Shape::from_kernel(Cuboid::new(Vector([1.0, 0.02]))?);
    let ring = Shape::from_kernel(Ring::new(0.2, 0.5)?);
    let pairs = placed([&bar, &ring], -0.001)?;
    ask("pair.sign.bar_ring.-1mm", overlap, 1e-7, &pairs, rows)
}

/// A thin plate, and a torus.
pub(super) fn plate_and_torus() -> Result<[Shape<3>; 2], Box<dyn Error>> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 0.02]))?);
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    Ok([plate, torus])
}

/// The rows of a work against itself.
fn of<const D: usize>(work: &Work<D>, rows: &mut TimedRows) -> Result<(), Box<dyn Error>>
where
    Space: super::Turn<D>,
{
    let (name, shape) = (format!("{0}_{0}", work.name), &work.shape);
    for (at, gap) in [("+50mm", 0.05), ("+5mm", 0.005), ("-5mm", -0.005)] {
        let pairs = placed([shape, shape], gap)?;
        ask(&format!("pair.sign.{name}.{at}"), overlap, 1e-7, &pairs, rows)?;
    }
    let pairs = placed([shape, shape], 0.005)?;
    for (to, tolerance) in [("1pc", 1e-2), ("1mm", 1e-3), ("0.1mm", 1e-4)] {
        ask(&format!("pair.separation.{name}.{to}"), separation, tolerance, &pairs, rows)?;
    }
    follow(&format!("pair.warm_1mm.{name}"), 1e-3, &placed([shape, shape], -0.005)?, rows)
}

pub(super) fn ask<'a, const D: usize>(
    key: &str,
    ask: Ask<'a, D>,
    tolerance: f64,
    pairs: &[Pair<'a, D>],
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error>> {
    let limits = Limits::new(tolerance);
    let mut workspace = PairWorkspace::new();
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    for [a, b] in pairs {
        let answer = ask(*a, *b, &limits, &mut workspace)?;
        evaluations += answer.evaluations;
        let is_known = answer.is_hit().is_some() || answer.upper - answer.lower <= tolerance;
        undecided += u32::from(!is_known);
        times.push(fastest(|| {
            // That it is no error was seen above.
            let _ = black_box(ask(*a, black_box(*b), &limits, &mut workspace));
        }));
    }
    rows.add_times(key, times);
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / pairs.len() as f64);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    Ok(())
}

/// Each pair moved on by 0.1 mm and turned by 0.1 mrad again and again, and followed.
fn follow<const D: usize>(
    key: &str,
    tolerance: f64,
    pairs: &[Pair<'_, D>],
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error>>
where
    Space: super::Turn<D>,
{
    let limits = Limits::new(tolerance);
    let mut workspace = PairWorkspace::new();
    let mut random = Random::new(7);
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    for [a, b] in pairs {
        let mut track = Track::new(a.shape.clone(), b.shape.clone());
        let way: Vector<f64, D> = Vector(random.point([0.0; D], 1.0));
        let step = Pose::translation(way * (1e-4 / way.norm()));
        let turn = Pose::rotation(<Space as super::Turn<D>>::by(&mut random, 1e-4)?);
        let mut here = b.world_from_body;
        let mut poses = Vec::with_capacity(STEPS);
        for _ in 0..STEPS {
            here = step * here * turn;
            poses.push(here);
        }
        let mut fastest = vec![f64::INFINITY; STEPS];
        for _ in 0..super::REPEATS {
            track.forget();
            track.separation(
                [a.world_from_body, b.world_from_body],
                &limits,
                &mut workspace,
            )?;
            for (pose, fastest) in poses.iter().zip(&mut fastest) {
                let start = Instant::now();
                let poses = [a.world_from_body, *pose];
                let answer = black_box(track.separation(poses, &limits, &mut workspace)?);
                *fastest = fastest.min(start.elapsed().as_nanos() as f64);
                evaluations += answer.evaluations;
                undecided += u32::from(answer.upper - answer.lower > tolerance);
            }
        }
        times.append(&mut fastest);
    }
    let asked = (times.len() * super::REPEATS) as f64;
    rows.add_times(key, times);
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / asked);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    Ok(())
}

/// The second body turned at random and moved along a random way to the first place at
/// which the separation is `gap`, coming from afar.
pub(super) fn placed<'a, const D: usize>(
    [a, b]: [&'a Shape<D>; 2],
    gap: f64,
) -> Result<Vec<Pair<'a, D>>, Box<dyn Error>>
where
    Space: super::Turn<D>,
{
    let mut random = Random::new(99);
    let mut workspace = PairWorkspace::new();
    let limits = Limits::new(PLACED).with_budget(1_000_000);
    let mut pairs = Vec::with_capacity(POSES);
    while pairs.len() < POSES {
        let turn = <Space as super::Turn<D>>::any(&mut random)?;
        let way: Vector<f64, D> = Vector(random.point([0.0; D], 1.0));
        let way = way * (1.0 / way.norm());
        let at = |apart: f64| Placed::new(b, Pose::new(turn, way * apart));
        let (mut near, mut far) = (0.0, FAR);
        let deepest = separation(a, at(near), &limits, &mut workspace)?;
        if deepest.upper > gap {
            continue;
        }
        while far - near > PLACED {
            let middle = 0.5 * (near + far);
            let answer = separation(a, at(middle), &limits, &mut workspace)?;
            if answer.lower > gap { far = middle } else { near = middle }
        }
        pairs.push([a.into(), at(far)]);
    }
    Ok(pairs)
}
