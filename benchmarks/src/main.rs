// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! palpate and its peers, side by side in one run.
//!
//! Every row has a key of its own, `WORK.SUBJECT.CASE.STAT`; `README.md` beside
//! this package lists them. Machines differ and are shared: quote ratios.

mod bars;
mod fields;
mod peers;
mod random;
mod rounds;
mod scenes;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Measures palpate beside its peers.
#[derive(Debug, Parser)]
#[command(name = "palpate-bench")]
struct Arguments {
    #[command(subcommand)]
    suite: Suite,
}

#[derive(Debug, Subcommand)]
enum Suite {
    /// Distances, gradients and models of fields.
    Fields {
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
}

fn main() -> ExitCode {
    let Suite::Fields { json } = Arguments::parse().suite;
    match fields::measure() {
        Ok(rows) => {
            bars::print(&rows, json);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("palpate-bench: {error}");
            ExitCode::FAILURE
        }
    }
}
