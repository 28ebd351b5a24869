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

Status 1 if the mesh is not watertight, or has triangles without area.";

/// The options of `palpate mesh`.
#[derive(Args, Debug)]
pub(crate) struct MeshOptions {
    /// The mesh file: .obj, .stl, .ply or .glb.
    pub(crate) file: PathBuf,
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
