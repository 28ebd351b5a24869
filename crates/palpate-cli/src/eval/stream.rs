// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points from a file, in bounded memory and on all cores.

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
) -> Result<Outcome, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads(options.threads)).build();
    let pool = pool.map_err(Failure::input)?;
    destination.write(|out| evaluate(shape, points, (options.json, &pool), out))?;
    Ok(Outcome::Yes)
}

/// As many threads as are asked for, but no more than the machine runs at once: others would
/// wait, each with a batch in memory. Zero stands for all.
fn threads(asked: Option<usize>) -> usize {
    let asked = asked.unwrap_or(0);
    let most = std::thread::available_parallelism().map_or(1, NonZero::get);
    if asked > most {
        output::remark(format_args!("--threads {asked}: this machine runs {most} at once"));
    }
    asked.min(most)
}

fn evaluate<const D: usize>(
    shape: &Shape<D>,
    path: &Path,
    (as_json, pool): (bool, &rayon::ThreadPool),
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let file = File::open(path).map_err(|error| Failure::file(path, error))?;
    let size = file.metadata().map(|m| m.len()).unwrap_or(0);
    // Shown on a terminal alone; hidden where standard error is a file.
    let bar = ProgressBar::new(size).with_style(
        ProgressStyle::with_template("{bar:40} {percent} % of {total_bytes}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
    let header = reader.headers().map_err(|error| Failure::file(path, error))?;
    let columns = columns::<D>(header, "").map_err(|problem| Failure::file(path, problem))?;
    if !as_json {
        writeln!(out, "{}", answer::header::<D>().join(","))?;
    }
    let mut record = StringRecord::new();
    let mut batch: Vec<Point<D>> = Vec::with_capacity(BATCH);
    loop {
        batch.clear();
        while batch.len() < BATCH
            && reader.read_record(&mut record).map_err(|error| Failure::file(path, error))?
        {
            let line = record.position().map_or(0, csv::Position::line);
            let point = columns.map(|column| number(&record, column));
            match point.iter().position(Option::is_none) {
                None => batch.push(Vector(point.map(Option::unwrap_or_default))),
                Some(axis) => {
                    let field = record.get(columns[axis]).unwrap_or_default();
                    let problem =
                        format!("line {line}: a finite number is needed, got {field:?}");
                    return Err(Failure::file(path, problem));
                }
            }
        }
        if batch.is_empty() {
            break;
        }
        let texts: Vec<String> = pool.install(|| {
            batch.par_chunks(BLOCK).map(|points| answers(shape, points, as_json)).collect()
        });
        for text in texts {
            out.write_all(text.as_bytes())?;
        }
        bar.set_position(reader.position().byte());
    }
    bar.finish_and_clear();
    Ok(())
}

/// A finite number of at most the size that shapes are made for.
fn number(record: &StringRecord, column: usize) -> Option<f64> {
    let number: f64 = record.get(column)?.parse().ok()?;
    (number.abs() <= palpate::field::LARGEST_LENGTH).then_some(number)
}

/// The lines for up to a block of points. What a point's line says depends on the
/// point alone, so any number of threads writes the same bytes.
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
