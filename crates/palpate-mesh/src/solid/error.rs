// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Why a mesh bounds no solid.

/// Why a mesh bounds no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// All faces were dropped.
    #[error(
        "none of the {given} faces is left: each has a vertex twice, or is cancelled by its copy"
    )]
    NoFaces {
        /// The faces of the mesh.
        given: usize,
    },
    /// A piece is not orientable.
    #[error("{pieces} pieces are not orientable (like a Möbius strip) and bound no solid")]
    OneSided {
        /// The number of such pieces.
        pieces: usize,
    },
    /// The mesh is a sheet.
    #[error(
        "the openings are as large as the surface: it is a sheet of {area} m², and bounds no solid"
    )]
    Sheet {
        /// The area of the faces [m²]; in the plane the length of the segments [m].
        area: f64,
    },
}
