// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use palpate::devices::{DeviceProfile, profile_named};
use std::str::FromStr;

const EXAMPLES: &str = "\
Examples:
  palpate                                  feel the built-in gallery for 10 s
  palpate feel scenes/cup.json --plot cup.png
  palpate eval scenes/s3.json --at 0.1,0.5,-0.2
  palpate eval scenes/s3.json --points points.csv > distances.csv
  palpate plot scenes/memoir_star.json --output star.svg
  palpate check scenes/cup.json --json

Exit status: 0 if the answer is yes, 1 if it is no, 2 if the input is bad, 130 if it was
interrupted.";

/// Signed distance functions that can be touched.
#[derive(Debug, Parser)]
#[command(name = "palpate", version, after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Feel a scene with a simulated hand in a servo loop, and report (the default).
    #[command(after_help = "\
Examples:
  palpate feel
  palpate feel scenes/cup.json --duration 5 --trace touch.csv --plot touch.png
  palpate feel scenes/cup.json --path hand.csv --rate 2000
  palpate feel --points 10 --fast --json")]
    Feel(FeelOptions),
    /// Distance, gradient and nearest surface point, at one point or many.
    #[command(after_help = "\
Examples:
  palpate eval scenes/s3.json --at 0.1,0.5,-0.2
  palpate eval scenes/memoir_star.json --at 0.3,0 --json
  palpate eval scenes/s3.json --points points.csv --output distances.csv

The points file has the header x_m,y_m,z_m (x_m,y_m in 2D).")]
    Eval(EvalOptions),
    /// Where the bodies of a scene touch, with proof; status 1 if none do.
    #[command(after_help = "\
Examples:
  palpate contact scenes/peg_in_hole.json
  palpate contact scenes/nut_on_bolt.json --margin 0.0002 --json
  palpate contact scenes/gears.json --tolerance 1e-6

Bounds are of the separation: between bodies that are exact outside, their distance; of
bodies that overlap, minus the width of the widest ball in both. The truth lies between
them, rounding included. A pair that the budget leaves open is undecided, with bounds.")]
    Contact(ContactOptions),
    /// Follow a local search over a triangle or a segment, or between two bodies, beside
    /// what is proven.
    #[command(after_help = "\
Examples:
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99 \\
    --method frank_wolfe --plot descent.png
  palpate descend scenes/s3.json --segment -1,0,0 1,0.2,0.1 --method golden_section --json
  palpate descend scenes/memoir_two_bodies.json --start -0.2,0.5 --start 0.15,0.4

With --start the search is for a point in the first two bodies of the scene. A local search finds an upper bound of the least value and proves nothing; what it
missed is said.")]
    Descend(DescendOptions),
    /// Draw a scene on a plane, as SVG or PNG: isolines, gradients or promises.
    #[command(after_help = "\
Examples:
  palpate plot scenes/memoir_star.json
  palpate plot scenes/s3.json --plane xz --at 0.1 --output s3.png
  palpate plot scenes/s3.json --plane 0,0,0:1,0,0:0,1,1 --step 0.05
  palpate plot scenes/gears.json --centre 0.033,0 --size 0.02 --output mesh.png
  palpate plot scenes/memoir_star.json --map gradient --output gradient.png
  palpate plot scenes/memoir_star.json --map promise --output promise.png
  palpate plot scenes/peg_in_hole.json --contacts --proof --output proof.png")]
    Plot(PlotOptions),
    /// Draw every primitive and operator, many small pictures on a few sheets.
    #[command(after_help = "\
Examples:
  palpate gallery
  palpate gallery --output pictures --map promise --plane xy
  palpate gallery --each --format svg --json")]
    Gallery(GalleryOptions),
    /// Check a scene file; status 1 and the place if something is wrong.
    #[command(
        after_help = "Examples:\n  palpate check scenes/cup.json\n  palpate check scenes/cup.json --json"
    )]
    Check(CheckOptions),
    /// Volume, mass, centroid and moments of the bodies, with bounds on their errors.
    #[command(after_help = "\
