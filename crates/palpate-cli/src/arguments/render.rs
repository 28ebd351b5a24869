// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate render`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use palpate::render::Settings;

use super::ContactQuestion;
use super::numbers::{coordinate, count, length, positive, within, zero_or_more};

/// The most pictures of a turntable.
const MOST_PICTURES: u32 = 3600;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate render scenes/cup.json
  palpate render scenes/nut_on_bolt.json --slice xy --output thread.png
  palpate render scenes/peg_in_hole.json --azimuth 60 --elevation 40 --contacts
  palpate render scenes/article_gallery.json --turntable 48 --width 600 --height 450

No surface is missed: each ray proves that nothing lies before what it meets. Rays of sight that
the budget leaves undecided are counted, their pixels are magenta, and the exit status is 1.";

/// The options of `palpate render`.
#[derive(Args, Debug)]
pub(crate) struct RenderOptions {
    /// The scene file, in space.
    pub(crate) scene: PathBuf,
    /// A view of the scene: looks at its plane, without perspective.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["from", "at", "azimuth", "elevation", "field_of_view", "turntable"])]
    pub(crate) view: Option<String>,
    /// Where the camera is, x,y,z [m]; so far away that the scene fills the picture if left out.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with_all = ["azimuth", "elevation"])]
    pub(crate) from: Option<String>,
    /// What the camera looks at, x,y,z [m]; the middle of the scene if left out.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "from")]
    pub(crate) at: Option<String>,
    /// Where the camera is: the angle about y, from z towards x [degrees].
    #[arg(long, default_value_t = 30.0, allow_negative_numbers = true, value_parser = within(-360.0, 360.0, "degrees"))]
    pub(crate) azimuth: f64,
    /// How high the camera is: the angle above the plane of x and z [degrees].
    #[arg(long, default_value_t = 28.0, allow_negative_numbers = true, value_parser = within(-90.0, 90.0, "degrees"))]
    pub(crate) elevation: f64,
    /// The angle that the height of the picture spans [degrees]; 28 if left out.
    #[arg(long, allow_negative_numbers = true, conflicts_with = "orthographic", value_parser = within(1.0, 170.0, "degrees"))]
    pub(crate) field_of_view: Option<f64>,
    /// Without perspective: all is as large, wherever it is.
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// Where bodies are at this time [s], if the scene has motions.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = zero_or_more("s"))]
    pub(crate) time: f64,
    /// Cut away what is on the viewer's side of a plane: xy, xz, yz, view (the plane of --view),
    /// or three points as origin:right:up, each x,y,z. The cut face shows the depth below the
    /// surface.
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true)]
    pub(crate) slice: Option<String>,
    /// The third coordinate of a slice along two axes [m]; the middle of the scene if left out.
    #[arg(long, requires = "slice", allow_negative_numbers = true, value_parser = coordinate)]
    pub(crate) slice_at: Option<f64>,
    /// The distance between isolines on the cut face [m]; chosen if left out.
    #[arg(long, requires = "slice", allow_negative_numbers = true, value_parser = length)]
    pub(crate) step: Option<f64>,
    /// Draw where bodies touch, with normals, over what hides them.
    #[arg(long)]
    pub(crate) contacts: bool,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// The shadows of the light.
    #[arg(long, value_enum, default_value_t = ShadowChoice::Soft)]
    pub(crate) shadows: ShadowChoice,
    /// Leave out the ground, on which shadows fall. There is none either below bodies without
    /// bounds, or for a camera that is not above it.
    #[arg(long)]
    pub(crate) no_ground: bool,
    /// Samples along the side of a pixel at an edge, from 1 to 8; 1 is quick and jagged.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true, value_parser = count(1, 8_u32))]
    pub(crate) samples: u32,
    /// The most evaluations of the field for each ray.
    #[arg(long = "ray-budget", default_value_t = Settings::BUDGET, allow_negative_numbers = true, value_parser = count(1, u32::MAX))]
    pub(crate) ray_budget: u32,
    /// An animation of so many pictures from all around.
    #[arg(long, value_name = "PICTURES", allow_negative_numbers = true, value_parser = count(1, MOST_PICTURES))]
    pub(crate) turntable: Option<u32>,
    /// How long the camera takes to go around [s].
    #[arg(long, default_value_t = 6.0, requires = "turntable", allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) turn_time: f64,
    /// Write the pictures of a turntable as numbered files into this folder.
    #[arg(long, value_name = "FOLDER", requires = "turntable", conflicts_with = "output")]
    pub(crate) frames: Option<PathBuf>,
    /// The picture, .png; the scene's name with .png if left out. A turntable is an animated PNG.
    #[arg(long)]
    pub(crate) output: Option<PathBuf>,
    /// The width [pixels].
    #[arg(long, default_value_t = 1200, allow_negative_numbers = true, value_parser = count(1, 16384_u32))]
    pub(crate) width: u32,
    /// The height [pixels].
    #[arg(long, default_value_t = 900, allow_negative_numbers = true, value_parser = count(1, 16384_u32))]
    pub(crate) height: u32,
    /// The number of threads; as many as the machine has if left out. The picture has the same
    /// bits.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, 1_000_000_usize))]
    pub(crate) threads: Option<usize>,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The shadows of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadowChoice {
    /// Of a disc of 6°.
    Soft,
    /// Of a light as small as a point.
    Hard,
    /// None.
    None,
}
