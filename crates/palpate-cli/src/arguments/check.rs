// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate check`.

use std::path::PathBuf;

use clap::Args;

pub(super) const EXAMPLES: &str =
    "Examples:\n  palpate check scenes/cup.json\n  palpate check scenes/cup.json --json";

/// The options of `palpate check`.
#[derive(Args, Debug)]
pub(crate) struct CheckOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
