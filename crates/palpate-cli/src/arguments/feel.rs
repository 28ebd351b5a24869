// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate feel`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser};
use palpate::devices::{DeviceProfile, profile_named};

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate feel
  palpate feel scenes/cup.json --duration 5 --trace touch.csv --plot touch.png
  palpate feel scenes/cup.json --path hand.csv --rate 2000
  palpate feel --points 10 --fast --json";

/// The options of `palpate feel`.
#[derive(Args, Debug)]
pub(crate) struct FeelOptions {
    /// The scene file; the built-in gallery if left out.
    pub(crate) scene: Option<PathBuf>,
    /// Ticks a second [Hz].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) rate: f64,
    /// How long to feel [s]; the length of the hand path, or else 10 s, if left out.
    #[arg(long)]
    pub(crate) duration: Option<f64>,
    /// The hand's path, with the columns time_s,x_m,y_m[,z_m] and optionally point; a built-in
    /// tour of the surfaces if left out.
    #[arg(long, value_name = "CSV")]
    pub(crate) path: Option<PathBuf>,
    /// What the hand holds: recorded (the hand follows its path whatever the force),
    /// simulated:NAME (a device of `palpate devices` with its limits, in a hand that yields;
    /// one with rotation, such as sigma7, turns a tool with a shape), or glove (no force
    /// feedback). If left out, simulated:omega on the built-in gallery, else recorded.
    #[arg(long)]
    pub(crate) device: Option<DeviceChoice>,
    /// The number of contact points of the built-in hand; if left out, that of the scene's
    /// tool, 10 on the built-in gallery, or else 1. Not for a tool with a shape.
    #[arg(long, alias = "contacts", conflicts_with = "path")]
    pub(crate) points: Option<usize>,
    /// Refuse bodies that the device cannot render stably, instead of making them softer.
    #[arg(long)]
    pub(crate) strict: bool,
    /// Stiffness of the surface [N/m]; that of each body if left out.
    #[arg(long)]
    pub(crate) stiffness: Option<f64>,
    /// Damping of the surface [N·s/m]; that of each body if left out.
    #[arg(long)]
    pub(crate) damping: Option<f64>,
    /// The force limit of a contact point [N]; if left out, that of the tool or of the
    /// simulated device, or else 3.3 N.
    #[arg(long)]
    pub(crate) max_force: Option<f64>,
    /// The radius of the probe, or of the balls that cover a tool with a shape [m]; the tool's,
    /// or else 2 mm, if left out.
    #[arg(long)]
    pub(crate) radius: Option<f64>,
    /// Run the ticks without waiting for the clock.
    #[arg(long)]
    pub(crate) fast: bool,
    /// Write every tick to a CSV file.
    #[arg(long, value_name = "CSV")]
    pub(crate) trace: Option<PathBuf>,
    /// Write the vibration of all contact points to a WAV file.
    #[arg(long, value_name = "WAV")]
    pub(crate) wav: Option<PathBuf>,
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
    Simulated(Box<DeviceProfile>),
    /// Fingers without force feedback.
    Glove,
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "recorded" => Ok(Self::Recorded),
            None if text == "glove" => Ok(Self::Glove),
            Some(("simulated", name)) => {
                let profile = profile_named(name).map_err(|unknown| unknown.to_string())?;
                Ok(Self::Simulated(Box::new(profile)))
            }
            _ => Err(format!("must be recorded, simulated:NAME or glove, got {text:?}")),
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
