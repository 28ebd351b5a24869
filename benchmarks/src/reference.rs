// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What times are held against: our own evaluation of S3, in `f64` blocks on the same core.
//!
//! A machine, its clock and its neighbours make both a time and the reference beside it longer;
//! their ratio stays.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use palpate::field::{BLOCK, Block, Column, Shape};

use crate::fields::{Points, Rows};
use crate::scenes;

/// Points of a pass.
pub(crate) const POINTS: usize = 1024;

/// Passes of one measurement, of which the fastest counts; 1024 points take some microseconds.
const PASSES: usize = 200;

/// The row of the reference itself.
pub(crate) const KEY: &str = "reference.S3.ns";

/// What the key of a time ends in once it is divided by the reference.
pub(crate) const OVER: &str = ".over_S3";

/// S3, and the points that it is asked for.
pub(crate) struct Reference {
    shape: Shape<3>,
    blocks: Vec<Block<f64, 3, BLOCK>>,
}

impl Reference {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let s3 = scenes::s3()?;
        let points = Points::<3>::new(s3.half);
        Ok(Self { blocks: Points::blocks(&points.scattered[..POINTS]), shape: s3.shape })
    }

    /// Asks for all points once. What it returns keeps the work from being dropped.
    pub(crate) fn pass(&self) -> f64 {
        let mut out = Column::zero();
        for block in &self.blocks {
            self.shape.block_distances(block, BLOCK, &mut out);
        }
        out.get(0)
    }

    /// The time of a point in the fastest of several passes [ns].
    pub(crate) fn time(&self) -> f64 {
        let time = |_| {
            let start = Instant::now();
            black_box(self.pass());
            start.elapsed().as_nanos() as f64 / POINTS as f64
        };
        (0..PASSES).map(time).fold(f64::INFINITY, f64::min)
    }

    /// What `work` adds to rows, with each time divided by the reference too, which is timed
    /// before and after.
    pub(crate) fn beside(
        &self,
        work: impl FnOnce(&mut Rows) -> Result<(), Box<dyn Error>>,
    ) -> Result<Rows, Box<dyn Error>> {
        let before = self.time();
        let mut rows = Rows::new();
        work(&mut rows)?;
        let reference = before.min(self.time());
        let divided: Rows = rows
            .iter()
            .filter_map(|(key, time)| Some((over(key)?, time / reference)))
            .collect();
        rows.extend(divided);
        rows.insert(KEY.into(), reference);
        Ok(rows)
    }
}

/// The key of a time in nanoseconds, once it is divided by the reference; none of what is no
/// time.
pub(crate) fn over(key: &str) -> Option<String> {
    let stem = key.strip_suffix(".ns").or_else(|| key.strip_suffix("_ns"))?;
    Some(format!("{stem}{OVER}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_alone_are_divided_by_the_reference() {
        assert_eq!(over("S3.model.64.ns").as_deref(), Some("S3.model.64.over_S3"));
        assert_eq!(over("tick.S3.p50_ns").as_deref(), Some("tick.S3.p50.over_S3"));
        assert_eq!(over("tick.S3.evaluations"), None);
        assert_eq!(over("S3.distance.1024.ours_over_fidget_jit"), None);
    }

    #[test]
    fn the_reference_is_divided_by_what_it_is_beside() {
        let reference = Reference::new().unwrap();
        let rows = reference.beside(|rows| {
            rows.insert("work.ns".into(), 6.0);
            rows.insert("work.hits".into(), 7.0);
            Ok(())
        });
        let rows = rows.unwrap();
        assert_eq!(rows["work.over_S3"], 6.0 / rows[KEY]);
        assert_eq!(rows.len(), 4);
    }
}
