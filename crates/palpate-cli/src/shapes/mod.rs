// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate shapes`: the primitives.

use std::fmt;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use palpate::field::catalogue::Entry;
use palpate::scene::described_primitive;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::arguments::numbers::count;
use crate::outcome::{Failure, Outcome};
use crate::output;

mod drawing;
mod named;

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
    let mut primitives = Vec::new();
    if options.dimension != Some(Dimension::Three) {
        primitives.extend(list(Entry::<2>::ALL)?);
    }
    if options.dimension != Some(Dimension::Two) {
        primitives.extend(list(Entry::<3>::ALL)?);
    }
    output::answer().print(&Answer { primitives }, options.json)?;
    Ok(Outcome::Yes)
}

fn list<const D: usize>(entries: &[Entry<D>]) -> Result<Vec<Primitive>, Failure> {
    entries.iter().map(Primitive::of).collect()
}

/// The answer of `palpate shapes`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The primitives; with a name, one for each dimension that has it.
    pub(crate) primitives: Vec<Primitive>,
}

/// A primitive of the catalogue.
#[derive(Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Primitive {
    /// Its name in scenes.
    pub(crate) name: String,
    /// 2 for the plane, 3 for space.
    pub(crate) dimension: usize,
    /// A sentence about it.
    pub(crate) about: String,
    /// Where its origin is.
    pub(crate) origin: String,
    /// Its parameters, in their order.
    pub(crate) parameters: Vec<Parameter>,
    /// What its distance promises, in words.
    pub(crate) promise: String,
    /// What its distance promises outside: `exact`, `bound` or `lipschitz`.
    pub(crate) outside: String,
    /// What its distance promises inside: `exact`, `bound` or `lipschitz`.
    pub(crate) inside: String,
    /// The steepest slope of its distance.
    pub(crate) lipschitz: f64,
    /// `true` if the example is convex.
    pub(crate) convex: bool,
    /// `true` if the example has a box around it.
    pub(crate) bounded: bool,
    /// A shape as scenes write it.
    pub(crate) example: Value,
    /// The picture that was written.
    #[serde(default)]
    pub(crate) output: Option<String>,
}

/// A parameter of a primitive.
#[derive(Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Parameter {
    /// Its key in scenes.
    pub(crate) key: String,
    /// The unit of its numbers; empty for a number without one.
    pub(crate) unit: String,
    /// A sentence about it.
    pub(crate) about: String,
}

impl Primitive {
    fn of<const D: usize>(entry: &Entry<D>) -> Result<Self, Failure> {
        let described = described_primitive(entry).map_err(Failure::input)?;
        let mut primitive: Self = serde_json::from_value(described).map_err(Failure::input)?;
        primitive.outside.make_ascii_lowercase();
        primitive.inside.make_ascii_lowercase();
        Ok(primitive)
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.primitives.iter().try_for_each(|primitive| primitive.fmt(f))?;
        writeln!(f, "{} primitives", self.primitives.len())
    }
}

impl fmt::Display for Primitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} ({}D): {}", self.name, self.dimension, self.about)?;
        for Parameter { key, unit, about } in &self.parameters {
            let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
            writeln!(f, "    {key}{unit}: {about}")?;
        }
        writeln!(f, "    origin: {}", self.origin)?;
        writeln!(f, "    promise: {}", self.promise)
    }
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate shapes
  palpate shapes capped_cone
  palpate shapes capped_cone --output capped_cone.svg
  palpate shapes --dimension 2 --json";

/// The options of `palpate shapes`.
#[derive(Args, Debug)]
pub(crate) struct ShapesOptions {
    /// The primitive to describe; all if left out.
    #[arg(value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Only the primitives of this dimension.
    #[arg(long, value_enum)]
    pub(crate) dimension: Option<Dimension>,
    /// Draw the primitive with its parameters: an SVG or PNG file.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// The width of a PNG [pixels]; 1200 if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(64, 16384_u32))]
    pub(crate) width: Option<u32>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Dimension {
    /// The plane.
    #[value(name = "2")]
    Two,
    /// Space.
    #[value(name = "3")]
    Three,
}
