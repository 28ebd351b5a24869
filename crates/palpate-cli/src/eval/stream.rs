// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points from a file, in bounded memory and on all cores.

use std::io::Write;
use std::num::NonZero;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use palpate::field::{BLOCK, Block, Gradients, Point, Shape, Vector};
use palpate::query::AtPoint;
use rayon::prelude::*;

use super::answer;
use crate::arguments::EvalOptions;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination};
use crate::table::{Table, coordinates};

/// Points read before they are evaluated: enough to keep all cores busy, few
/// enough to stay in their caches.
const BATCH: usize = 64 * 1024;

pub(crate) fn run<const D: usize>(
    shape: &Shape<D>,
    points: &Path,
    options: &EvalOptions,
    destination: &Destination,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads(options.threads)).build();
    let pool = pool.map_err(Failure::input)?;
    let stream = Stream { shape, points, as_json: options.json, pool, interrupt };
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

/// The requested number of threads, but no more than the machine runs at once: further ones
/// would wait, each with a batch in memory.
fn threads(asked: Option<usize>) -> usize {
    let most = std::thread::available_parallelism().map_or(1, NonZero::get);
    let asked = asked.unwrap_or(most);
    if asked > most {
        output::remark(format_args!("--threads {asked}: this machine runs {most} at once"));
    }
    asked.min(most)
}

/// A file of points, and how they are evaluated.
struct Stream<'a, const D: usize> {
    shape: &'a Shape<D>,
    points: &'a Path,
    as_json: bool,
    pool: rayon::ThreadPool,
    interrupt: &'a Interrupt,
}

impl<const D: usize> Stream<'_, D> {
    /// Writes the answers, batch by batch, and returns for how many points. An interrupted run
    /// ends after a whole row.
    fn evaluate(&self, out: &mut dyn Write) -> Result<(Outcome, usize), Failure> {
        let mut table = Table::open(self.points)?;
        let columns = coordinates::<D>(&table, &format!("a point in {D}D"), &[])?;
        let size = std::fs::metadata(self.points).map_or(0, |metadata| metadata.len());
        let bar = bar(size);
        self.interrupt.heed();
        if !self.as_json {
            writeln!(out, "{}", answer::header::<D>().join(","))?;
        }
        let mut batch: Vec<Point<D>> = Vec::with_capacity(BATCH);
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
                let answers = |points| answers(self.shape, points, self.as_json);
                batch.par_chunks(BLOCK).map(answers).collect()
            });
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
        while batch.len() < BATCH && !self.interrupt.is_asked() && table.advance()? {
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

/// The lines for up to a block of points. A point's line depends only on the point, so any
/// number of threads writes the same bytes.
fn answers<const D: usize>(shape: &Shape<D>, points: &[Point<D>], as_json: bool) -> String {
    let mut block = Block::<f64, D, BLOCK>::zero();
    let mut found = Gradients::<f64, D, BLOCK>::zero();
    for (i, point) in points.iter().enumerate() {
        block.set(i, *point);
    }
    shape.block_gradients(&block, points.len(), &mut found);
    let mut text = String::new();
    for (i, point) in points.iter().enumerate() {
        let slope = (found.distance.get(i), found.gradient.get(i));
        let answer = AtPoint::of_slope(shape, *point, slope);
        if as_json {
            text.push_str(&answer::to_json(&answer).to_string());
        } else {
            text.push_str(&answer::row(&answer).join(","));
        }
        text.push('\n');
    }
    text
}
