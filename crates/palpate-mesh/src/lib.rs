// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Triangle meshes, and outlines of segments in the plane.
//!
//! A [`Mesh`] is checked when it is made: its numbers are finite, its elements name
//! vertices that exist, and there is at least one. [`Mesh::report`] says whether it is
//! watertight, and what else is odd about it. [`read`] and [`read_file`] take OBJ, STL,
//! PLY and GLB files. A [`BallTree`] over the elements serves searches.
//!
//! ```
//! use palpate_mesh::{Format, read};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n\
//!                    f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
//! let mesh = read(tetrahedron.as_bytes(), Format::Obj)?;
//! let report = mesh.report();
//! assert!(report.is_watertight());
//! assert_eq!(report.enclosed, Some(1.0)); // 1 · 2 · 3 / 6 [m³]
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod ball;
mod error;
mod mesh;
mod polygon;
mod read;
mod report;
mod tree;

pub use ball::{centre_weights, smallest_ball};
pub use error::{MeshError, ReadError, ReadProblem};
pub use mesh::{Mesh, Outline, TriangleMesh};
pub use polygon::MOST_CORNERS;
pub use read::{Format, LARGEST_FILE, read, read_file};
pub use report::Report;
pub use tree::{BallTree, FAN, Level};
