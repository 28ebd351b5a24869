// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Searches that prove where things touch.

mod heaps;
mod local;
mod manifolds;
mod meshes;
mod pairs;
mod peers;
mod sampled;
mod sweeps;
mod tracks;
mod triangles;
mod worlds;

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Instant;

use palpate::field::{Rotation, ShapeError, Vector};

use crate::fields::Rows;
use crate::random::Random;
use crate::reference::Reference;
use crate::rounds;

/// What adds rows.
type Part = fn(&mut TimedRows) -> Result<(), Box<dyn Error>>;

/// The parts of the suite.
const PARTS: &[(&str, Part)] = &[
    ("triangles", triangles::measure),
    ("meshes", meshes::measure),
    ("local", local::measure),
    ("pairs", pairs::measure),
    ("sweeps", sweeps::measure),
    ("peers", peers::measure),
    ("manifolds", manifolds::measure),
    ("tracks", tracks::measure),
    ("worlds", worlds::measure),
    ("heaps", heaps::measure),
    ("sampled", sampled::measure),
];

/// The names of the parts.
pub(crate) fn parts() -> impl Iterator<Item = &'static str> {
    PARTS.iter().map(|(name, _)| *name)
}

/// All rows of the suite, or those of one part: medians of so many runs.
pub(crate) fn measure(only: Option<&str>, runs: u32) -> Result<Rows, Box<dyn Error>> {
    let reference = Reference::new()?;
    let mut all = Vec::new();
    for _ in 0..runs {
        let parts = PARTS.iter().filter(|(name, _)| only.is_none_or(|only| only == *name));
        for (name, part) in parts {
            eprintln!("measuring {name} …");
            all.push(reference.beside(|rows| {
                let mut timed = TimedRows::default();
                part(&mut timed)?;
                rows.extend(timed.finished());
                Ok(())
            })?);
        }
    }
    Ok(rounds::medians(all))
}

/// Rows, and the times that some of them are made of.
#[derive(Default)]
pub(crate) struct TimedRows {
    rows: Rows,
    /// Of each key, the time of each question [ns].
    times: BTreeMap<String, Vec<f64>>,
}

impl TimedRows {
    fn insert(&mut self, key: String, number: f64) {
        self.rows.insert(key, number);
    }

    /// Adds the times of all questions of a key [ns].
    fn add_times(&mut self, key: &str, times: Vec<f64>) {
        self.times.insert(key.into(), times);
    }

    /// All rows: of times, the mean, the median and the extremes.
    fn finished(self) -> Rows {
        let mut rows = self.rows;
        for (key, mut times) in self.times {
            times.sort_by(f64::total_cmp);
            let Some(last) = times.last() else { continue };
            rows.insert(format!("{key}.max_ns"), *last);
            rows.insert(format!("{key}.ns"), times.iter().sum::<f64>() / times.len() as f64);
            rows.insert(format!("{key}.p50_ns"), times[times.len() / 2]);
            rows.insert(format!("{key}.p95_ns"), times[times.len() * 95 / 100]);
        }
        peers::compare(&mut rows);
        heaps::compare(&mut rows);
        sampled::compare(&mut rows);
        worlds::name_medians(&mut rows);
        rows
    }
}

/// Marks a dimension.
pub(crate) struct Space;

/// A dimension in which bodies turn.
pub(crate) trait Turn<const D: usize> {
    /// Any rotation.
    fn any(random: &mut Random) -> Result<Rotation<D>, ShapeError>;

    /// A rotation by `angle` [rad], about any axis.
    fn by(random: &mut Random, angle: f64) -> Result<Rotation<D>, ShapeError>;
}

impl Turn<2> for Space {
    fn any(random: &mut Random) -> Result<Rotation<2>, ShapeError> {
        Rotation::from_angle(random.between(0.0, 6.0))
    }

    fn by(_: &mut Random, angle: f64) -> Result<Rotation<2>, ShapeError> {
        Rotation::from_angle(angle)
    }
}

impl Turn<3> for Space {
    fn any(random: &mut Random) -> Result<Rotation<3>, ShapeError> {
        let axis = Vector(random.point([0.0; 3], 1.0));
        Rotation::from_axis_angle(axis, random.between(0.0, 6.0))
    }

    fn by(random: &mut Random, angle: f64) -> Result<Rotation<3>, ShapeError> {
        Rotation::from_axis_angle(Vector(random.point([0.0; 3], 1.0)), angle)
    }
}

/// How often each question is timed; the fastest counts.
const REPEATS: usize = 20;

/// A batch of runs takes at least this long [ns], far more than reading the clock.
const BATCH: f64 = 5e3;

/// The time of the fastest of several batches of runs [ns a run].
fn fastest(mut run: impl FnMut()) -> f64 {
    let start = Instant::now();
    run();
    let one = start.elapsed().as_nanos() as f64;
    let runs = (BATCH / one.max(1.0)).ceil().clamp(1.0, 64.0);
    let mut best = f64::INFINITY;
    for _ in 0..REPEATS {
        let start = Instant::now();
        for _ in 0..runs as usize {
            run();
        }
        best = best.min(start.elapsed().as_nanos() as f64 / runs);
    }
    best
}
