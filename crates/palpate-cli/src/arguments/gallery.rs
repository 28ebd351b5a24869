// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate gallery`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::Map;
use super::numbers::count;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate gallery
  palpate gallery --output pictures --map promise --plane xy
  palpate gallery --each --format svg --json";

/// The options of `palpate gallery`.
#[derive(Args, Debug)]
pub(crate) struct GalleryOptions {
    /// The folder for the pictures; created if it is missing.
    #[arg(long, value_name = "DIR", default_value = "gallery")]
    pub(crate) output: PathBuf,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = Map::Distance)]
    pub(crate) map: Map,
    /// The plane through the middle of each shape of space; xy and xz if left out. May be given
    /// more than once.
    #[arg(long, value_enum)]
    pub(crate) plane: Vec<Plane>,
    /// Also draw each shape as a picture of its own, in a folder beside its sheet.
    #[arg(long)]
    pub(crate) each: bool,
    /// The format of the pictures.
    #[arg(long, value_enum, default_value_t = Format::Png)]
    pub(crate) format: Format,
    /// The width of a PNG [pixels]; 1200 if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(64, 16384_u32))]
    pub(crate) width: Option<u32>,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

impl GalleryOptions {
    /// The planes asked for, each once.
    pub(crate) fn planes(&self) -> Vec<Plane> {
        let all = [Plane::Xy, Plane::Xz, Plane::Yz];
        let asked = |plane: &Plane| match self.plane[..] {
            [] => *plane != Plane::Yz,
            _ => self.plane.contains(plane),
        };
        all.into_iter().filter(asked).collect()
    }
}

/// A plane along two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Plane {
    /// Seen from the front.
    Xy,
    /// Seen from above.
    Xz,
    /// Seen from the side.
    Yz,
}

impl Plane {
    /// The name in commands and files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Xy => "xy",
            Self::Xz => "xz",
            Self::Yz => "yz",
        }
    }
}

/// A kind of picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Pixels.
    Png,
    /// Lines and curves.
    Svg,
}

impl Format {
    /// The ending of its files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }
}