Examples:
  palpate mass scenes/cup.json
  palpate mass scenes/cup.json --density 7850 --tolerance 1e-4 --json

Second moments are the integrals of density times coordinates about the centroid; the
inertia tensor is their trace times the identity less them. In 2D a body is one metre
thick. Status 1 if the error of a volume stays above the tolerance.")]
    Mass(MassOptions),
    /// Check a mesh file (OBJ, STL, PLY, GLB): is it watertight, what is odd about it.
    #[command(after_help = "\
Examples:
  palpate mesh testdata/meshes/nut.ply
  palpate mesh part.stl --scale 0.001 --json

Status 1 if the mesh is not watertight, or has triangles without an area.")]
    Mesh(MeshOptions),
    /// Print the JSON schema of scene files.
    #[command(after_help = "Examples:\n  palpate schema > scene.schema.json")]
    Schema,
    /// List the primitives: parameters, units, promises, how they bound cells.
    #[command(after_help = "Examples:\n  palpate shapes\n  palpate shapes --json")]
    Shapes(ShapesOptions),
    /// List the devices that can be simulated: limits, sources, what of it is assumed.
    #[command(after_help = "Examples:\n  palpate devices\n  palpate devices --json")]
    Devices(DevicesOptions),
    /// Measure how late a loop wakes on this machine, and what would help.
    #[command(
        after_help = "Examples:\n  palpate jitter\n  palpate jitter --rate 4000 --duration 20 --json"
    )]
    Jitter(JitterOptions),
}

impl Default for Command {
    /// What `palpate` alone does: `palpate feel` with its defaults.
    fn default() -> Self {
        Self::Feel(FeelOptions::parse_from_nothing())
    }
}

/// What is felt, and how.
#[derive(Args, Debug)]
pub(crate) struct FeelOptions {
    /// The scene file; the built-in gallery if left out.
    pub(crate) scene: Option<PathBuf>,
    /// Ticks a second [Hz].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) rate: f64,
    /// How long to feel [s]; 10 s, or as long as the hand path.
    #[arg(long)]
    pub(crate) duration: Option<f64>,
    /// The hand's path: time_s,x_m,y_m[,z_m] and perhaps point; a built-in one over
    /// the surfaces if left out.
    #[arg(long, value_name = "CSV")]
    pub(crate) path: Option<PathBuf>,
    /// What the hand holds: recorded (it follows its path whatever the force),
    /// simulated:NAME (a device that gives way, with the limits of `palpate devices`; one that
    /// turns, as sigma7, turns a tool with a shape), or glove (no force feedback). On the
    /// built-in gallery simulated:omega, else recorded, if left out.
    #[arg(long)]
    pub(crate) device: Option<DeviceChoice>,
    /// How many contact points the built-in hand has; those of the scene's tool, or 10 on the
    /// built-in gallery, else 1, if left out. A tool with a shape is felt as a whole instead.
    #[arg(long, alias = "contacts", conflicts_with = "path")]
    pub(crate) points: Option<usize>,
    /// Refuse bodies that the device cannot render, instead of making them softer.
    #[arg(long)]
    pub(crate) strict: bool,
    /// Stiffness of the surface [N/m]; that of each body if left out.
    #[arg(long)]
    pub(crate) stiffness: Option<f64>,
    /// Damping of the surface [N·s/m]; that of each body if left out.
    #[arg(long)]
    pub(crate) damping: Option<f64>,
    /// The largest force on a contact point [N]; the tool's, the simulated device's, or 3.3 N,
    /// if left out.
    #[arg(long)]
    pub(crate) max_force: Option<f64>,
    /// Radius of the ball that touches, or of those that cover a tool with a shape [m]; the
    /// tool's, or 2 mm, if left out.
    #[arg(long)]
    pub(crate) radius: Option<f64>,
    /// One tick after the other, without waiting for the clock.
    #[arg(long)]
    pub(crate) fast: bool,
    /// Write every tick to a CSV file.
    #[arg(long, value_name = "CSV")]
    pub(crate) trace: Option<PathBuf>,
    /// Write what all contact points vibrate like to a WAV file.
    #[arg(long, value_name = "WAV")]
    pub(crate) wav: Option<PathBuf>,
    /// Draw the path, the proxy and the force over the isolines: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print the report as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What a hand holds.
#[derive(Clone, Debug)]
pub(crate) enum DeviceChoice {
    /// A hand that follows its path whatever the force.
    Recorded,
    /// A device of this profile in a hand that gives way.
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
            _ => Err(format!("{text:?} is not recorded, simulated:NAME or glove")),
        }
    }
}

