// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can be wrong with a mesh.

use palpate_field::LARGEST_LENGTH;

/// Why vertices and elements are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No elements.
    #[error("the mesh has {vertices} vertices and no faces: at least one is needed")]
    Empty {
        /// How many vertices it has.
        vertices: usize,
    },
    /// A coordinate is not a number, or too large to compute with.
    #[error(
        "vertex {vertex} must be finite and at most {LARGEST_LENGTH:e} m in size, got {value:?} m"
    )]
    Coordinate {
        /// The vertex, counted from 0.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// An element names a vertex that does not exist.
    #[error("face {element} names vertex {index}, and there are {vertices}, counted from 0")]
    Index {
        /// The element, counted from 0.
        element: usize,
        /// The vertex that it names.
        index: u64,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More vertices or elements than can be counted.
    #[error("the mesh has {count} {what}: {} at most; cut it into parts", u32::MAX)]
    TooMany {
        /// Vertices or faces.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A factor that is no scale.
    #[error("a scale must be positive and finite, got {value:?}")]
    Scale {
        /// The factor.
        value: f64,
    },
}
