// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate shapes`: lists the primitives of the catalogue, or describes and draws one.

mod drawing;
mod named;
mod planes;

use std::io::Write;

use palpate::field::catalogue::Entry;
use palpate::scene::described_primitive;
use serde_json::Value;

use crate::arguments::{Dimension, ShapesOptions};
use crate::outcome::{Failure, Outcome};
use crate::output;

pub(crate) fn run(options: &ShapesOptions) -> Result<Outcome, Failure> {
    if let Some(name) = &options.name {
        return named::run(options, name);
    }
    if options.output.is_some() || options.width.is_some() {
        let option = if options.output.is_some() { "--output" } else { "--width" };
        let example = "palpate shapes torus --output torus.svg";
        let problem = format!("{option} is for the picture of one primitive: {example}");
        return Err(Failure::input(problem));
    }
    let mut rows = Vec::new();
    if options.dimension != Some(Dimension::Three) {
        rows.extend(list(Entry::<2>::ALL)?);
    }
    if options.dimension != Some(Dimension::Two) {
        rows.extend(list(Entry::<3>::ALL)?);
    }
    let mut out = output::answer();
    if options.json {
        out.json(&Value::Array(rows))?;
        return Ok(Outcome::Yes);
    }
    rows.iter().try_for_each(|row| say(&mut out, row))?;
    writeln!(out, "{} primitives", rows.len())?;
    Ok(Outcome::Yes)
}

fn list<const D: usize>(entries: &[Entry<D>]) -> Result<Vec<Value>, Failure> {
    let described = |entry| described_primitive(entry).map_err(Failure::input);
    entries.iter().map(described).collect()
}

/// Prints a [`described_primitive`].
fn say(out: &mut impl Write, row: &Value) -> Result<(), Failure> {
    let text = |key: &str| row[key].as_str().unwrap_or_default().to_owned();
    writeln!(out, "{} ({}D): {}", text("name"), row["dimension"], text("about"))?;
    for parameter in row["parameters"].as_array().into_iter().flatten() {
        let text = |key: &str| parameter[key].as_str().unwrap_or_default().to_owned();
        let unit = match text("unit").as_str() {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        writeln!(out, "    {}{unit}: {}", text("key"), text("about"))?;
    }
    writeln!(out, "    origin: {}", text("origin"))?;
    writeln!(out, "    promise: {}", text("promise"))?;
    Ok(())
}
