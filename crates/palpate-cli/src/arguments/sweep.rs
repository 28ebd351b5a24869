// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate sweep`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::{count, length, positive};

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate sweep scenes/bayonet.json
  palpate sweep scenes/bayonet.json --until 1 --gap 1e-7 --json
  palpate sweep scenes/bayonet.json --body key
  palpate sweep scenes/bayonet.json --plot touch.png
  palpate sweep scenes/cup.json --motion drop.json
  palpate sweep scenes/bayonet.json --method golden_section
  palpate sweep scenes/bayonet.json --method sum_descent --samples 30

Before the earlier time the bodies are apart by more than half of the gap, which is proven, rounding
included; at the later one their separation is at most the gap.";

/// The options of `palpate sweep`.
#[derive(Args, Debug)]
pub(crate) struct SweepOptions {
    /// The scene file, whose bodies move by its `motions`.
    pub(crate) scene: PathBuf,
    /// A file of motions in place of the scene's own.
    #[arg(long, value_name = "FILE")]
    pub(crate) motion: Option<PathBuf>,
    /// List pairs that are apart too; always on where at most 66 pairs are asked about, those of 12
    /// bodies.
    #[arg(long)]
    pub(crate) every_pair: bool,
    /// Only pairs with this body; may be given more than once.
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Vec<String>,
    /// The end of the time that is looked at [s]; if left out, the end of the last motion: one that repeats
    /// counts once, there and back.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) until: Option<f64>,
    /// The largest separation at which bodies touch [m], a millionth of the smallest body if left
    /// out; those more than half of it apart may be called apart.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) gap: Option<f64>,
    /// How far apart the bounds of a time may be [s]; if left out, 1e-4 of the duration of the part
    /// that is searched: motions are split into parts of less than half a turn.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) tolerance: Option<f64>,
    /// The budget: the most evaluations of fields for each pair and each part of a motion; 5000000 if
    /// left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, u32::MAX))]
    pub(crate) budget: Option<u32>,
    /// A local search of the literature beside the proven answer: golden_section over space and time, of
    /// the surface of the smaller body as triangles or segments; or at equal steps of time, naive,
    /// projected_gradient, frank_wolfe or macklin of that surface, or alternating_projection,
    /// minimax_proximal or sum_descent between both fields.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// How many steps of time of each part of a motion --method looks at, but for golden_section; 60 if
    /// left out.
    #[arg(long, requires = "method", allow_negative_numbers = true, value_parser = count(1, 10_000_u32))]
    pub(crate) samples: Option<u32>,
    /// How many cells the longest side of a body's box has in the grid from which --method takes its
    /// surface; 64 if left out.
    #[arg(long, requires = "method", allow_negative_numbers = true, value_parser = count(4, 256_u32))]
    pub(crate) cells: Option<u32>,
    /// Draw the first touch, how the bodies got there, and the boxes that were ruled out: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// The plane of the picture in space: xy, xz, yz, or three points as origin:right:up, each x,y,z;
    /// along two axes through the touch; if left out, along the normal and the motion there.
    #[arg(long, requires = "plot", allow_hyphen_values = true)]
    pub(crate) plane: Option<String>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
