// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::ContactQuestion;
use super::numbers::{coordinate, count, length};

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate plot scenes/memoir_star.json
  palpate plot scenes/s3.json --plane xz --at 0.1 --output s3.png
  palpate plot scenes/s3.json --plane 0,0,0:1,0,0:0,1,1 --step 0.05
  palpate plot scenes/gears.json --centre 0.033,0 --size 0.02 --output mesh.png
  palpate plot scenes/nut_on_bolt.json --view thread
  palpate plot scenes/bayonet.json --time 1.4
  palpate plot scenes/memoir_star.json --map gradient --output gradient.png
  palpate plot scenes/memoir_star.json --map promise --output promise.png
  palpate plot scenes/memoir_star.json --map error --gradient dichotomy --output error.png
  palpate plot scenes/s2.json --map error --against scenes/s3.json --output difference.png
  palpate plot scenes/peg_in_hole.json --contacts --proof --output proof.png";

/// The options of `palpate plot`.
#[derive(Args, Debug)]
pub(crate) struct PlotOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// A view of the scene: its plane, its window and its isolines.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["plane", "at", "centre", "size"])]
    pub(crate) view: Option<String>,
    /// The plane in space: xy, xz, yz, or three points as origin:right:up, each
    /// x,y,z; xy if left out.
    #[arg(long, allow_hyphen_values = true)]
    pub(crate) plane: Option<String>,
    /// The third coordinate of a plane along two axes [m].
    #[arg(long, allow_negative_numbers = true, value_parser = coordinate)]
    pub(crate) at: Option<f64>,
    /// The point in the middle of the picture, x,y or x,y,z [m]; the picture shows the whole
    /// scene if left out. A plane along two axes goes through this point.
    #[arg(long, requires = "size", allow_hyphen_values = true)]
    pub(crate) centre: Option<String>,
    /// Width and height of the part of the scene that is shown [m].
    #[arg(long, requires = "centre", allow_negative_numbers = true, value_parser = length)]
    pub(crate) size: Option<f64>,
    /// Where bodies are at this time [s], if the scene has motions.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub(crate) time: f64,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = PlotMap::Distance)]
    pub(crate) map: PlotMap,
    /// The other scene of --map error, whose field is compared with this one.
    #[arg(long, value_name = "SCENE")]
    pub(crate) against: Option<PathBuf>,
    /// How gradients are found, for --map gradient and --map error: closest_vector, differences,
    /// dichotomy or adaptive_dichotomy (in the plane), exact.
    #[arg(long, value_name = "METHOD")]
    pub(crate) gradient: Option<String>,
    /// How far from a point --gradient compares values [m]; five millionths of the longest edge of
    /// the scene's box if left out.
    #[arg(long, requires = "gradient", allow_negative_numbers = true)]
    pub(crate) offset: Option<f64>,
    /// Round the values that --gradient compares to single precision.
    #[arg(long, requires = "gradient")]
    pub(crate) single: bool,
    /// The distance between isolines [m], instead of that of the view; only for --map distance.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
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
    /// The width of a PNG [pixels]; 1200 if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(64, 16384_u32))]
    pub(crate) width: Option<u32>,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What the colours of a picture of a field show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Map {
    /// Bands of distance with isolines.
    Distance,
    /// The direction of the gradient, and where its length is not one.
    Gradient,
    /// The promise of each side, and how values compare with it: in the plane, the value over
    /// the true distance; in space, the length of the gradient.
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

/// What the colours of a picture show, also beside something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlotMap {
    /// Bands of distance with isolines.
    Distance,
    /// The direction of the gradient, and where its length is not one.
    Gradient,
    /// The promise of each side, and how values compare with it: in the plane, the value over
    /// the true distance; in space, the length of the gradient.
    Promise,
    /// The difference of two fields (--against), or the angle between a gradient (--gradient) and
    /// the exact one.
    Error,
}

impl PlotMap {
    /// The map of a field alone; `None` of an error.
    pub(crate) fn of_one_field(self) -> Option<Map> {
        match self {
            Self::Distance => Some(Map::Distance),
            Self::Gradient => Some(Map::Gradient),
            Self::Promise => Some(Map::Promise),
            Self::Error => None,
        }
    }

    /// The name in commands and answers.
    pub(crate) fn name(self) -> &'static str {
        self.of_one_field().map_or("error", Map::name)
    }
}
