// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate devices`.

use clap::Args;

pub(super) const EXAMPLES: &str = "Examples:\n  palpate devices\n  palpate devices --json";

/// The options of `palpate devices`.
#[derive(Args, Debug)]
pub(crate) struct DevicesOptions {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
