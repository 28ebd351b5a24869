// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Why a mesh bounds no solid.

/// Why a mesh bounds no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// No face has area.
    #[error(
        "none of the {given} faces is left: each has a vertex twice, or is cancelled by its copy"
    )]
    NoFaces {
        /// The faces of the mesh.
        given: usize,
    },
    /// Directions of faces do not agree, whatever is turned.
    #[error(
        "{pieces} pieces have one side alone, as a Möbius strip or a Klein bottle: they have no inside"
    )]
    OneSided {
        /// The number of such pieces.
        pieces: usize,
    },
    /// Edges stay open.
    #[error(
        "{rims} edges have an odd number of faces, and no cap closes them: mend the mesh there"
    )]
    Open {
        /// The number of such edges.
        rims: usize,
    },
}
