// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::{count, positive, within};

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate mass scenes/cup.json
  palpate mass scenes/cup.json --density 7850 --tolerance 1e-4 --json

Second moments are the integrals of density times products of coordinates about the
centroid; the inertia tensor is their trace times the identity, minus the second moments.
In 2D a body is one metre thick. Status 1 if the error of a volume stays above the tolerance,
or a body has none because it is endless.";

/// The options of `palpate mass`.
#[derive(Args, Debug)]
pub(crate) struct MassOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The density of all bodies [kg/m³].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = within(1e-15, 1e15, "kg/m³"))]
    pub(crate) density: f64,
    /// The relative error of the volume at which to stop.
    #[arg(long, allow_negative_numbers = true, default_value = "0.001", value_parser = positive(""))]
    pub(crate) tolerance: f64,
    /// The budget: the most cells, up to 100 million; a million take 160 MB.
    #[arg(long, allow_negative_numbers = true, default_value = "3000000", value_parser = count(1, 100_000_000_usize))]
    pub(crate) cells: usize,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
