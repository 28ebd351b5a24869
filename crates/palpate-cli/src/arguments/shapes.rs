// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate shapes`.

use clap::{Args, ValueEnum};

pub(super) const EXAMPLES: &str = "Examples:\n  palpate shapes\n  palpate shapes --json";

/// The options of `palpate shapes`.
#[derive(Args, Debug)]
pub(crate) struct ShapesOptions {
    /// List only the primitives of this dimension.
    #[arg(long, value_enum)]
    pub(crate) dimension: Option<Dimension>,
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
