// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes of shapes with a proven error: by cells of a size, or within a tolerance.

use std::ops::ControlFlow;

use palpate_field::{Point, Shape, Vector};

use super::refine::Target;
use super::surface::Surface;
use super::{ContourError, ContourOptions, made};
use crate::mesh::TriangleMesh;
use crate::solid::crossing_faces;

/// Cells along the longest side with which a tolerance is tried first.
const FIRST_TRY: f64 = 30.0;

/// How often cells are made smaller for a tolerance, and how much each time.
const MOST_TRIES: usize = 12;
const SMALLER: f64 = 0.5;

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
        let cell = options.cell;
        let (mesh, lost) =
            made(shape, options, true, &mut |share| progress(FitProgress { cell, share }))?;
        Self { mesh, cell, error: [0.0; 2], lost }.measured(shape, f64::INFINITY, progress)
    }

    /// A mesh of which no triangle has a larger field than `tolerance` [m], which is proven.
    ///
    /// Cells of at most the size of the options find the surface. Vertices are moved onto edges and corners of the shape,
    /// edges are split where they are too far from it, and collapsed where the tolerance allows it: flat faces get large
    /// triangles. Where that does not come within the tolerance, or a part is [lost](Self::lost), smaller cells are tried.
    /// What a dozen tries do not reach is left open: the error of the answer is then larger, or it says what is lost.
    /// `progress` can stop the work.
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
            match made(shape, &tried, true, &mut |share| progress(FitProgress { cell, share }))
            {
                Ok((mesh, None)) => {
                    if let Some(fitted) =
                        fitted(&mesh, shape, tolerance, &tried, &mut *progress)?
                    {
                        return Self { mesh: fitted, cell, error: [tolerance; 2], lost: None }
                            .measured(shape, tolerance, progress);
                    }
                    last = Some(Self { mesh, cell, error: [0.0; 2], lost: None });
                }
                Ok((mesh, lost)) => last = Some(Self { mesh, cell, error: [0.0; 2], lost }),
                Err(error @ ContourError::NoSurface { .. }) => refused = Some(error),
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
            }
            cell *= SMALLER;
        }
        match last {
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

    /// The same with its error, which is known to be at most `most` [m].
    fn measured(
        self,
        shape: &Shape<3>,
        most: f64,
        progress: Watch<'_>,
    ) -> Result<Self, ContourError> {
        let cell = self.cell;
        let error = self
            .mesh
            .largest_distance_with(shape, &mut |_| progress(FitProgress { cell, share: 1.0 }));
        let [found, proven] = error.ok_or(ContourError::Stopped)?;
        Ok(Self { error: [found, proven.min(most)], ..self })
    }
}

/// The triangles of a mesh brought within a tolerance of a shape, as few as that takes; `None` if they do not come there.
fn fitted(
    mesh: &TriangleMesh,
    shape: &Shape<3>,
    tolerance: f64,
    options: &ContourOptions,
    progress: Watch<'_>,
) -> Result<Option<TriangleMesh>, ContourError> {
    let ContourOptions { cell, is_single, most_triangles, .. } = *options;
    let target = Target { shape, tolerance, is_single, most_triangles };
    let mut go_on = || progress(FitProgress { cell, share: 1.0 });
    let mut surface = Surface::of(mesh);
    if !target.refine(&mut surface, &mut go_on)? {
        return Ok(None);
    }
    let fine = surface.clone();
    target.simplify(&mut surface, &mut go_on)?;
    for surface in [surface, fine] {
        let mesh = surface.mesh()?;
        if crossing_faces(&mesh).is_empty() {
            return Ok(Some(mesh));
        }
    }
    Ok(None)
}
