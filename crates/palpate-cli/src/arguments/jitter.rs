// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate jitter`.

use clap::Args;

pub(super) const EXAMPLES: &str =
    "Examples:\n  palpate jitter\n  palpate jitter --rate 4000 --duration 20 --json";

/// The options of `palpate jitter`.
#[derive(Args, Debug)]
pub(crate) struct JitterOptions {
    /// Ticks a second, at most 10 kHz [Hz].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) rate: f64,
    /// How long to measure in all, shared by the ways to wait [s].
    #[arg(long, default_value_t = 5.0)]
    pub(crate) duration: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
