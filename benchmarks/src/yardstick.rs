// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How fast the machine is while a suite runs: a peer's work, timed between ours.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use fidget::jit::JitFunction;

use crate::bars::{POINTS, SLICES};
use crate::fields::{NOTHING, Rows};
use crate::peers::{Tape, formula};
use crate::random::Random;
use crate::scenes;

/// Points of a pass.
const COUNT: usize = 1024;

/// Passes of one measurement.
const PASSES: usize = 50;

/// fidget's compiled S3, asked a point at a time, each after the answer for the one before,
/// and for all of them at once.
pub(crate) struct Yardstick {
    tape: Tape<JitFunction>,
    points: Vec<[f32; 3]>,
    /// The same, a coordinate after the other.
    slices: [Vec<f32>; 3],
    fastest: [f64; 2],
}

impl Yardstick {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let s3 = scenes::s3()?;
        let mut random = Random::new(7);
        let mut point = || random.point([0.0; 3], s3.half).map(|x| x as f32);
        let points: Vec<_> = (0..COUNT).map(|_| point()).collect();
        let slices = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect());
        let tape = Tape::new(&formula(&s3.scene)?);
        Ok(Self { tape, points, slices, fastest: [f64::INFINITY; 2] })
    }

    /// Times it once more. What counts is the fastest pass of all, as it is for what the
    /// suites time.
    pub(crate) fn measure(&mut self, rows: &mut Rows) {
        let Self { tape, points, slices, fastest: [one, many] } = self;
        for _ in 0..PASSES {
            let chain =
                |last: f32, [x, y, z]: &[f32; 3]| tape.distance([x + last * NOTHING, *y, *z]);
            *one = one.min(time(|| points.iter().fold(0.0, chain)));
            *many = many.min(time(|| tape.distances(slices.each_ref().map(Vec::as_slice))));
        }
        rows.insert(POINTS.0.into(), *one);
        rows.insert(SLICES.0.into(), *many);
    }
}

/// What a pass takes for each of its points [ns].
fn time(pass: impl FnOnce() -> f32) -> f64 {
    let start = Instant::now();
    black_box(pass());
    start.elapsed().as_nanos() as f64 / COUNT as f64
}
