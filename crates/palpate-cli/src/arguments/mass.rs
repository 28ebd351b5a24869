// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`.

use std::path::PathBuf;

use clap::Args;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate mass scenes/cup.json
  palpate mass scenes/cup.json --density 7850 --tolerance 1e-4 --json

Second moments are the integrals of density times products of coordinates about the
centroid; the inertia tensor is their trace times the identity, minus the second moments.
In 2D a body is one metre thick. Status 1 if the error of a volume stays above the tolerance.";

/// The options of `palpate mass`.
#[derive(Args, Debug)]
pub(crate) struct MassOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The density of all bodies [kg/m³].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) density: f64,
    /// The relative error of the volume at which to stop.
    #[arg(long, default_value_t = 1e-3)]
    pub(crate) tolerance: f64,
    /// The budget: the most cells; a million take 160 MB.
    #[arg(long, default_value_t = 3_000_000)]
    pub(crate) cells: usize,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
