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
  palpate devices --profile falcon.json
  palpate devices --stability --profile omega --material steel --material rubber";

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
    /// How hands rest on walls where devices have other damping, friction, encoder steps and delays
    /// than their profiles say: the worst of 108 presses of ten simulated seconds at 1 kHz for each
    /// device, material and delay.
    #[arg(long, conflicts_with_all = ["materials", "actuators"])]
    pub(crate) stability: bool,
    /// A material by name of which the walls are; may be given several times.
    #[arg(long, value_name = "NAME", requires = "stability", conflicts_with_all = ["materials", "actuators"], default_values = ["steel"])]
    pub(crate) material: Vec<String>,
    /// One device in place of all: its name, or a JSON file with its profile.
    #[arg(long, value_name = "NAME|JSON", conflicts_with = "actuators")]
    pub(crate) profile: Option<ProfileChoice>,
    /// Ticks a second, on which what devices render of materials depends [Hz].
    #[arg(long, requires = "materials", conflicts_with_all = ["stability", "actuators"], default_value = "1000", allow_negative_numbers = true, value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
