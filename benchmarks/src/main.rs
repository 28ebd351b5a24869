// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! palpate and its peers, side by side in one run.
//!
//! Every row has a key of its own, `WORK.SUBJECT.CASE.STAT`; `README.md` beside
//! this package lists them. Machines differ and are shared: quote ratios.

mod bars;
mod collide;
mod compare;
mod fields;
mod haptics;
mod live;
mod mujoco;
mod peers;
mod python;
mod random;
mod reference;
mod rounds;
mod sampled;
mod scenes;

use std::error::Error;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use mimalloc::MiMalloc;
use palpate::field::InstructionSet;

/// That of the program `palpate`, for all subjects.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// Measures palpate beside its peers.
#[derive(Debug, Parser)]
#[command(name = "palpate-bench")]
struct Arguments {
    #[command(subcommand)]
    suite: Suite,
    /// The vector instructions that our fields use; the widest of the machine unless told.
    #[arg(long, global = true)]
    instructions: Option<Instructions>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Instructions {
    Baseline,
    Avx2,
    Avx512,
}

impl Instructions {
    /// Uses these from now on.
    fn select(self) -> Result<(), String> {
        let set = match self {
            Self::Baseline => InstructionSet::Baseline,
            Self::Avx2 => InstructionSet::Avx2,
            Self::Avx512 => InstructionSet::Avx512,
        };
        if set.select() { Ok(()) } else { Err(format!("this machine has no {set:?}")) }
    }
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
        /// One part of the suite alone.
        #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(collide::parts()))]
        only: Option<String>,
        #[command(flatten)]
        runs: Runs,
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
    /// Meshes beside parry's, and grids.
    Sampled {
        /// Measure beside libigl, MeshLib and Open3D too; needs Python and its package index once.
        #[arg(long)]
        peers: bool,
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
    /// Suites of this program beside those of another revision; status 1 if a key got slower.
    Compare(compare::Comparison),
    /// Ticks of the servo.
    Haptics {
        #[command(flatten)]
        runs: Runs,
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
    /// How late the servo of the live page is, quiet and under clients that misuse it.
    Live {
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
    /// Overlaps of known depth, beside MuJoCo; needs Python and its package index once.
    Mujoco {
        #[command(flatten)]
        options: mujoco::Options,
        /// Print one JSON object of keys and numbers.
        #[arg(long)]
        json: bool,
    },
}

#[derive(Clone, Copy, Debug, Args)]
struct Runs {
    /// How often the suite runs; of each row the median counts.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    runs: u32,
}

fn main() -> ExitCode {
    let Arguments { suite, instructions } = Arguments::parse();
    if let Some(Err(error)) = instructions.map(Instructions::select) {
        eprintln!("palpate-bench: {error}");
        return ExitCode::FAILURE;
    }
    match measure(suite, instructions) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("palpate-bench: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Measures what is asked, and prints it.
fn measure(
    suite: Suite,
    instructions: Option<Instructions>,
) -> Result<ExitCode, Box<dyn Error>> {
    let (rows, bars, is_part, json) = match suite {
        Suite::Fields { json } => (fields::measure()?, bars::FIELDS, false, json),
        Suite::Collide { json, only, runs: Runs { runs } } => {
            (collide::measure(only.as_deref(), runs)?, bars::COLLIDE, only.is_some(), json)
        }
        Suite::Haptics { json, runs: Runs { runs } } => {
            (haptics::measure(runs)?, bars::HAPTICS, false, json)
        }
        Suite::Sampled { peers, json } => {
            (sampled::measure(peers)?, bars::SAMPLED, !peers, json)
        }
        Suite::Live { json } => (live::measure()?, bars::LIVE, false, json),
        Suite::Mujoco { options, json } => {
            let (rows, is_part) = (mujoco::measure(&options, json)?, options.is_part());
            if json {
                bars::print(&rows.unwrap_or_default(), bars::MUJOCO, is_part, json);
            } else if let Some(rows) = rows {
                // The table has the rows.
                bars::print_standing(&rows, bars::MUJOCO, is_part);
            }
            return Ok(ExitCode::SUCCESS);
        }
        Suite::Compare(comparison) => return comparison.run(instructions),
    };
    bars::print(&rows, bars, is_part, json);
    Ok(ExitCode::SUCCESS)
}
