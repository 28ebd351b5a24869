// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can be wrong with a mesh, and with a file of one.

use std::path::PathBuf;

use palpate_field::LARGEST_LENGTH;

use crate::polygon::MOST_CORNERS;
use crate::read::LARGEST_FILE;

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
    #[error("vertex {vertex} must be finite and at most {LARGEST_LENGTH:e} m, got {value:?} m")]
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

/// What is wrong with the contents of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The ending says nothing of a format that is known.
    #[error("the ending {ending:?} is none of .obj, .stl, .ply and .glb: convert the file")]
    Ending {
        /// What is behind the last dot.
        ending: String,
    },
    /// Nothing was read, or not all.
    #[error("it cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// More than is read into memory.
    #[error("it has {bytes} bytes, {LARGEST_FILE} at most: cut the mesh into parts")]
    TooLarge {
        /// The size of the file.
        bytes: u64,
    },
    /// The file is not what its format asks for.
    #[error("it is no good {format}: {problem}; export it again")]
    Malformed {
        /// The name of the format.
        format: &'static str,
        /// What is wrong, and where.
        problem: String,
    },
    /// The file uses a part of its format that is not read.
    #[error("it has {what}, which are not read: {advice}")]
    Unsupported {
        /// What is not read.
        what: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// A face has more corners than are cut into triangles.
    #[error("face {face} has {corners} corners, {MOST_CORNERS} at most: export triangles")]
    Polygon {
        /// The face, counted from 0.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// What was read is no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A file that is no mesh, and why.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: ReadProblem,
}
