// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate feel`.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Parser, ValueEnum};
use palpate::device::PROFILES;
use palpate::safety::{Acceptance, Recovery};
use palpate::scene::unknown_name;
use palpate::vibration::{ACTUATORS, Actuator, actuator_named};

use super::numbers::{count, length, length_or_zero, positive, within, zero_or_more};
use super::{PageOptions, ProfileChoice};

/// The most contact points: more than any device has.
const MOST_CONTACTS: usize = 1000;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate feel
  palpate feel scenes/cup.json --duration 5 --trace touch.csv --plot touch.png
  palpate feel scenes/cup.json --path hand.csv --rate 2000
  palpate feel --points 10 --fast --json
  palpate feel --device glove --wav glove.wav --actuator lra";

/// The options of `palpate feel`.
#[derive(Args, Debug)]
pub(crate) struct FeelOptions {
    /// The scene file; the built-in gallery if left out.
    pub(crate) scene: Option<PathBuf>,
    /// Ticks a second [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// How long to feel [s]; the length of the hand path, or else 10 s, if left out. A built-in tour
    /// is made for that time: with less, the hand is faster.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) duration: Option<f64>,
    /// The hand's path, with the columns time_s,x_m,y_m[,z_m] and optionally point; a built-in
    /// tour of the bodies if left out. A path of one contact point carries all those of the
    /// scene's tool.
    #[arg(long, value_name = "CSV")]
    pub(crate) path: Option<PathBuf>,
    /// What the hand holds: recorded (the hand follows its path whatever the force),
    /// simulated:NAME (a device of `palpate devices`, or of a JSON file as `palpate identify`
    /// writes it, with its limits, in a hand that yields; one with rotation, such as sigma7, turns
    /// a tool with a shape), or glove (no force
    /// feedback). If left out, simulated:omega on the built-in gallery, else recorded.
    #[arg(long)]
    pub(crate) device: Option<DeviceChoice>,
    /// The number of contact points of the built-in hand; if left out, that of the scene's
    /// tool, 10 on the built-in gallery, or else 1. Not for a tool with a shape.
    #[arg(long, alias = "contacts", allow_negative_numbers = true, value_parser = count(1, MOST_CONTACTS))]
    pub(crate) points: Option<usize>,
    /// What a simulated device renders of materials; what the scene says, or else device, if left
    /// out.
    #[arg(long, value_enum)]
    pub(crate) acceptance: Option<AcceptanceChoice>,
    /// How a force comes back after a start in a body, or after the device was lost: rise, by 20 N/s,
    /// or once-out, when no body pushes the hand any more. After late ticks it always rises.
    #[arg(long, value_enum, default_value_t = RecoveryChoice::Rise, hide_default_value = true)]
    pub(crate) recovery: RecoveryChoice,
    /// Refuse bodies, a tool and guides of which a simulated device renders less than all. A glove,
    /// which has no forces, takes neither this nor the options of stiffness, damping, acceptance,
    /// recovery and force.
    #[arg(long)]
    pub(crate) strict: bool,
    /// Stiffness of the surface [N/m]; that of each body if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = zero_or_more("N/m"))]
    pub(crate) stiffness: Option<f64>,
    /// Stiffness of the surface as a part of what a simulated device renders, up to 1; for a device
    /// without limits, that of each body counts.
    #[arg(long, value_name = "PART", conflicts_with = "stiffness", allow_negative_numbers = true, value_parser = within(1e-6, 1.0, ""))]
    pub(crate) relative_stiffness: Option<f64>,
    /// Damping of the surface [N·s/m]; that of each body if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = zero_or_more("N·s/m"))]
    pub(crate) damping: Option<f64>,
    /// The force limit of a contact point [N], at most that of the device; if left out, that of
    /// the tool or of the simulated device, or else 3.3 N.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("N"))]
    pub(crate) max_force: Option<f64>,
    /// The radius of the probe, or of the balls that cover a tool with a shape [m]; the tool's,
    /// or else 2 mm, if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) radius: Option<f64>,
    /// Touch meshes themselves. If left out, a body that holds a mesh is touched as a grid of it, whose
    /// distances take the same short time everywhere.
    #[arg(long)]
    pub(crate) exact: bool,
    /// The size of the cells of those grids [m]; a 128th of each body if left out.
    #[arg(long, conflicts_with = "exact", allow_negative_numbers = true, value_parser = length)]
    pub(crate) cell: Option<f64>,
    /// Serve no page. Without a scene, `feel` serves one that shows the built-in gallery, and stays as
    /// long as it is open; `palpate live` shows other scenes.
    #[arg(long)]
    pub(crate) no_live: bool,
    #[command(flatten)]
    pub(crate) page: PageOptions,
    /// Run the ticks without waiting for the clock.
    #[arg(long)]
    pub(crate) fast: bool,
    /// Write every tick to this CSV file, whose name ends in .csv.
    #[arg(long, value_name = "CSV")]
    pub(crate) trace: Option<PathBuf>,
    /// Write what actuators play to this WAV file, whose name ends in .wav, with a channel for each
    /// contact point.
    #[arg(long, value_name = "WAV")]
    pub(crate) wav: Option<PathBuf>,
    /// What plays the vibration on each contact point: an actuator of `palpate devices
    /// --actuators`; that of the scene's tool, or else one that plays every frequency, if left out.
    #[arg(long, value_name = "NAME", requires = "wav", value_parser = actuator)]
    pub(crate) actuator: Option<Actuator>,
    /// Draw the path, the proxy and the force over the isolines: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print the report as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What the hand holds.
#[derive(Clone, Debug)]
pub(crate) enum DeviceChoice {
    /// A hand that follows its path whatever the force.
    Recorded,
    /// A device of this profile in a hand that yields.
    Simulated(Box<ProfileChoice>),
    /// Fingers without force feedback.
    Glove,
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = PROFILES.each_ref().map(|(name, _)| *name);
        match text.split_once(':') {
            None if text == "recorded" => Ok(Self::Recorded),
            None if text == "glove" => Ok(Self::Glove),
            None if names.contains(&text) => {
                Err(format!("a device of this name is written simulated:{text}"))
            }
            _ if text.to_ascii_lowercase().ends_with(".json") && !text.contains(':') => {
                Err(format!("a device with the profile of a file is written simulated:{text}"))
            }
            Some(("simulated", name)) => Ok(Self::Simulated(Box::new(name.parse()?))),
            _ => Err("must be recorded, simulated:NAME or glove".to_owned()),
        }
    }
}

