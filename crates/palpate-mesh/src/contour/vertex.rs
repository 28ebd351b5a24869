// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Vertices of a contour, fitted to the planes of its crossings.

use std::ops::ControlFlow;

use palpate_field::{Aabb, Point, Shape, Vector};

use super::cells::Crossing;
use super::{ContourError, ContourOptions, Corner, made};
use crate::mesh::TriangleMesh;

/// Directions in which the planes say less than this share of what they say in the clearest one are left alone:
/// the vertex is then in the middle of the crossings.
const CLEAR: f64 = 0.05;

/// A vertex keeps this share of its cell's side from the faces, so that no two vertices are at one place.
const INSET: f64 = 1e-3;

/// Steps towards the surface at most.
const STEPS: usize = 4;

/// Sweeps over a matrix at most: three reach rounding.
const SWEEPS: usize = 8;

/// The vertex of a patch of a shape in a cell: the [best point](best) for its crossings if that is in the cell, else
/// the point of the cell nearest to it, brought to the surface.
pub(super) fn of(shape: &Shape<3>, crossings: &[Crossing], cell: &Aabb<3>) -> Corner {
    let [best, middle] = best(crossings);
    let Aabb { min, max } = *cell;
    let inset = (max - min) * INSET;
    let clamped = |p: Vector<f64, 3>| {
        Vector(std::array::from_fn(|i| p[i].clamp(min[i] + inset[i], max[i] - inset[i])))
    };
    let mut place = clamped(best);
    if place != best {
        let mut off = shape.distance(place).abs();
        for _ in 0..STEPS {
            let (value, slope) = shape.distance_gradient(place);
            let steep = slope.dot(slope);
            let next = clamped(place - slope * (value / if steep > 0.0 { steep } else { 1.0 }));
            let nearer = shape.distance(next).abs();
            // Written so that NaN is no nearer.
            let is_nearer = nearer < off;
            if !is_nearer {
                break;
            }
            (place, off) = (next, nearer);
        }
    }
    Corner { place, middle: clamped(middle) }
}

/// The point of least `Σ (nᵢ·(x − pᵢ))²` nearest to the middle of the crossings, and that middle.
fn best(crossings: &[Crossing]) -> [Vector<f64, 3>; 2] {
    let share = 1.0 / crossings.len() as f64;
    let middle =
        crossings.iter().fold(Vector::ZERO, |sum, crossing| sum + crossing.place * share);
    let mut matrix = [[0.0; 3]; 3];
    let mut right = Vector::ZERO;
    for Crossing { place, normal } in crossings {
        let off = normal.dot(*place - middle);
        right += *normal * off;
        for (i, row) in matrix.iter_mut().enumerate() {
            for (k, number) in row.iter_mut().enumerate() {
                *number += normal[i] * normal[k];
            }
        }
    }
    let (values, vectors) = eigen(matrix);
    let largest = values.iter().copied().fold(0.0, f64::max);
    let mut place = middle;
    for (value, vector) in values.into_iter().zip(vectors) {
        if value > CLEAR * largest {
            place += vector * (vector.dot(right) / value);
        }
    }
    [place, middle]
}

/// The eigenvalues and unit eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [Vector<f64, 3>; 3]) {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let [low, high] = [Vector(a[p]), Vector(a[q])];
            (a[p], a[q]) = ((low * c - high * s).0, (low * s + high * c).0);
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    let vector = |k: usize| Vector([v[0][k], v[1][k], v[2][k]]);
    ([a[0][0], a[1][1], a[2][2]], [vector(0), vector(1), vector(2)])
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_their_corner() {
        let corner = Vector([0.3, 0.6, 0.2]);
        let plane = |axis: usize, off: Vector<f64, 3>| {
            let mut normal = Vector::ZERO;
            normal[axis] = 1.0;
            let mut place = off;
            place[axis] = corner[axis];
            Crossing { place, normal }
        };
        let crossings = [
            plane(0, Vector([0.0; 3])),
            plane(1, Vector([1.0; 3])),
            plane(2, Vector([0.5; 3])),
        ];
        let [found, _] = best(&crossings);
        assert!((found - corner).norm() < 1e-12, "{found:?}");
        // One plane alone leaves the vertex in the middle.
        let flat = [plane(0, Vector([0.2, 0.0, 0.0])), plane(0, Vector([0.9, 0.4, 1.0]))];
        assert!((best(&flat)[0] - Vector([0.3, 0.2, 0.5])).norm() < 1e-12);
    }

    #[test]
    fn eigenvectors_are_turned_into_themselves() {
        let matrix = [[2.0, -1.0, 0.5], [-1.0, 3.0, 0.25], [0.5, 0.25, 1.0]];
        let (values, vectors) = eigen(matrix);
        for (value, vector) in values.into_iter().zip(vectors) {
            let turned = Vector(matrix.map(|row| Vector(row).dot(vector)));
            assert!((turned - vector * value).norm() < 1e-14);
            assert!((vector.norm() - 1.0).abs() < 1e-14);
        }
    }
}
