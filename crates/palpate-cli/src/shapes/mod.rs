// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate shapes`: lists the primitives of the catalogue, or describes and draws one.

mod drawing;
mod named;
mod planes;

use std::io::Write;

use palpate::field::catalogue::Entry;
use palpate::field::kernel::{Parameter, ParameterKind};
use palpate::field::{Promise, Unit};
use palpate::scene::WrittenShape;
use serde_json::{Value, json};

use crate::arguments::{Dimension, ShapesOptions};
use crate::input::{promise_in_words, quality_in_words};
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
    entries.iter().map(described).collect()
}

fn described<const D: usize>(entry: &Entry<D>) -> Result<Value, Failure> {
    let example = entry.example().map_err(Failure::input)?;
    let promise: &Promise<D> = example.promise();
    Ok(json!({
        "name": entry.name,
        "dimension": D,
        "about": entry.about,
        "origin": entry.origin,
        "parameters": entry.parameters.iter().map(parameter).collect::<Vec<_>>(),
        "promise": promise_in_words(promise),
        "outside": quality_in_words(promise.outside),
        "inside": quality_in_words(promise.inside),
        "lipschitz": promise.lipschitz,
        "convex": promise.convex,
        "bounded": promise.bounds.is_some(),
        "example": WrittenShape::of(&example).map_err(Failure::input)?,
    }))
}

/// A parameter as scene files write it: angles in degrees, with a key that ends in `_degrees`.
fn parameter(parameter: &Parameter) -> Value {
    let is_angle = parameter.kind == ParameterKind::Angle;
    let key = if is_angle {
        format!("{}_degrees", parameter.name)
    } else {
        parameter.name.to_owned()
    };
    let unit = match parameter.kind.unit() {
        Unit::Radian => "degrees",
        unit => unit.symbol(),
    };
    json!({ "key": key, "unit": unit, "about": parameter.about })
}

/// Prints what [`described`] says.
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
