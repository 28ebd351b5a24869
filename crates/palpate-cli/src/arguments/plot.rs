// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::ContactQuestion;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate plot scenes/memoir_star.json
  palpate plot scenes/s3.json --plane xz --at 0.1 --output s3.png
  palpate plot scenes/s3.json --plane 0,0,0:1,0,0:0,1,1 --step 0.05
  palpate plot scenes/gears.json --centre 0.033,0 --size 0.02 --output mesh.png
  palpate plot scenes/memoir_star.json --map gradient --output gradient.png
  palpate plot scenes/memoir_star.json --map promise --output promise.png
  palpate plot scenes/peg_in_hole.json --contacts --proof --output proof.png";

/// The options of `palpate plot`.
#[derive(Args, Debug)]
pub(crate) struct PlotOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The plane in space: xy, xz, yz, or three points as origin:right:up, each
    /// x,y,z.
    #[arg(long, default_value = "xy", allow_hyphen_values = true)]
    pub(crate) plane: String,
    /// The third coordinate of a plane along two axes [m].
    #[arg(long, allow_hyphen_values = true)]
    pub(crate) at: Option<f64>,
    /// The point in the middle of the picture, x,y or x,y,z [m]; the picture shows the whole
    /// scene if left out. A plane along two axes goes through this point.
    #[arg(long, requires = "size", allow_hyphen_values = true)]
    pub(crate) centre: Option<String>,
    /// Width and height of the part of the scene that is shown [m].
    #[arg(long, requires = "centre", allow_negative_numbers = true)]
    pub(crate) size: Option<f64>,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = Map::Distance)]
    pub(crate) map: Map,
    /// The distance between isolines [m]; only for --map distance.
    #[arg(long)]
    pub(crate) step: Option<f64>,
    /// Draw contacts, normals, and the shortest segments between bodies that are apart. A plane
    /// along two axes goes through the deepest contact unless --at or --centre says where.
    #[arg(long)]
    pub(crate) contacts: bool,
    /// Draw the proof: the boxes that the search ruled out.
    #[arg(long, requires = "contacts")]
    pub(crate) proof: bool,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// The picture, .svg or .png; the scene's name with .svg if left out.
    #[arg(long)]
    pub(crate) output: Option<PathBuf>,
    /// The width of a PNG [pixels].
    #[arg(long, default_value_t = 1200)]
    pub(crate) width: u32,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What the colours of a picture show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Map {
    /// Bands of distance with isolines.
    Distance,
    /// The direction of the gradient, and where its length is not one.
    Gradient,
    /// The promise of each side, and the value over the true distance, which is searched.
    Promise,
}

impl Map {
    /// The name in commands and answers.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Gradient => "gradient",
            Self::Promise => "promise",
        }
    }
}
