// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate identify`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::{count, positive, within, zero_or_more};
use super::profile::ProfileChoice;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate identify --device omega
  palpate identify --device touch --plant-damping 0.3 --plant-friction 3
  palpate identify --device falcon --plant-mass 1.5 --out falcon.json
  palpate feel --device simulated:falcon.json";

/// The options of `palpate identify`.
#[derive(Args, Debug)]
pub(crate) struct IdentifyOptions {
    /// The device, simulated: a name of `palpate devices`, or a JSON file with a profile.
    #[arg(long, value_name = "NAME|JSON")]
    pub(crate) device: ProfileChoice,
    /// What the simulated device is made of, in place of its profile: mass, damping, friction and
    /// encoder step of another one, by name or from a file.
    #[arg(long, value_name = "NAME|JSON")]
    pub(crate) plant: Option<ProfileChoice>,
    /// Its mass and moment of inertia, over those of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = positive(""))]
    pub(crate) plant_mass: f64,
    /// Its damping, over that of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = zero_or_more(""))]
    pub(crate) plant_damping: f64,
    /// Its friction, over that of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = zero_or_more(""))]
    pub(crate) plant_friction: f64,
    /// Its encoder steps, over those of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = zero_or_more(""))]
    pub(crate) plant_encoder_step: f64,
    /// A simulated hand that holds the handle by this stiffness [N/m], to see that it is noticed: from
    /// a fifth of the friction at the end of the travel; no hand if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("N/m"))]
    pub(crate) grip: Option<f64>,
    /// Ticks a second, from 500 to 10000 [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = within(500.0, 10_000.0, "Hz"))]
    pub(crate) rate: f64,
    /// The farthest that the handle moves from its start, from 0.0001 to 0.05 [m]. The handle is
    /// stopped at 200 times this in a second, 1 m/s for 0.005 m, so encoder steps set a least travel.
    #[arg(long, allow_negative_numbers = true, default_value = "0.005", value_parser = within(1e-4, 0.05, "m"))]
    pub(crate) travel: f64,
    /// The largest part of the largest force that pushes, from 0.01 to 1.
    #[arg(long, value_name = "PART", allow_negative_numbers = true, default_value = "0.3", value_parser = within(0.01, 1.0, ""))]
    pub(crate) force_part: f64,
    /// Shifts the lengths of the strokes: a whole number from 0 to 18446744073709551615.
    #[arg(long, allow_negative_numbers = true, default_value = "0", value_parser = count(0, u64::MAX))]
    pub(crate) seed: u64,
    /// Write the profile with what was found to this file, whose name ends in .json.
    #[arg(long, value_name = "JSON")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
