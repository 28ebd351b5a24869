// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Why a mesh bounds no solid.

use palpate_field::{LARGEST_LENGTH, SMALLEST_LENGTH};

/// Why a mesh bounds no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// All faces were dropped.
    #[error(
        "none of the {given} faces is left: each has a vertex twice, is cancelled by its copy, or has the same side \
         on both sides"
    )]
    NoFaces {
        /// The faces of the mesh.
        given: usize,
    },
    /// The mesh is too small or too large for its distances.
    #[error(
        "it is {size:e} units across, and must be from {SMALLEST_LENGTH:e} to {LARGEST_LENGTH:e}: export it in other units"
    )]
    Size {
        /// The longest side of the box around it, in its units.
        size: f64,
    },
    /// The thickness of a sheet is too small or too large.
    #[error(
        "thickness must be from {SMALLEST_LENGTH:e} to {LARGEST_LENGTH:e} of its units, got {thickness:e}"
    )]
    Thickness {
        /// The thickness, in the units of the mesh.
        thickness: f64,
    },
    /// A piece is not orientable.
    #[error(
        "pieces that are not orientable (like a Möbius strip): {pieces}; they bound no solid; with a thickness \
         (\"thickness\": METRES in a scene, `MeshSheet` in Rust) it is a plate"
    )]
    OneSided {
        /// The number of such pieces.
        pieces: usize,
    },
    /// The mesh is a sheet.
    #[error(
        "the openings are as large as the surface: it is a sheet, and bounds no solid; with a thickness \
         (\"thickness\": METRES in a scene, `MeshSheet` in Rust) it is a plate"
    )]
    Sheet,
}
