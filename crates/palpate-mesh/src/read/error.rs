// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can be wrong with a file of a mesh.

use std::path::PathBuf;

use super::LARGEST_FILE;
use crate::error::MeshError;
use crate::polygon::MOST_CORNERS;

/// What is wrong with the contents of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The file name has no ending of a known format.
    #[error("the ending {ending:?} is none of .obj, .stl, .ply and .glb: convert the file")]
    Ending {
        /// The ending, after the last dot.
        ending: String,
    },
    /// Reading failed.
    #[error("it cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// It is a folder, a pipe or a device.
    #[error("it is no file")]
    NoFile,
    /// The file is larger than [`LARGEST_FILE`].
    #[error("it has {bytes} bytes, {LARGEST_FILE} at most: cut the mesh into parts")]
    TooLarge {
        /// The size of the file.
        bytes: u64,
    },
    /// The file breaks the rules of its format.
    #[error("it is no good {format}: {problem}; export it again")]
    Malformed {
        /// The name of the format.
        format: &'static str,
        /// What is wrong, and where.
        problem: String,
    },
    /// The file uses a part of its format that this crate does not read.
    #[error("it has {what}, which are not read: {advice}")]
    Unsupported {
        /// The part of the format.
        what: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// A face has more than [`MOST_CORNERS`] corners.
    #[error("face {face} has {corners} corners, {MOST_CORNERS} at most: export triangles")]
    Polygon {
        /// The face, counted from 0.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The contents are no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Why a file is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[error("{}: {problem}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: ReadProblem,
}
