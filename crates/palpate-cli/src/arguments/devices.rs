// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate devices`.

use clap::Args;

use super::ProfileChoice;
use super::numbers::positive;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate devices
  palpate devices --json
  palpate devices --actuators
  palpate devices --materials --rate 4000
  palpate devices --profile falcon.json";

/// The options of `palpate devices`.
#[derive(Args, Debug)]
pub(crate) struct DevicesOptions {
    /// What each device with forces renders of each material by name: stiffness [N/m] / damping
    /// [N·s/m].
    #[arg(long)]
    pub(crate) materials: bool,
    /// The actuators for `palpate feel --actuator` alone.
    #[arg(long, conflicts_with = "materials")]
    pub(crate) actuators: bool,
    /// One device in place of all: its name, or a JSON file with its profile.
    #[arg(long, value_name = "NAME|JSON", conflicts_with = "actuators")]
    pub(crate) profile: Option<ProfileChoice>,
    /// Ticks a second, on which that depends [Hz].
    #[arg(long, requires = "materials", default_value = "1000", allow_negative_numbers = true, value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
