// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Voxel grids as signed distance fields, with certified steepness and deviation.
//!
//! A [`Grid`] holds samples of a shape's distance at the nodes of a lattice, and interpolates them with
//! B-splines. It is a shape of its own: its [`Promise`](palpate_field::Promise) says how steep it is, and how far
//! it deviates from the shape that it was baked from. A distance and its gradient take the same short time
//! everywhere, whatever the shape costs.
//!
//! ```
//! use palpate_field::Shape;
//! use palpate_grid::{Grid, GridOptions};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ball = Shape::sphere(0.05)?;
//! let grid = Grid::bake(&ball, &GridOptions::with_tolerance(2e-4))?;
//! // Values differ by at most what was asked for; of an exact shape, places too.
//! assert!(grid.deviation() <= 2e-4);
//! let baked: Shape<3> = grid.into();
//! assert!((baked.distance([0.06, 0.0, 0.0]) - 0.01).abs() <= 2e-4);
//! # Ok(())
//! # }
//! ```

mod bake;
mod blocks;
#[cfg(feature = "files")]
mod cache;
mod certificate;
mod error;
#[cfg(feature = "files")]
mod file;
mod grid;
mod instances;
mod samples;
mod slopes;
mod spline;
#[cfg(feature = "volumes")]
mod volume;

pub use bake::{GridOptions, GridProgress, Resolution};
#[cfg(feature = "files")]
pub use cache::{Found, GridCache};
pub use error::GridError;
#[cfg(feature = "files")]
pub use file::{GridFileError, GridFileProblem, LARGEST_FILE};
pub use grid::{Grid, Lattice};
#[doc(hidden)]
pub use instances::instances;
pub use samples::Store;
pub use spline::GridKernel;
#[cfg(feature = "volumes")]
pub use volume::{Inside, LARGEST_VOLUME, Volume, VolumeError, VolumeProblem};
