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

Exit status: 0 if the answer is yes, 1 if it is no, 2 if the input cannot be used,
130 if a signal ended the run.";

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
    /// Print distance, gradient and nearest surface point, at one point or many.
    #[command(after_help = "\
Examples:
  palpate eval scenes/s3.json --at 0.1,0.5,-0.2
  palpate eval scenes/memoir_star.json --at 0.3,0 --json
  palpate eval scenes/s3.json --points points.csv --output distances.csv

The points file has the header x_m,y_m,z_m (x_m,y_m in 2D).")]
    Eval(EvalOptions),
    /// Find where the bodies of a scene touch, with a proof; status 1 if none do.
    #[command(after_help = "\
Examples:
  palpate contact scenes/peg_in_hole.json
  palpate contact scenes/nut_on_bolt.json --margin 0.0002 --json
  palpate contact scenes/gears.json --tolerance 1e-6

The separation of bodies that are exact outside is their distance; that of bodies that
overlap is minus the diameter of the largest ball inside both. It lies between the printed
bounds, which include rounding. A pair that the budget leaves open is undecided.")]
    Contact(ContactOptions),
    /// Compare a local search over a triangle or a segment, or between two bodies, with the
    /// proven minimum.
    #[command(after_help = "\
Examples:
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99 \\
    --method frank_wolfe --plot descent.png
  palpate descend scenes/s3.json --segment -1,0,0 1,0.2,0.1 --method golden_section --json
  palpate descend scenes/memoir_two_bodies.json --start -0.2,0.5 --start 0.15,0.4

With --start the search is for a point inside the first two bodies of the scene. A local
search finds an upper bound of the least value and proves nothing; the answer says by how
much the search missed the proven minimum.")]
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
    /// Draw every primitive and operator as small pictures on a few sheets.
    #[command(after_help = "\
Examples:
  palpate gallery
  palpate gallery --output pictures --map promise --plane xy
  palpate gallery --each --format svg --json")]
    Gallery(GalleryOptions),
    /// Check a scene file; status 1, with the line, if it is wrong.
    #[command(
        after_help = "Examples:\n  palpate check scenes/cup.json\n  palpate check scenes/cup.json --json"
    )]
    Check(CheckOptions),
    /// Compute volume, mass, centroid and moments of the bodies, with error bounds.
    #[command(after_help = "\
Examples:
  palpate mass scenes/cup.json
  palpate mass scenes/cup.json --density 7850 --tolerance 1e-4 --json

Second moments are the integrals of density times products of coordinates about the
centroid; the inertia tensor is their trace times the identity, minus the second moments.
In 2D a body is one metre thick. Status 1 if the error of a volume stays above the tolerance.")]
    Mass(MassOptions),
    /// Check whether a mesh file (OBJ, STL, PLY, GLB) is watertight, and list its defects.
    #[command(after_help = "\
Examples:
  palpate mesh testdata/meshes/nut.ply
  palpate mesh part.stl --scale 0.001 --json

Status 1 if the mesh is not watertight, or has triangles without area.")]
    Mesh(MeshOptions),
    /// Print the JSON schema of scene files.
    #[command(after_help = "Examples:\n  palpate schema > scene.schema.json")]
    Schema,
    /// List the primitives: parameters, units, promises, how they bound cells.
    #[command(after_help = "Examples:\n  palpate shapes\n  palpate shapes --json")]
    Shapes(ShapesOptions),
    /// List the devices that can be simulated: limits, sources, assumed numbers.
    #[command(after_help = "Examples:\n  palpate devices\n  palpate devices --json")]
    Devices(DevicesOptions),
    /// Measure how late a loop wakes on this machine, and advise how to wait.
    #[command(
        after_help = "Examples:\n  palpate jitter\n  palpate jitter --rate 4000 --duration 20 --json"
    )]
    Jitter(JitterOptions),
}

impl Default for Command {
    /// `palpate` without a command is `palpate feel` with its defaults.
    fn default() -> Self {
        Self::Feel(FeelOptions::parse_from_nothing())
    }
}

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
    fn parse_from_nothing() -> Self {
        #[derive(Parser)]
        struct Nothing {
            #[command(flatten)]
            options: FeelOptions,
        }
        Nothing::parse_from(["palpate"]).options
    }
}

/// The options of `palpate eval`.
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
    /// The file for the answers to many points; standard output if left out.
    #[arg(long, value_name = "FILE", requires = "points")]
    pub(crate) output: Option<PathBuf>,
    /// The number of threads; as many as the machine has if left out. Answers have the same
    /// bits for any number.
    #[arg(long, requires = "points")]
    pub(crate) threads: Option<usize>,
    /// Print JSON: one object, or one per line for many points.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The options of `palpate descend`.
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
    /// alternating_projection or minimax_proximal between bodies; the first of these if left
    /// out.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// How far apart the proven bounds may be [m]; a ten-thousandth of the longest edge of the
    /// element or of the scene's box if left out.
    #[arg(long)]
    pub(crate) tolerance: Option<f64>,
    /// Draw the path over the isolines, on the element's plane: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print JSON, with the points of the path.
    #[arg(long)]
    pub(crate) json: bool,
}

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

/// The options of `palpate contact`.
#[derive(Args, Debug)]
pub(crate) struct ContactOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// List pairs that are apart too, with the bounds of their separation; always on for scenes
    /// of at most 12 bodies.
    #[arg(long)]
    pub(crate) all: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What counts as touching, and how finely contacts are found.
#[derive(Args, Debug)]
pub(crate) struct ContactQuestion {
    /// The largest gap at which bodies count as touching [m]; 0.2 % of the smallest body if
    /// left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) margin: Option<f64>,
    /// The size of the smallest boxes in a region of contact [m]; 4 % of the smallest body if
    /// left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) spacing: Option<f64>,
    /// How far apart the bounds of a separation may be [m]; half the margin if left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) tolerance: Option<f64>,
    /// The budget: the most evaluations of fields for each pair.
    #[arg(long, default_value_t = 200_000)]
    pub(crate) budget: u32,
}

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

/// The options of `palpate check`.
#[derive(Args, Debug)]
pub(crate) struct CheckOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The options of `palpate mass`.
#[derive(Args, Debug)]
pub(crate) struct MassOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The density of all bodies [kg/m³].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) density: f64,
    /// The relative error of the volume at which to stop.
    #[arg(long, default_value_t = 1e-3)]
    pub(crate) tolerance: f64,
    /// The budget: the most cells; a million take 160 MB.
    #[arg(long, default_value_t = 3_000_000)]
    pub(crate) cells: usize,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The options of `palpate mesh`.
#[derive(Args, Debug)]
pub(crate) struct MeshOptions {
    /// The mesh file: .obj, .stl, .ply or .glb.
    pub(crate) file: PathBuf,
    /// The unit of the file in metres: 0.001 for millimetres.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub(crate) scale: Option<f64>,
    /// Merge vertices that are exactly equal, as is always done for STL.
    #[arg(long)]
    pub(crate) weld: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The options of `palpate shapes`.
#[derive(Args, Debug)]
pub(crate) struct ShapesOptions {
    /// List only the primitives of this dimension.
    #[arg(long, value_enum)]
    pub(crate) dimension: Option<Dimension>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The options of `palpate devices`.
#[derive(Args, Debug)]
pub(crate) struct DevicesOptions {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The options of `palpate jitter`.
#[derive(Args, Debug)]
pub(crate) struct JitterOptions {
    /// Ticks a second, at most 10 kHz [Hz].
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) rate: f64,
    /// How long to measure in all, shared by the ways to wait [s].
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
