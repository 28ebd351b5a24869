// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Makes `testdata/recall`: what `cargo xtask oracle` runs.
//!
//! With the name of a pair, prints its rows instead and how long they took; with `all`,
//! what there is of every pair.

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
    println!("{}: {} rows", <Space as Turned<D>>::FILE, text.lines().count() - 1);
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
        let apart = rows.iter().filter(|row| row.truth.lower > 0.0).count();
        let (drawn, all) = (rows.len(), pair.rows);
        let seconds = start.elapsed().as_secs_f64();
        println!("{}: {drawn} of {all} rows, {apart} apart, {seconds:.1} s", pair.name);
    }
}
