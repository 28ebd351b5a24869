// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! palpate and its peers, side by side in one run.
//!
//! Every row has a key of its own, `WORK.SUBJECT.CASE.STAT`; `README.md` beside
//! this package lists them. Machines differ and are shared: quote ratios.

mod bars;
mod collide;
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
    /// Searches that prove where things touch.
    Collide {
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
}

fn main() -> ExitCode {
    let (measured, bars, json) = match Arguments::parse().suite {
        Suite::Fields { json } => (fields::measure(), bars::FIELDS, json),
        Suite::Collide { json } => (collide::measure(), bars::COLLIDE, json),
    };
    match measured {
        Ok(rows) => {
            bars::print(&rows, bars, json);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("palpate-bench: {error}");
            ExitCode::FAILURE
        }
    }
}
