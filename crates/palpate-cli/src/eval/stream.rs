// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points from a file, in bounded memory and on all cores.

use std::fmt;
use std::fs::File;
use std::io::Write;
use std::num::NonZero;
use std::path::Path;

use csv::StringRecord;
use indicatif::{ProgressBar, ProgressStyle};
use palpate::field::{BLOCK, Block, Gradients, Point, Shape, Vector};
use palpate::query::AtPoint;
use rayon::prelude::*;

use super::answer;
use crate::arguments::EvalOptions;
use crate::hand_csv::columns;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination};

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
/// would wait, each with a batch in memory. Zero means as many as the machine runs.
fn threads(asked: Option<usize>) -> usize {
    let asked = asked.unwrap_or(0);
    let most = std::thread::available_parallelism().map_or(1, NonZero::get);
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

/// The rows of a file that are still to be read.
struct Rows<const D: usize> {
    reader: csv::Reader<File>,
    /// The columns of the coordinates.
    columns: [usize; D],
    record: StringRecord,
}

impl<const D: usize> Stream<'_, D> {
    /// Writes the answers, batch by batch, and returns for how many points. An interrupted run
    /// ends after a whole row.
    fn evaluate(&self, out: &mut dyn Write) -> Result<(Outcome, usize), Failure> {
        let file = File::open(self.points).map_err(|error| self.wrong(error))?;
        let bar = bar(file.metadata().map(|metadata| metadata.len()).unwrap_or(0));
        let mut rows = self.rows(file)?;
        self.interrupt.heed();
        if !self.as_json {
            writeln!(out, "{}", answer::header::<D>().join(","))?;
        }
        let mut batch: Vec<Point<D>> = Vec::with_capacity(BATCH);
        let mut done = 0;
        loop {
            // Flushed, so that a reader of a pipe sees every finished batch.
            out.flush()?;
            self.read(&mut rows, &mut batch)?;
            if self.interrupt.is_asked() {
                return Ok((Outcome::Interrupted, done));
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
            bar.set_position(rows.reader.position().byte());
        }
    }

    fn rows(&self, file: File) -> Result<Rows<D>, Failure> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
        let header = reader.headers().map_err(|error| self.wrong(error))?;
        let columns = columns::<D>(header).map_err(|problem| self.wrong(problem))?;
        Ok(Rows { reader, columns, record: StringRecord::new() })
    }

    /// Reads the next batch, which is shorter at the end of the file and if interrupted.
    fn read(&self, rows: &mut Rows<D>, batch: &mut Vec<Point<D>>) -> Result<(), Failure> {
        let Rows { reader, columns, record } = rows;
        batch.clear();
        while batch.len() < BATCH
            && !self.interrupt.is_asked()
            && reader.read_record(record).map_err(|error| self.wrong(error))?
        {
            let line = record.position().map_or(0, csv::Position::line);
            let point = columns.map(|column| number(record, column));
            match point.iter().position(Option::is_none) {
                None => batch.push(Vector(point.map(Option::unwrap_or_default))),
                Some(axis) => {
                    let field = record.get(columns[axis]).unwrap_or_default();
                    let rule = "a coordinate must be a finite number";
                    return Err(self.wrong(format!("line {line}: {rule}, got {field:?}")));
                }
            }
        }
        Ok(())
    }

    fn wrong(&self, problem: impl fmt::Display) -> Failure {
        Failure::file(self.points, problem)
    }
}

/// The progress bar, which is hidden unless standard error is a terminal.
fn bar(size: u64) -> ProgressBar {
    ProgressBar::new(size).with_style(
        ProgressStyle::with_template("{bar:40} {percent} % of {total_bytes}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}

/// A finite number of at most the size that shapes are made for.
fn number(record: &StringRecord, column: usize) -> Option<f64> {
    let number: f64 = record.get(column)?.parse().ok()?;
    (number.abs() <= palpate::field::LARGEST_LENGTH).then_some(number)
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
        let (distance, gradient) = (found.distance.get(i), found.gradient.get(i));
        let answer = AtPoint::of_slope(shape, *point, distance, gradient);
        if as_json {
            text.push_str(&answer::to_json(&answer).to_string());
        } else {
            text.push_str(&answer::row(&answer).join(","));
        }
        text.push('\n');
    }
    text
}
