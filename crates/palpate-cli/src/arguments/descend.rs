// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::length_or_zero;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99 \\
    --method frank_wolfe --plot descent.png
  palpate descend scenes/s3.json --segment -1,0,0 1,0.2,0.1 --method golden_section --json
  palpate descend scenes/memoir_two_bodies.json --start -0.2,0.5 --start 0.15,0.4

With --start the search is for a point inside the first two bodies of the scene. A local
search finds an upper bound of the least value and proves nothing; the answer says by how
much the search missed the proven minimum.";

/// The options of `palpate descend`.
#[derive(Args, Debug)]
pub(crate) struct DescendOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The corners of a triangle, each with its coordinates joined by commas [m].
    #[arg(long, value_name = "POINT", num_args = 3, allow_hyphen_values = true)]
    pub(crate) triangle: Vec<String>,
    /// The ends of a segment [m].
    #[arg(
        long,
        value_name = "POINT",
        num_args = 2,
        conflicts_with = "triangle",
        allow_hyphen_values = true
    )]
    pub(crate) segment: Vec<String>,
    /// Where a search between two bodies starts [m]; may be given more than once.
    #[arg(
        long,
        value_name = "POINT",
        conflicts_with_all = ["triangle", "segment"],
        allow_hyphen_values = true
    )]
    pub(crate) start: Vec<String>,
    /// The search: projected_gradient, frank_wolfe or golden_section over an element,
    /// alternating_projection or minimax_proximal between bodies; the first of these if left
    /// out.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// How far apart the proven bounds may be [m]; a ten-thousandth of the longest edge of the
    /// element or of the scene's box if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) tolerance: Option<f64>,
    /// Draw the path over the isolines, on the element's plane: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print JSON, with the points of the path.
    #[arg(long)]
    pub(crate) json: bool,
}
