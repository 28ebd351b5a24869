// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::{count, length_or_zero};

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99 \\
    --method naive --alpha 0.1 --mu 0.1 --start 0.2,0.2,0.6 --plot descent.png
  palpate descend scenes/s3.json --segment -1,0,0 1,0.2,0.1 --method golden_section --json
  palpate descend scenes/memoir_two_bodies.json --start -0.2,0.5 --start 0.15,0.4
  palpate descend scenes/memoir_two_bodies.json --method sum_descent --halton 40

Without --triangle and --segment the search is for a point inside the first two bodies of the
scene, from each --start or from --halton starts. A local search finds an upper bound of the least value and proves
nothing; the answer says by how much it missed the proven minimum, where it ended, what both
searches cost, and whether the circles around the element exclude it.";

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
    /// Where the search starts. Over a triangle or a segment: the barycentric weights of its
    /// corners, u,v,w or u,v, whose sum is 1; the method's own start if left out. Between bodies:
    /// a point [m]; may be given more than once.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pub(crate) start: Vec<String>,
    /// Between bodies: this many starts of Halton's sequence, evenly over the common part of both
    /// boxes; MuJoCo has 40.
    #[arg(long, conflicts_with = "start", allow_negative_numbers = true, value_parser = count(1, 100_000_u32))]
    pub(crate) halton: Option<u32>,
    /// The search: projected_gradient, frank_wolfe, golden_section, macklin (as PhysX ships it) or
    /// naive (the memoir's, as printed) over an element; alternating_projection, minimax_proximal or
    /// sum_descent (MuJoCo's) between bodies; the first of these if left out.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// The factor α of the steps of --method naive, α·max(f, µ); 0.1 if left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) alpha: Option<f64>,
    /// The least value µ in the steps of --method naive [m]; a tenth of the longest edge if left
    /// out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) mu: Option<f64>,
    /// The number of steps of --method naive; 64 if left out.
    #[arg(long)]
    pub(crate) iterations: Option<u32>,
    /// How --method naive finds gradients: dichotomy or adaptive_dichotomy (in the plane),
    /// differences, closest_vector, exact; dichotomy if left out, in space differences.
    #[arg(long)]
    pub(crate) gradient: Option<String>,
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
