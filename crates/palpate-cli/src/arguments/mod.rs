// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The command line: each command's options and examples are in a file of its name.

mod check;
mod contact;
mod descend;
mod devices;
mod eval;
mod feel;
mod gallery;
mod gradients;
mod grid;
mod identify;
mod jitter;
mod live;
mod mass;
mod mesh;
mod numbers;
mod plot;
mod profile;
mod render;
mod schema;
mod shapes;
mod sweep;

use clap::{Parser, Subcommand};

pub(crate) use check::CheckOptions;
pub(crate) use contact::{ContactOptions, ContactQuestion};
pub(crate) use descend::DescendOptions;
pub(crate) use devices::DevicesOptions;
pub(crate) use eval::EvalOptions;
pub(crate) use feel::{DeviceChoice, FeelOptions, RecoveryChoice};
pub(crate) use gallery::{Format, GalleryOptions, Plane};
pub(crate) use gradients::GradientsOptions;
pub(crate) use grid::GridOptions;
pub(crate) use identify::IdentifyOptions;
pub(crate) use jitter::JitterOptions;
pub(crate) use live::{LiveOptions, PageOptions};
pub(crate) use mass::MassOptions;
pub(crate) use mesh::MeshOptions;
pub(crate) use plot::{Map, PlotMap, PlotOptions};
pub(crate) use profile::ProfileChoice;
pub(crate) use render::{RenderOptions, ShadowChoice};
pub(crate) use schema::{SchemaOf, SchemaOptions};
pub(crate) use shapes::{Dimension, ShapesOptions};
pub(crate) use sweep::SweepOptions;

const EXAMPLES: &str = "\
Examples:
  palpate                                  feel the built-in gallery for 10 s
  palpate live scenes/cup.json             see, touch and edit a scene in a browser
  palpate feel scenes/cup.json --plot cup.png
  palpate eval scenes/s3.json --at 0.1,0.5,-0.2
  palpate eval scenes/s3.json --points points.csv > distances.csv
  palpate plot scenes/memoir_star.json --output star.svg
  palpate render scenes/cup.json
  palpate check scenes/cup.json --json

Exit status: 0 if the answer is yes, 1 if it is no, 2 if the input cannot be used,
130 if a signal ended the run.";

/// Signed distance functions that can be touched.
#[derive(Debug, Parser)]
#[command(name = "palpate", version = env!("PALPATE_VERSION"), after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Feel a scene with a simulated hand in a servo loop, and report (the default).
    #[command(after_help = feel::EXAMPLES)]
    Feel(FeelOptions),
    /// Print distance, gradient and nearest surface point, at one point or many.
    #[command(after_help = eval::EXAMPLES)]
    Eval(EvalOptions),
    /// Find where the bodies of a scene touch, with a proof; status 1 if none do.
    #[command(after_help = contact::EXAMPLES)]
    Contact(ContactOptions),
    /// Find when bodies that move touch first, with a proof; status 1 if none do.
    #[command(after_help = sweep::EXAMPLES)]
    Sweep(SweepOptions),
    /// Compare a local search over a triangle or a segment, or between two bodies, with the
    /// proven minimum.
    #[command(after_help = descend::EXAMPLES)]
    Descend(DescendOptions),
    /// Compare ways to the gradient of a field with the exact one.
    #[command(after_help = gradients::EXAMPLES)]
    Gradients(GradientsOptions),
    /// Draw a scene on a plane, as SVG or PNG: isolines, gradients, promises or errors.
    #[command(after_help = plot::EXAMPLES)]
    Plot(PlotOptions),
    /// Draw a scene in space, lit, as PNG; no surface is missed.
    #[command(after_help = render::EXAMPLES)]
    Render(RenderOptions),
    /// Draw every primitive and operator as small pictures on a few sheets.
    #[command(after_help = gallery::EXAMPLES)]
    Gallery(GalleryOptions),
    /// Check a scene file; status 1, with the line, if it is wrong.
    #[command(after_help = check::EXAMPLES)]
    Check(CheckOptions),
    /// Compute volume, mass, centroid and moments of the bodies, with error bounds.
    #[command(after_help = mass::EXAMPLES)]
    Mass(MassOptions),
    /// Sample a scene on a grid, with a certified deviation, and write it as a file.
    #[command(after_help = grid::EXAMPLES)]
    Grid(GridOptions),
    /// Check whether a mesh file (OBJ, STL, PLY, GLB) is watertight, and list its defects.
    #[command(after_help = mesh::EXAMPLES)]
    Mesh(MeshOptions),
    /// Print the JSON schema of scene files, or of questions and answers.
    #[command(after_help = "Examples:\n  palpate schema > scene.schema.json\n  \
                            palpate schema answers > answers.schema.json")]
    Schema(SchemaOptions),
    /// List the primitives with parameters, origins and promises, or draw one.
    #[command(after_help = shapes::EXAMPLES)]
    Shapes(ShapesOptions),
    /// List the devices that can be simulated: limits, sources, assumed numbers.
    #[command(after_help = devices::EXAMPLES)]
    Devices(DevicesOptions),
    /// Find mass, damping, friction and encoder step of a device by small motions of its own, and
    /// write its profile; status 1 if a number cannot be told.
    #[command(after_help = identify::EXAMPLES)]
    Identify(Box<IdentifyOptions>),
    /// Serve a page on which a scene is seen, touched, edited and measured, until Ctrl-C.
    #[command(after_help = live::EXAMPLES)]
    Live(LiveOptions),
    /// Measure how late a loop wakes on this machine, and advise how to wait.
    #[command(after_help = jitter::EXAMPLES)]
    Jitter(JitterOptions),
}

impl Default for Command {
    /// `palpate` without a command is `palpate feel` with its defaults.
    fn default() -> Self {
        Self::Feel(FeelOptions::parse_from_nothing())
    }
}
