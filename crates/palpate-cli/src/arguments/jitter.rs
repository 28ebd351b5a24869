// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate jitter`.

use clap::Args;

use super::numbers::positive;

pub(super) const EXAMPLES: &str =
    "Examples:\n  palpate jitter\n  palpate jitter --rate 4000 --duration 20 --json";

/// The options of `palpate jitter`.
#[derive(Args, Debug)]
pub(crate) struct JitterOptions {
    /// Ticks a second, at most 10 kHz [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// How long to measure in all, shared by the ways to wait [s]: each has at least a tick.
    #[arg(long, allow_negative_numbers = true, default_value = "5", value_parser = positive("s"))]
    pub(crate) duration: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
