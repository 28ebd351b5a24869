// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate shapes`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::numbers::count;

pub(super) const EXAMPLES: &str = "\
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
