// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points from a file, in bounded memory and on all cores.

use std::io::Write;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use palpate::field::{BLOCK, Block, Gradients, Point, Shape, Vector};
use palpate::query::{AtPoint, BallWorkspace};
use palpate::scene::{BallAnswer, Balls, Versioned};
use rayon::prelude::*;
use serde::Serialize;

use crate::arguments::Reading;
use crate::ask;
use crate::eval::EvalOptions;
use crate::interrupt::{self, Interrupt};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination};
use crate::table::{Table, coordinates};

/// Points read before they are evaluated: enough to keep all cores busy, few
/// enough to stay in their caches.
const BATCH: usize = 64 * 1024;

/// Points read before balls around them are asked about: a search may be ten thousand times as
/// long as an evaluation, and an interrupted run ends after a batch.
const BATCH_OF_BALLS: usize = 1024;

/// What is asked about the points of a file.
pub(super) struct Job<'a, const D: usize> {
    pub(super) shape: &'a Shape<D>,
    /// The file.
    pub(super) points: &'a Path,
    /// The balls around the points, if they are asked about too.
    pub(super) balls: Option<Balls<'a, D>>,
}

impl<const D: usize> Job<'_, D> {
    pub(super) fn run(
        self,
        options: &EvalOptions,
        destination: &Destination,
        interrupt: &Interrupt,
    ) -> Result<Outcome, Failure> {
        let pool = interrupt::pool(options.threads)?;
        let stream = Stream {
            job: self,
            as_json: options.json,
            reading: options.reading,
            pool,
            interrupt,
        };
        let is_whole = |(outcome, _): &(Outcome, usize)| *outcome != Outcome::Interrupted;
        let (outcome, done) = destination.write_whole(|out| stream.evaluate(out), is_whole)?;
        if outcome == Outcome::Interrupted {
            let place = destination.part().map_or_else(String::new, |part| {
                format!("; their answers are in {}", part.display())
            });
            output::remark(format_args!("interrupted after {done} points{place}"));
        }
        Ok(outcome)
    }

    /// How many points are read at once.
    fn batch(&self) -> usize {
        if self.balls.is_some() { BATCH_OF_BALLS } else { BATCH }
    }
}

/// A file of points, and how they are evaluated.
struct Stream<'a, const D: usize> {
    job: Job<'a, D>,
    as_json: bool,
    reading: Reading,
    pool: rayon::ThreadPool,
    interrupt: &'a Interrupt,
}

impl<const D: usize> Stream<'_, D> {
    /// Writes the answers, batch by batch, and returns for how many points. An interrupted run
    /// ends after a whole row.
    fn evaluate(&self, out: &mut dyn Write) -> Result<(Outcome, usize), Failure> {
        let mut table = Table::open(self.job.points, self.reading)?;
        let columns = coordinates::<D>(&table, &format!("a point in {D}D"), &[])?;
        let size = std::fs::metadata(self.job.points).map_or(0, |metadata| metadata.len());
        let bar = bar(size);
        self.interrupt.heed();
        if !self.as_json {
            let mut header = super::header::<D>();
            if self.job.balls.is_some() {
                header.extend(super::header_of_ball::<D>());
            }
            writeln!(out, "{}", header.join(","))?;
        }
        let mut batch: Vec<Point<D>> = Vec::with_capacity(self.job.batch());
        let mut done = 0;
        loop {
            // Flushed, so that a reader of a pipe sees every finished batch.
            out.flush()?;
            self.read(&mut table, &columns, &mut batch)?;
            if self.interrupt.is_asked() {
                return Ok((Outcome::Interrupted, done));
            }
            if !table.is_good() {
                // No more is evaluated, but every bad value is found.
                while !batch.is_empty() && !self.interrupt.is_asked() {
                    self.read(&mut table, &columns, &mut batch)?;
                }
                table.finish()?;
            }
            if batch.is_empty() {
                bar.finish_and_clear();
                return Ok((Outcome::Yes, done));
            }
            let texts: Vec<String> = self.pool.install(|| {
                let workspace = || self.job.balls.map(|_| BallWorkspace::new());
                let blocks =
                    batch.par_chunks(BLOCK).map_init(workspace, |workspace, points| {
                        self.job.answers(points, self.as_json, workspace.as_mut())
                    });
                blocks.collect::<Result<_, _>>()
            })?;
            for text in texts {
                out.write_all(text.as_bytes())?;
            }
            done += batch.len();
            bar.set_position(table.position());
        }
    }

    /// Reads the next batch, which is shorter at the end of the file and if interrupted. A row
    /// with a bad value is noted, and stands in the batch as the origin.
    fn read(
        &self,
        table: &mut Table,
        columns: &[usize],
        batch: &mut Vec<Point<D>>,
    ) -> Result<(), Failure> {
        batch.clear();
        while batch.len() < self.job.batch() && !self.interrupt.is_asked() && table.advance()? {
            let mut point = Vector::ZERO;
            for (axis, column) in columns.iter().enumerate() {
                point[axis] = table.number(*column).unwrap_or_default();
            }
            batch.push(point);
        }
        Ok(())
    }
}

/// The progress bar, which is hidden unless standard error is a terminal.
fn bar(size: u64) -> ProgressBar {
    ProgressBar::new(size).with_style(
        ProgressStyle::with_template("{bar:40} {percent} % of {total_bytes}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}

impl<const D: usize> Job<'_, D> {
    /// The lines for up to a block of points. A point's line depends only on the point, so any
    /// number of threads writes the same bytes.
    fn answers(
        &self,
        points: &[Point<D>],
        as_json: bool,
        mut workspace: Option<&mut BallWorkspace<D>>,
    ) -> Result<String, Failure> {
        let mut block = Block::<f64, D, BLOCK>::zero();
        let mut found = Gradients::<f64, D, BLOCK>::zero();
        for (i, point) in points.iter().enumerate() {
            block.set(i, *point);
        }
        self.shape.block_gradients(&block, points.len(), &mut found);
        let mut text = String::new();
        for (i, point) in points.iter().enumerate() {
            let (distance, gradient) = (found.distance.get(i), found.gradient.get(i));
            let answer = AtPoint::of_slope(self.shape, *point, distance, gradient);
            let ball = match (&self.balls, workspace.as_deref_mut()) {
                (Some(balls), Some(workspace)) => {
                    Some(balls.ask(&answer, workspace).map_err(ask::failure)?)
                }
                _ => None,
            };
            text.push_str(&Line { at: answer, ball }.text(as_json)?);
            text.push('\n');
        }
        Ok(text)
    }
}

/// The answer for a point, and for the ball around it if that is asked about.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Line<const D: usize> {
    #[serde(flatten)]
    at: AtPoint<D>,
    /// What is known of the ball, if one was asked about.
    ball: Option<BallAnswer<D>>,
}

impl<const D: usize> Line<D> {
    fn text(&self, as_json: bool) -> Result<String, Failure> {
        if as_json {
            return serde_json::to_string(&Versioned::new(self)).map_err(Failure::input);
        }
        let mut row = super::row(&self.at);
        row.extend(self.ball.as_ref().map(super::row_of_ball).unwrap_or_default());
        Ok(row.join(","))
    }
}
