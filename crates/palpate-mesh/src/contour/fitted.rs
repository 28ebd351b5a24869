// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes of shapes with their error.

use std::ops::ControlFlow;

use palpate_field::{Point, Shape, Vector};

use super::{ContourError, ContourOptions, made};
use crate::mesh::TriangleMesh;

/// Cells along the longest side with which a tolerance is tried first.
const FIRST_TRY: f64 = 30.0;

/// How often cells are made smaller for a tolerance.
const MOST_TRIES: usize = 12;

/// A mesh of a shape, and how far it is from the surface.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FittedMesh {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// The side of its cells [m].
    pub cell: f64,
    /// The largest size of the field on a triangle [m]: one that was found, and one that none exceeds. Of an exact
    /// field it is the largest distance of a triangle from the surface.
    pub error: [f64; 2],
    /// A point of a part of the shape, or of a cavity, that lies between the nodes of the cells and has no triangle. `None`
    /// if none was found: the middles of cells are followed down the field's slope, and a part in a cell beside one with a
    /// triangle is not told from it.
    pub lost: Option<Point<3>>,
}

/// How far a fit is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitProgress {
    /// The side of the cells of this try [m].
    pub cell: f64,
    /// The share of the mesh that is made; 1 while its error is looked at.
    pub share: f64,
}

/// Hears how far a fit is, and can stop it.
type Watch<'a> = &'a mut dyn FnMut(FitProgress) -> ControlFlow<()>;

impl FittedMesh {
    /// The mesh by the cells of the options, with its error. `progress` can stop the work.
    ///
    /// # Errors
    ///
    /// As of [`TriangleMesh::of_shape_with`].
    pub fn by_cells(
        shape: &Shape<3>,
        options: &ContourOptions,
        progress: Watch<'_>,
    ) -> Result<Self, ContourError> {
        Self::judged(shape, options, f64::INFINITY, progress)
    }

    /// A mesh of which no triangle has a larger field than `tolerance` [m]: cells, at most as large as those of the
    /// options, are made smaller until that is proven and no part is known to be [lost](Self::lost). What a dozen tries do
    /// not reach is left open: the error of the answer is then larger, or it says what is lost. `progress` can stop the work.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use palpate_field::Shape;
    /// use palpate_mesh::{ContourOptions, FittedMesh};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (ball, options) = (Shape::sphere(0.5)?, ContourOptions::with_cell(1.0));
    /// let fitted =
    ///     FittedMesh::by_tolerance(&ball, 1e-3, &options, &mut |_| ControlFlow::Continue(()))?;
    /// let [found, proven] = fitted.error;
    /// assert!(found <= proven && proven <= 1e-3);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As of [`TriangleMesh::of_shape_with`], and if the tolerance is no length.
    pub fn by_tolerance(
        shape: &Shape<3>,
        tolerance: f64,
        options: &ContourOptions,
        progress: Watch<'_>,
    ) -> Result<Self, ContourError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(ContourError::Tolerance { tolerance });
        }
        let bounds = shape.promise().bounds.ok_or(ContourError::Unbounded)?.aabb;
        let longest = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        let mut cell = (longest / FIRST_TRY).max(tolerance).min(options.cell);
        let (mut last, mut refused) = (None, None);
        for _ in 0..MOST_TRIES {
            let tried = ContourOptions { cell, ..options.clone() };
            let off = match Self::judged(shape, &tried, tolerance, progress) {
                Ok(made) if made.error[1] <= tolerance && made.lost.is_none() => {
                    return Ok(made);
                }
                Ok(made) => {
                    let made = last.insert(made);
                    if made.lost.is_some() { f64::INFINITY } else { made.error[1] }
                }
                Err(error @ ContourError::NoSurface { .. }) => {
                    refused = Some(error);
                    f64::INFINITY
                }
                Err(ContourError::Stopped) => return Err(ContourError::Stopped),
                Err(error) => {
                    refused = Some(match (error, refused) {
                        (
                            ContourError::TooMany { limit, .. },
                            Some(ContourError::NoSurface { cell }),
                        ) => ContourError::TooThin { cell, limit },
                        (error, _) => error,
                    });
                    break;
                }
            };
            // Errors go with the square of a cell where a surface is curved, with the cell at edges.
            cell *= (0.9 * tolerance / off).sqrt().clamp(0.3, 0.9);
        }
        match last {
            // That of the smallest cells. Its error was looked at only until it was above the tolerance.
            Some(last) => last.measured(shape, f64::INFINITY, progress),
            None => Err(refused.unwrap_or(ContourError::NoSurface { cell })),
        }
    }

    /// The mesh, if no triangle has a larger field than `tolerance` [m], which is proven, and no part is known to be lost.
    ///
    /// # Errors
    ///
    /// If its error is larger, or a part is lost.
    pub fn within(self, tolerance: f64) -> Result<TriangleMesh, ContourError> {
        let Self { mesh, cell, error: [_, proven], lost } = self;
        match lost {
            Some(Vector(point)) => Err(ContourError::Lost { point, cell }),
            None if proven > tolerance => {
                Err(ContourError::NotReached { tolerance, cell, proven })
            }
            None => Ok(mesh),
        }
    }

    /// The mesh by cells, with its error as far as it is not above `most` [m].
    fn judged(
        shape: &Shape<3>,
        options: &ContourOptions,
        most: f64,
        progress: Watch<'_>,
    ) -> Result<Self, ContourError> {
        let cell = options.cell;
        let (mesh, lost) =
            made(shape, options, true, &mut |share| progress(FitProgress { cell, share }))?;
        Self { mesh, cell, error: [0.0; 2], lost }.measured(shape, most, progress)
    }

    /// The same with its error. One above `most` [m] is not looked at further: it is then what was found.
    fn measured(
        self,
        shape: &Shape<3>,
        most: f64,
        progress: Watch<'_>,
    ) -> Result<Self, ContourError> {
        let (mut known, mut is_stopped, cell) = (0.0, false, self.cell);
        let error = self.mesh.largest_distance_with(shape, &mut |found| {
            known = found;
            is_stopped = progress(FitProgress { cell, share: 1.0 }).is_break();
            if found > most || is_stopped {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if is_stopped {
            return Err(ContourError::Stopped);
        }
        Ok(Self { error: error.unwrap_or([known; 2]), ..self })
    }
}
