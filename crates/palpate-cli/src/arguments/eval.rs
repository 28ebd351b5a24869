// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate eval`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::count;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate eval scenes/s3.json --at 0.1,0.5,-0.2
  palpate eval scenes/memoir_star.json --at 0.3,0 --json
  palpate eval scenes/s3.json --points points.csv --output distances.csv
  palpate eval scenes/memoir_star.json --at 1.35,0.8 --radius 0.1

The points file has the header x_m,y_m,z_m (x_m,y_m in 2D). With --at and --radius the exit status
is 0 if the ball meets the scene, and 1 if it does not or that is undecided.";

/// The options of `palpate eval`.
#[derive(Args, Debug)]
pub(crate) struct EvalOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// One point, its coordinates joined by commas [m].
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    pub(crate) at: Option<String>,
    /// Many points, from a CSV file.
    #[arg(long, value_name = "CSV", conflicts_with = "at")]
    pub(crate) points: Option<PathBuf>,
    /// Also ask whether a ball of this radius about each point meets the scene [m].
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) radius: Option<f64>,
    /// The file for the answers to many points; standard output if left out.
    #[arg(long, value_name = "FILE", requires = "points", conflicts_with = "at")]
    pub(crate) output: Option<PathBuf>,
    /// The number of threads; as many as the machine has if left out. Answers have the same
    /// bits for any number.
    #[arg(long, requires = "points", conflicts_with = "at", allow_negative_numbers = true, value_parser = count(1, 1_000_000_usize))]
    pub(crate) threads: Option<usize>,
    /// Print JSON: one object, or one per line for many points.
    #[arg(long)]
    pub(crate) json: bool,
}
