// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How fast the machine is while a suite runs: a peer's work, timed between ours.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use fidget::jit::JitFunction;

use crate::bars::YARDSTICK;
use crate::fields::{NOTHING, Rows};
use crate::peers::{Tape, formula};
use crate::random::Random;
use crate::scenes;

/// Points of a pass.
const POINTS: usize = 1024;

/// Passes of one measurement.
const PASSES: usize = 50;

/// fidget's compiled S3, asked a point at a time, each after the answer for the one before.
pub(crate) struct Yardstick {
    tape: Tape<JitFunction>,
    points: Vec<[f32; 3]>,
    fastest: f64,
}

impl Yardstick {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let s3 = scenes::s3()?;
        let mut random = Random::new(7);
        let mut point = || random.point([0.0; 3], s3.half).map(|x| x as f32);
        let points = (0..POINTS).map(|_| point()).collect();
        Ok(Self { tape: Tape::new(&formula(&s3.scene)?), points, fastest: f64::INFINITY })
    }

    /// Times it once more. What counts is the fastest pass of all, as it is for what the
    /// suites time.
    pub(crate) fn measure(&mut self, rows: &mut Rows) {
        for _ in 0..PASSES {
            let start = Instant::now();
            black_box(
                self.points.iter().fold(0.0, |last, [x, y, z]| {
                    self.tape.distance([x + last * NOTHING, *y, *z])
                }),
            );
            let time = start.elapsed().as_nanos() as f64 / POINTS as f64;
            self.fastest = self.fastest.min(time);
        }
        rows.insert(YARDSTICK.0.into(), self.fastest);
    }
}
