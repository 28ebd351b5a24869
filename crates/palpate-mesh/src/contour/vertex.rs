// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Vertices of a contour, fitted to the planes of its crossings.

use palpate_field::{Aabb, Shape, Vector};

use super::Corner;
use super::cells::Crossing;

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
pub(super) fn best(crossings: &[Crossing]) -> [Vector<f64, 3>; 2] {
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