impl FeelOptions {
    /// The options of an empty command line.
    fn parse_from_nothing() -> Self {
        #[derive(Parser)]
        struct Nothing {
            #[command(flatten)]
            options: FeelOptions,
        }
        Nothing::parse_from(["palpate"]).options
    }
}

/// What is asked, and where.
#[derive(Args, Debug)]
pub(crate) struct EvalOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// One point, its coordinates joined by commas [m].
    #[arg(
        long,
        value_name = "X,Y[,Z]",
        required_unless_present = "points",
        allow_hyphen_values = true
    )]
    pub(crate) at: Option<String>,
    /// Many points, from a CSV file.
    #[arg(long, value_name = "CSV", conflicts_with = "at")]
    pub(crate) points: Option<PathBuf>,
    /// Where the answers for many points go; standard output if left out.
    #[arg(long, value_name = "FILE", requires = "points")]
    pub(crate) output: Option<PathBuf>,
    /// Threads that evaluate; as many as the machine has if left out. The answers
    /// have the same bits for any number.
    #[arg(long, requires = "points")]
    pub(crate) threads: Option<usize>,
    /// Print JSON: one object, or one a line.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where a search goes down, and how.
#[derive(Args, Debug)]
pub(crate) struct DescendOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The corners of a triangle, each with its coordinates joined by commas [m].
    #[arg(
        long,
        value_name = "POINT",
        num_args = 3,
        required_unless_present_any = ["segment", "start"],
        allow_hyphen_values = true
    )]
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
    /// alternating_projection or minimax_proximal between bodies; the first if left out.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// How far apart the proven bounds may be [m]; a ten-thousandth of the longest edge,
    /// of the element or of the scene's box, if left out.
    #[arg(long)]
    pub(crate) tolerance: Option<f64>,
    /// Draw the path over the isolines, on the element's plane: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print JSON, with the points of the path.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is drawn.
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
    /// The point in the middle of the picture, x,y or x,y,z [m]; the whole scene if
    /// left out. A plane along two axes goes through it.
    #[arg(long, requires = "size", allow_hyphen_values = true)]
    pub(crate) centre: Option<String>,
    /// How wide and high a part of the scene is shown [m].
    #[arg(long, requires = "centre", allow_negative_numbers = true)]
    pub(crate) size: Option<f64>,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = Map::Distance)]
    pub(crate) map: Map,
    /// The distance between isolines [m]; for the map of distances.
    #[arg(long)]
    pub(crate) step: Option<f64>,
    /// Where bodies touch: contacts, normals, and the ways between bodies. A plane along
    /// two axes goes through the deepest contact if it is not said where.
    #[arg(long)]
    pub(crate) contacts: bool,
    /// The proof: the boxes that were ruled out.
    #[arg(long, requires = "contacts")]
    pub(crate) proof: bool,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// The picture: .svg or .png; the scene's name with .svg if left out.
    #[arg(long)]
    pub(crate) output: Option<PathBuf>,
    /// The width of a PNG [pixels].
    #[arg(long, default_value_t = 1200)]
    pub(crate) width: u32,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where bodies touch.
