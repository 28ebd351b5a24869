// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The command line: each command's options and examples are in a file of its name.

pub(crate) mod numbers;
mod profile;
mod reading;

use clap::{Parser, Subcommand};

pub(crate) use crate::check::CheckOptions;
pub(crate) use crate::contact::ContactOptions;
pub(crate) use crate::descend::DescendOptions;
pub(crate) use crate::devices::DevicesOptions;
pub(crate) use crate::eval::EvalOptions;
pub(crate) use crate::feel::FeelOptions;
pub(crate) use crate::gallery::GalleryOptions;
pub(crate) use crate::gradients::GradientsOptions;
pub(crate) use crate::grid::GridOptions;
pub(crate) use crate::identify::IdentifyOptions;
pub(crate) use crate::jitter::JitterOptions;
pub(crate) use crate::live::LiveOptions;
pub(crate) use crate::mass::MassOptions;
pub(crate) use crate::mesh::MeshOptions;
pub(crate) use crate::plot::PlotOptions;
pub(crate) use crate::render::RenderOptions;
pub(crate) use crate::schema::SchemaOptions;
pub(crate) use crate::shapes::ShapesOptions;
pub(crate) use crate::sweep::SweepOptions;
pub(crate) use profile::ProfileChoice;
pub(crate) use reading::{Reading, unread};

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
130 if a signal ended the run, 141 if the reader of the answer left.";

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
    #[command(after_help = crate::feel::EXAMPLES)]
    Feel(FeelOptions),
    /// Print distance, gradient and nearest surface point, at one point or many.
    #[command(after_help = crate::eval::EXAMPLES)]
    Eval(EvalOptions),
    /// Find where the bodies of a scene touch, with a proof; status 1 if none do.
    #[command(after_help = crate::contact::EXAMPLES)]
    Contact(ContactOptions),
    /// Find when bodies that move touch first, with a proof; status 1 if none do.
    #[command(after_help = crate::sweep::EXAMPLES)]
    Sweep(SweepOptions),
    /// Compare a local search over a triangle or a segment, or between two bodies, with the
    /// proven minimum.
    #[command(after_help = crate::descend::EXAMPLES)]
    Descend(DescendOptions),
    /// Compare ways to the gradient of a field with the exact one.
    #[command(after_help = crate::gradients::EXAMPLES)]
    Gradients(GradientsOptions),
    /// Draw a scene on a plane, as SVG or PNG: isolines, gradients, promises or errors.
    #[command(after_help = crate::plot::EXAMPLES)]
    Plot(PlotOptions),
    /// Draw a scene in space, lit, as PNG; no surface is missed.
    #[command(after_help = crate::render::EXAMPLES)]
    Render(RenderOptions),
    /// Draw every primitive and operator as small pictures on a few sheets.
    #[command(after_help = crate::gallery::EXAMPLES)]
    Gallery(GalleryOptions),
    /// Check a scene file; status 1, with the line, if it is wrong.
    #[command(after_help = crate::check::EXAMPLES)]
    Check(CheckOptions),
    /// Compute volume, mass, centroid and moments of the bodies, with error bounds.
    #[command(after_help = crate::mass::EXAMPLES)]
    Mass(MassOptions),
    /// Sample a scene on a grid, with a certified deviation, and write it as a file.
    #[command(after_help = crate::grid::EXAMPLES)]
    Grid(GridOptions),
    /// Check whether a mesh file (OBJ, STL, PLY, GLB, glTF) is watertight, and list its defects.
    #[command(after_help = crate::mesh::EXAMPLES)]
    Mesh(MeshOptions),
    /// Print the JSON schema of scene files, or of questions and answers.
    #[command(after_help = "Examples:\n  palpate schema > scene.schema.json\n  \
                            palpate schema answers > answers.schema.json")]
    Schema(SchemaOptions),
    /// List the primitives with parameters, origins and promises, or draw one.
    #[command(after_help = crate::shapes::EXAMPLES)]
    Shapes(ShapesOptions),
    /// List the devices that can be simulated: limits, sources, assumed numbers.
    #[command(after_help = crate::devices::EXAMPLES)]
    Devices(DevicesOptions),
    /// Find mass, damping, friction and encoder step of a device by small motions of its own, and
    /// write its profile; status 1 if a number cannot be told.
    #[command(after_help = crate::identify::EXAMPLES)]
    Identify(Box<IdentifyOptions>),
    /// Serve a page on which a scene is seen, touched, edited and measured, until Ctrl-C.
    #[command(after_help = crate::live::EXAMPLES)]
    Live(LiveOptions),
    /// Measure how late a loop wakes on this machine, and advise how to wait.
    #[command(after_help = crate::jitter::EXAMPLES)]
    Jitter(JitterOptions),
}

impl Default for Command {
    /// `palpate` without a command is `palpate feel` with its defaults.
    fn default() -> Self {
        Self::Feel(FeelOptions::parse_from_nothing())
    }
}
