// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Makes `testdata/recall`: what `cargo xtask oracle` runs.
//!
//! With the name of a pair, prints its rows instead, and how long they took.

use std::error::Error;
use std::fmt::Write as _;
use std::time::Instant;

use indicatif::ProgressBar;
use palpate_testkit::kernels::Space;
use palpate_testkit::recall::{Pair, Row, Turned, draw, folder, in_space, in_the_plane};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    if let Some(name) = std::env::args().nth(1) {
        show(&in_space()?, &name);
        show(&in_the_plane()?, &name);
        return Ok(());
    }
    std::fs::create_dir_all(folder())?;
    write(&in_the_plane()?)?;
    write(&in_space()?)
}

/// All rows of a pair, in the order of their slots.
fn rows<const D: usize>(pair: &Pair<D>, bar: &ProgressBar) -> Vec<Row<D>>
where
    Space: Turned<D>,
{
    let slots = (0..pair.rows as u64).into_par_iter();
    slots.map(|slot| draw(pair, slot)).inspect(|_| bar.inc(1)).flatten().collect()
}

fn write<const D: usize>(pairs: &[Pair<D>]) -> Result<(), Box<dyn Error>>
where
    Space: Turned<D>,
{
    let path = folder().join(<Space as Turned<D>>::FILE);
    let bar = ProgressBar::new(pairs.iter().map(|pair| pair.rows as u64).sum());
    let mut text = format!("{}\n", <Space as Turned<D>>::COLUMNS);
    for pair in pairs {
        for row in rows(pair, &bar) {
            writeln!(text, "{row}")?;
        }
    }
    bar.finish_and_clear();
    std::fs::write(&path, &text)?;
    println!("{}: {} rows", path.display(), text.lines().count() - 1);
    Ok(())
}

fn show<const D: usize>(pairs: &[Pair<D>], name: &str)
where
    Space: Turned<D>,
{
    for pair in pairs.iter().filter(|pair| name == "all" || pair.name == name) {
        let start = Instant::now();
        let rows = rows(pair, &ProgressBar::hidden());
        if name != "all" {
            rows.iter().for_each(|row| println!("{row}"));
        }
        let drawn = rows.len();
        let least = |sign: f64| {
            let gaps = rows.iter().map(|row| sign * row.truth.upper).filter(|gap| *gap > 0.0);
            (gaps.clone().count(), gaps.fold(f64::INFINITY, f64::min))
        };
        let loose = rows.iter().filter(|row| !row.truth.is_within(0.06)).count();
        let attempts: u64 = rows.iter().map(|row| row.seed % 100 + 1).sum();
        println!(
            "{}: {drawn} of {} rows, {:?} apart, {:?} overlap, {loose} loose, {:.1} attempts each, {:.1} s",
            pair.name,
            pair.rows,
            least(1.0),
            least(-1.0),
            attempts as f64 / drawn as f64,
            start.elapsed().as_secs_f64()
        );
    }
}
