// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mesh`.

use std::path::PathBuf;

use clap::Args;

use super::numbers::length;

pub(super) const EXAMPLES: &str = "\
Examples:
  palpate mesh testdata/meshes/nut.ply
  palpate mesh part.stl --scale 0.001 --json
  palpate mesh scenes/cup.json --tolerance 2e-4 --output cup.stl

Status 1 if the mesh is not watertight, or has triangles without area or that cross; of one
that is written, also if --tolerance is not reached, or a part is known to be lost. A mesh that is
written is closed, faces outwards and keeps edges sharp; what it says of its error is certified.";

/// The options of `palpate mesh`.
#[derive(Args, Debug)]
pub(crate) struct MeshOptions {
    /// The mesh file to check: .obj, .stl, .ply or .glb. With --output, the scene or the mesh to make a
    /// mesh of.
    pub(crate) file: PathBuf,
    /// Write the surface of the scene as a mesh; the name ends in .obj, .stl, .ply or .glb.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// The largest distance of a triangle from the surface [m], or size of the field on it where the scene's values are
    /// bounds: cells are as small as it takes.
    #[arg(long, requires = "output", allow_negative_numbers = true, value_parser = length, conflicts_with = "cell")]
    pub(crate) tolerance: Option<f64>,
    /// The side of the cells in which vertices lie [m]; a hundredth of the scene if left out.
    #[arg(long, requires = "output", allow_negative_numbers = true, value_parser = length)]
    pub(crate) cell: Option<f64>,
    /// Of a scene, one body instead of all.
    #[arg(long, requires = "output", value_name = "NAME")]
    pub(crate) body: Option<String>,
    /// The unit of the file in metres: 0.001 for millimetres.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = length)]
    pub(crate) scale: Option<f64>,
    /// Merge vertices that are exactly equal, as is always done for STL.
    #[arg(long)]
    pub(crate) weld: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
