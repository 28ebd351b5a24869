// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate gradients`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::length;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate gradients scenes/memoir_star.json --at 1.35,0.8
  palpate gradients scenes/memoir_star.json --at 1.35,0.8 --offset 5e-6 --single \\
    --plot gradients.png
  palpate gradients scenes/s3.json --at 0.1,0.5,-0.2 --json

The methods are those of \"Détections de collisions avec des SDFs\", section 2.3: the vector to the
closest point, central differences, and a dichotomy over directions with a fixed and a growing
offset, which turns in the plane alone.";

/// The options of `palpate gradients`.
#[derive(Args, Debug)]
pub(crate) struct GradientsOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The point, its coordinates joined by commas [m].
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    pub(crate) at: String,
    /// How far from the point values are compared [m]; five millionths of the longest edge of the
    /// scene's box if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) offset: Option<f64>,
    /// Round the values that are compared to single precision, as the memoir's program does.
    #[arg(long)]
    pub(crate) single: bool,
    /// Draw the angle between the direction of each method and the exact one, a panel a method;
    /// in space on the plane xy through the point: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Width and height of the drawn window around the point [m]; the whole scene if left out.
    #[arg(long, requires = "plot", allow_negative_numbers = true, value_parser = length)]
    pub(crate) size: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
