// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches on what the certified ones are asked: how long they take, and how often
//! they miss.

use std::error::Error;
use std::hint::black_box;

use palpate::field::{Aabb, Point, Vector};
use palpate::local::{ElementMethod, PairMethod};
use palpate::query::{ElementWorkspace, Limits, minimum};

use super::pairs::{Pair, placed, plate_and_torus};
use super::triangles::{SIZES, near};
use super::{TimedRows, fastest};
use crate::random::Random;
use crate::scenes::{self, Work};

/// What is missed by more than this share of the size is missed.
const MISSED: f64 = 0.01;

/// Starts of each pose, and how many of them are tried together.
const STARTS: usize = 40;
const TOGETHER: [usize; 3] = [1, 10, STARTS];

/// The steps with which a search between bodies ends [m].
const SMALLEST_STEP: f64 = 1e-5;

/// Adds the rows of local searches.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    scenes::spatial()?.iter().try_for_each(|work| triangles(work, rows))?;
    pairs(rows)
}

/// Adds the rows of a work: minima over triangles.
fn triangles(work: &Work<3>, rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let shape = &work.shape;
    for method in ElementMethod::ALL {
        let mut times = Vec::new();
        let (mut evaluations, mut missed) = (0, 0);
        for size in SIZES {
            let limits = Limits::new(0.01 * MISSED * size);
            let mut workspace = ElementWorkspace::new();
            for triangle in near::<3, 3>(shape, size)? {
                let least = minimum(shape, &triangle, &limits, &mut workspace)?;
                let found = method.descend(shape, &triangle);
                evaluations += found.evaluations;
                missed += u32::from(found.value > least.upper + MISSED * size);
                times.push(fastest(|| {
                    black_box(method.descend(shape, black_box(&triangle)));
                }));
            }
        }
        let key = format!("local.{method}.{}", work.name);
        let count = times.len() as f64;
        rows.add_times(&key, times);
        rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / count);
        rows.insert(format!("{key}.missed"), f64::from(missed) / count);
    }
    Ok(())
}

/// Adds the rows of two bodies that overlap a little.
fn pairs(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let [plate, torus] = plate_and_torus()?;
    let pairs = placed([&plate, &torus], -0.001)?;
    for method in PairMethod::ALL {
        let mut random = Random::new(11);
        let mut times = Vec::new();
        let mut evaluations = 0;
        let mut missed = [0; TOGETHER.len()];
        for pair in &pairs {
            let [a, b] = *pair;
            let starts = starts(pair, &mut random);
            let mut has_found = Vec::with_capacity(STARTS);
            for start in &starts {
                let found = method.descend(a, b, *start, SMALLEST_STEP)?;
                evaluations += found.evaluations;
                has_found.push(found.value <= 0.0);
            }
            for (missed, together) in missed.iter_mut().zip(TOGETHER) {
                let tries = has_found.chunks(together);
                *missed += tries.filter(|found| !found.contains(&true)).count();
            }
            times.push(fastest(|| {
                // That it is no error was seen above.
                let _ = black_box(method.descend(a, b, black_box(starts[0]), SMALLEST_STEP));
            }));
        }
        let key = format!("local.{method}.plate_torus.-1mm");
        rows.add_times(&key, times);
        let count = (pairs.len() * STARTS) as f64;
        rows.insert(format!("{key}.evaluations"), f64::from(evaluations) / count);
        for (missed, together) in missed.iter().zip(TOGETHER) {
            let share = (missed * together) as f64 / count;
            rows.insert(format!("{key}.missed_{together}"), share);
        }
    }
    Ok(())
}

/// Points of the overlap of both boxes.
fn starts(pair: &Pair<'_, 3>, random: &mut Random) -> Vec<Point<3>> {
    let [a, b] = pair.map(|body| {
        let far = Vector::constant(1.0);
        let bounds = body.shape.promise().bounds;
        bounds.map_or(Aabb { min: -far, max: far }, |bounds| {
            bounds.aabb.placed(&body.world_from_body)
        })
    });
    let mut point = || {
        Vector(std::array::from_fn(|k| {
            random.between(a.min[k].max(b.min[k]), a.max[k].min(b.max[k]))
        }))
    };
    (0..STARTS).map(|_| point()).collect()
}
