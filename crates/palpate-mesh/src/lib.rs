// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Triangle meshes, and outlines of segments in the plane.
//!
//! [`Mesh::new`] checks that all numbers are finite, that elements name vertices that
//! exist, and that there is at least one element. [`Mesh::report`] says whether the mesh is
//! watertight, and lists its defects. With the feature `files`, which is on by default,
//! `Mesh::open`, `read_file` and `read` take OBJ, STL, PLY and glTF files.
//!
//! ```
//! use palpate_field::Vector;
//! use palpate_mesh::TriangleMesh;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
//! let mesh = TriangleMesh::new(corners.map(Vector).to_vec(), faces)?;
//! let report = mesh.report();
//! assert!(report.is_watertight());
//! assert_eq!(report.enclosed, Some(1.0)); // 1 · 2 · 3 / 6 [m³]
//! assert_eq!(report.to_string(), "4 elements of 4 vertices, watertight");
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod contour;
mod encoding;
mod instances;
mod mesh;
#[cfg(feature = "files")]
mod read;
mod report;
mod solid;
mod tree;
#[cfg(feature = "files")]
mod write;

pub use contour::{ContourError, ContourOptions, FitProgress, FittedMesh, MOST_TRIANGLES};
#[doc(hidden)]
pub use encoding::utf16_is_little_endian;
#[doc(hidden)]
pub use instances::instances;
pub use mesh::MeshError;
pub use mesh::{MOST_CORNERS, Mesh, Outline, TriangleMesh};
#[cfg(feature = "files")]
pub use read::{Format, LARGEST_FILE, ReadError, ReadProblem, read, read_file};
pub use report::Report;
pub use solid::{Cracks, Findings, MeshSheet, Opening, Solid, SolidError};
pub use tree::{BallTree, FAN, Level};
pub use tree::{centre_weights, circumscribed_ball, smallest_ball};
