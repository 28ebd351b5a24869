// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate contact`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::{count, length, length_or_zero, zero_or_more};

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate contact scenes/peg_in_hole.json
  palpate contact scenes/nut_on_bolt.json --margin 0.0002 --json
  palpate contact scenes/gears.json --tolerance 1e-6
  palpate contact scenes/peg_in_hole.json --body peg --every-pair
  palpate contact scenes/peg_in_hole.json --time 0.5

The separation of bodies that are exact outside is their distance; that of bodies that
overlap is minus the diameter of the largest ball inside both. It lies between the
bounds, which include rounding and are printed to the nearest digit; --json has them whole. Of
other bodies that are apart, separations are lower bounds of distances. A pair touches if its
distance is proven to be at most the margin: by the upper bound of the separation, or, where that
bounds no distance, by two points of the bodies. It is apart if the lower bound is more than the
margin, and is undecided otherwise.";

/// The options of `palpate contact`.
#[derive(Args, Debug)]
pub(crate) struct ContactOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// List pairs that are apart too, with the bounds of their separation; always on where at
    /// most 66 pairs are asked about, those of 12 bodies.
    #[arg(long)]
    pub(crate) every_pair: bool,
    /// Only pairs with this body; may be given more than once.
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Vec<String>,
    /// Ask about bodies where their motions have taken them at this time [s]; at their own poses
    /// if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = zero_or_more("s"))]
    pub(crate) time: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What counts as touching, and how finely contacts are found.
#[derive(Args, Debug)]
pub(crate) struct ContactQuestion {
    /// The largest gap at which bodies count as touching [m]; 0.2 % of the smallest body if
    /// left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) margin: Option<f64>,
    /// The size of the smallest boxes in a region of contact [m]; 4 % of the smallest body if
    /// left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) spacing: Option<f64>,
    /// How far apart the bounds of a separation may be [m]; if left out half the margin, or of the usual
    /// one if that is zero.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) tolerance: Option<f64>,
    /// The budget: the most evaluations of fields for each pair; 200000 if left out. The round
    /// that reaches it is finished.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, u32::MAX))]
    pub(crate) budget: Option<u32>,
}
