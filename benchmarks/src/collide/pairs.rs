// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies at known separations: whether they overlap, and how far they are apart.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use palpate::field::kernel::{Cuboid, Torus};
use palpate::field::{Pose, Rotation, Shape, Vector};
use palpate::query::{
    Certified, Limits, Nearest, PairWorkspace, Placed, QueryError, Track, overlap, separation,
};

use super::fastest;
use crate::fields::Rows;
use crate::random::Random;
use crate::scenes;

/// Poses of each pair.
const POSES: usize = 40;

/// How close to the gap that is asked for bodies are put [m].
const PLACED: f64 = 1e-6;

/// Farther apart than any two bodies here touch [m].
const FAR: f64 = 4.0;

/// Two bodies.
type Pair<'a> = [Placed<'a, 3>; 2];

/// A way of asking.
type Ask<'a> = fn(
    Placed<'a, 3>,
    Placed<'a, 3>,
    &Limits,
    &mut PairWorkspace<3>,
) -> Result<Certified<Nearest<3>>, QueryError>;

/// Adds the rows of pairs.
pub(super) fn measure(rows: &mut Rows) -> Result<(), Box<dyn Error>> {
    let works = scenes::spatial()?;
    let s3 = &works.iter().find(|work| work.name == "S3").ok_or("no S3")?.shape;
    for (name, gap) in [("+50mm", 0.05), ("+5mm", 0.005), ("-5mm", -0.005)] {
        let pairs = placed([s3, s3], gap)?;
        ask(&format!("pair.sign.S3_S3.{name}"), overlap, 1e-7, &pairs, rows)?;
    }
    let pairs = placed([s3, s3], 0.005)?;
    for (name, tolerance) in [("1pc", 1e-2), ("1mm", 1e-3), ("0.1mm", 1e-4)] {
        let key = format!("pair.separation.S3_S3.{name}");
        ask(&key, separation, tolerance, &pairs, rows)?;
    }
    let plate = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 0.02]))?);
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let pairs = placed([&plate, &torus], -0.001)?;
    ask("pair.sign.plate_torus.-1mm", overlap, 1e-7, &pairs, rows)?;
    follow("pair.warm_1mm.S3_S3", 1e-3, &placed([s3, s3], -0.005)?, rows)
}

/// Each pair moved on by 0.1 mm and turned by 0.1 mrad again and again, and followed.
fn follow(
    key: &str,
    tolerance: f64,
    pairs: &[Pair<'_>],
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>> {
    const STEPS: usize = 50;
    let limits = Limits { tolerance, ..Limits::default() };
    let mut workspace = PairWorkspace::new();
    let mut random = Random::new(7);
    let mut times = Vec::new();
    let (mut evaluations, mut undecided) = (0, 0);
    for [a, b] in pairs {
        let mut track = Track::new(a.shape.clone(), b.shape.clone());
        let way: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
        let axis: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
        let turn = Pose::rotation(Rotation::from_axis_angle(axis, 1e-4)?);
        let mut here = b.world_from_body;
        let mut poses = Vec::with_capacity(STEPS);
        for _ in 0..STEPS {
            here = Pose::translation(way * (1e-4 / way.norm())) * here * turn;
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
                let answer = black_box(track.separation(
                    [a.world_from_body, *pose],
                    &limits,
                    &mut workspace,
                )?);
                *fastest = fastest.min(start.elapsed().as_nanos() as f64);
                evaluations += answer.evaluations;
                undecided += u32::from(answer.upper - answer.lower > tolerance);
            }
        }
        times.append(&mut fastest);
    }
    let asked = (times.len() * super::REPEATS) as f64;
    super::summarise(key, &mut times, rows);
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / asked);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    Ok(())
}

fn ask<'a>(
    key: &str,
    ask: Ask<'a>,
    tolerance: f64,
    pairs: &[Pair<'a>],
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>> {
    let limits = Limits { tolerance, ..Limits::default() };
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
    super::summarise(key, &mut times, rows);
    rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / pairs.len() as f64);
    rows.insert(format!("{key}.undecided"), f64::from(undecided));
    Ok(())
}

/// The second body turned at random and moved along a random way to the first place at
/// which the separation is `gap`, coming from afar.
fn placed<'a>([a, b]: [&'a Shape<3>; 2], gap: f64) -> Result<Vec<Pair<'a>>, Box<dyn Error>> {
    let mut random = Random::new(7);
    let mut workspace = PairWorkspace::new();
    let limits = Limits { tolerance: PLACED, budget: 1_000_000 };
    let mut pairs = Vec::with_capacity(POSES);
    while pairs.len() < POSES {
        let [x, y, z]: [f64; 3] = random.point([0.0; 3], 1.0);
        let way: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
        let w = random.between(-1.0, 1.0);
        let size = (x * x + y * y + z * z + w * w).sqrt();
        let turn = Rotation::from_quaternion([x, y, z, w].map(|q| q / size))?;
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