fn actuator(name: &str) -> Result<Actuator, String> {
    let names = ACTUATORS.each_ref().map(|(name, _)| *name);
    actuator_named(name).map_err(|_| unknown_name("actuator", name, &names))
}

impl DeviceChoice {
    /// The file that the device's profile is from.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Simulated(choice) => choice.file.as_deref(),
            Self::Recorded | Self::Glove => None,
        }
    }
}

impl FeelOptions {
    /// The options of an empty command line.
    pub(super) fn parse_from_nothing() -> Self {
        #[derive(Parser)]
        struct Nothing {
            #[command(flatten)]
            options: FeelOptions,
        }
        Nothing::parse_from(["palpate"]).options
    }
}

/// What a device renders of materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AcceptanceChoice {
    /// What needs no passivity controller in any hand.
    Passive,
    /// As stiff as the device renders well at this rate, and as damped as that leaves room for.
    Device,
    /// As they are.
    #[value(alias = "as_is")]
    AsIs,
}

impl From<AcceptanceChoice> for Acceptance {
    fn from(choice: AcceptanceChoice) -> Self {
        match choice {
            AcceptanceChoice::Passive => Self::Passive,
            AcceptanceChoice::Device => Self::Device,
            AcceptanceChoice::AsIs => Self::AsIs,
        }
    }
}

/// How a force comes back after a beginning in a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RecoveryChoice {
    /// By 20 N/s, at once.
    Rise,
    /// When no body pushes the hand.
    OnceOut,
}

impl From<RecoveryChoice> for Recovery {
    fn from(choice: RecoveryChoice) -> Self {
        match choice {
            RecoveryChoice::Rise => Self::Rise,
            RecoveryChoice::OnceOut => Self::OnceOut,
        }
    }
}