#[derive(Args, Debug)]
pub(crate) struct ContactOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// Pairs that are apart too, with the bounds of their separation; as is done for
    /// scenes of at most 12 bodies.
    #[arg(long)]
    pub(crate) all: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What counts as touching, and how finely it is looked at.
#[derive(Args, Debug)]
pub(crate) struct ContactQuestion {
    /// Up to this gap bodies touch [m]; 0.2 % of the smallest body if left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) margin: Option<f64>,
    /// How finely regions of contact are looked at [m]; 4 % of the smallest body if left
    /// out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) spacing: Option<f64>,
    /// How far apart the bounds of a separation may be [m]; half the margin if left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) tolerance: Option<f64>,
    /// The most evaluations of fields for a pair.
    #[arg(long, default_value_t = 200_000)]
    pub(crate) budget: u32,
}

/// What the gallery shows.
#[derive(Args, Debug)]
pub(crate) struct GalleryOptions {
    /// The folder that the pictures go to; it is made if need be.
    #[arg(long, value_name = "DIR", default_value = "gallery")]
    pub(crate) output: PathBuf,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = Map::Distance)]
    pub(crate) map: Map,
    /// The plane through the middle of shapes of space; xy and xz if left out. May be
    /// given more than once.
    #[arg(long, value_enum)]
    pub(crate) plane: Vec<Plane>,
    /// Draw a picture of each shape too, in a folder beside its sheet.
    #[arg(long)]
    pub(crate) each: bool,
    /// The kind of the pictures.
    #[arg(long, value_enum, default_value_t = Format::Png)]
    pub(crate) format: Format,
    /// The width of a PNG [pixels].
    #[arg(long, default_value_t = 1200)]
    pub(crate) width: u32,
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

/// What the colours of a picture show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Map {
    /// Bands of distance with isolines.
    Distance,
    /// The direction of the gradient, and where its length is not one.
    Gradient,
    /// What values promise on each side, and how they compare with it: in the plane, the
    /// value over the true distance; in space, the length of the gradient.
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

/// What is checked.
#[derive(Args, Debug)]
pub(crate) struct CheckOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is weighed.
#[derive(Args, Debug)]
pub(crate) struct MassOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The density of all bodies [kg/m³].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) density: f64,
    /// The error of the volume, in parts of it, at which to stop.
    #[arg(long, default_value_t = 1e-3)]
    pub(crate) tolerance: f64,
    /// The most cells to look at; a million take 160 MB.
    #[arg(long, default_value_t = 3_000_000)]
    pub(crate) cells: usize,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which mesh is checked.
#[derive(Args, Debug)]
pub(crate) struct MeshOptions {
    /// The mesh file: .obj, .stl, .ply or .glb.
    pub(crate) file: PathBuf,
    /// How many metres its unit is: 0.001 for millimetres.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub(crate) scale: Option<f64>,
    /// Make one vertex of those that are exactly equal. In STL they are already.
    #[arg(long)]
    pub(crate) weld: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which primitives are listed.
#[derive(Args, Debug)]
pub(crate) struct ShapesOptions {
    /// Those of one dimension alone.
    #[arg(long, value_enum)]
    pub(crate) dimension: Option<Dimension>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// How devices are listed.
#[derive(Args, Debug)]
pub(crate) struct DevicesOptions {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What loop is measured.
#[derive(Args, Debug)]
pub(crate) struct JitterOptions {
    /// Ticks a second, at most 10 kHz [Hz].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) rate: f64,
    /// How long to measure, all ways to wait together [s].
    #[arg(long, default_value_t = 5.0)]
    pub(crate) duration: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Dimension {
    /// The plane.
    #[value(name = "2")]
    Two,
    /// Space.
    #[value(name = "3")]
    Three,
}
