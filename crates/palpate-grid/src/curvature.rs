// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much the interpolation bends over a few cells.
//!
//! A second derivative of a B-spline is a mean of second differences of its samples: of those along the axis, or of
//! the mixed ones of two axes. So they bound it over every cell that takes these samples. In a cell of products of
//! linear functions only mixed ones are not zero, and nothing bounds it across a side of the cell.

use crate::samples::{BRICK, Order, Samples, Window};
use crate::spline::TRILINEAR;

/// The most samples along an axis: of two cells of quadratic splines.
const MOST: usize = 4;

/// The second differences of samples [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature<const D: usize> {
    /// The least and the largest along each axis.
    along: [[f64; 2]; D],
    /// The largest size of mixed ones of two axes, the first of which is lower.
    mixed: [[f64; D]; D],
}

impl<const D: usize> Curvature<D> {
    /// How far a function with these second differences in a lattice of cells [m] is below and above its tangent plane
    /// at most, over a box with half sides about the point of the plane [m].
    pub(crate) fn off_tangent(&self, cell: f64, half: [f64; D]) -> [f64; 2] {
        let half = half.map(|half| half / cell);
        let [mut below, mut above] = [0.0; 2];
        for i in 0..D {
            let [least, largest] = self.along[i];
            below += 0.5 * (-least).max(0.0) * half[i] * half[i];
            above += 0.5 * largest.max(0.0) * half[i] * half[i];
            for k in i + 1..D {
                let mixed = self.mixed[i][k] * half[i] * half[k];
                below += mixed;
                above += mixed;
            }
        }
        [below, above]
    }
}

impl<const D: usize> Samples<D> {
    /// The second differences of the samples that the cells take whose first samples are from `first` to `last`;
    /// `None` if these are too many cells, or not stored together.
    pub(crate) fn curvature<const K: usize>(
        &self,
        first: [usize; D],
        last: [usize; D],
    ) -> Option<Curvature<D>> {
        let most = if K == TRILINEAR { K } else { MOST };
        let counts: [usize; D] = std::array::from_fn(|i| last[i] - first[i] + K);
        // The cells of a brick find all their samples beside it.
        let brick = |i: usize| (first[i] + K - 2) / BRICK == (last[i] + K - 2) / BRICK;
        let is_together = matches!(self.order, Order::Dense { .. }) || (0..D).all(brick);
        if !is_together || counts.iter().any(|count| *count > most) {
            return None;
        }
        let Window::Stored { first, strides } = self.window(first, K) else { return None };
        // An axis that is not there has one sample.
        let of =
            |all: [usize; D], axis: usize, none: usize| all.get(axis).copied().unwrap_or(none);
        let [counts, strides] = [(counts, 1), (strides, 0)]
            .map(|(all, none)| [0, 1, 2].map(|axis| of(all, axis, none)));
        let mut samples = [[[0.0; MOST]; MOST]; MOST];
        for (z, plane) in samples.iter_mut().enumerate().take(counts[2]) {
            for (y, row) in plane.iter_mut().enumerate().take(counts[1]) {
                let start = first + y * strides[1] + z * strides[2];
                for (x, sample) in row.iter_mut().enumerate().take(counts[0]) {
                    *sample = self.decoded(start + x);
                }
            }
        }
        Some(second_differences(&samples, counts))
    }
}

/// The second differences of samples, the last axis first.
fn second_differences<const D: usize>(
    samples: &[[[f64; MOST]; MOST]; MOST],
    [nx, ny, nz]: [usize; 3],
) -> Curvature<D> {
    let mut along = [[0.0_f64; 2]; 3];
    let mut mixed = [0.0_f64; 3];
    let bend = |[least, largest]: &mut [f64; 2], [a, b, c]: [f64; 3]| {
        let second = a - 2.0 * b + c;
        (*least, *largest) = (least.min(second), largest.max(second));
    };
    let twist = |largest: &mut f64, [[a, b], [c, d]]: [[f64; 2]; 2]| {
        *largest = largest.max((a - b - c + d).abs());
    };
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let at = |i: usize, k: usize, l: usize| samples[z + l][y + k][x + i];
                if x + 2 < nx {
                    bend(&mut along[0], [at(0, 0, 0), at(1, 0, 0), at(2, 0, 0)]);
                }
                if y + 2 < ny {
                    bend(&mut along[1], [at(0, 0, 0), at(0, 1, 0), at(0, 2, 0)]);
                }
                if z + 2 < nz {
                    bend(&mut along[2], [at(0, 0, 0), at(0, 0, 1), at(0, 0, 2)]);
                }
                let [right, up, back] = [x + 1 < nx, y + 1 < ny, z + 1 < nz];
                if right && up {
                    let square = [[at(0, 0, 0), at(1, 0, 0)], [at(0, 1, 0), at(1, 1, 0)]];
                    twist(&mut mixed[0], square);
                }
                if right && back {
                    let square = [[at(0, 0, 0), at(1, 0, 0)], [at(0, 0, 1), at(1, 0, 1)]];
                    twist(&mut mixed[1], square);
                }
                if up && back {
                    let square = [[at(0, 0, 0), at(0, 1, 0)], [at(0, 0, 1), at(0, 1, 1)]];
                    twist(&mut mixed[2], square);
                }
            }
        }
    }
    let pair = |i: usize, k: usize| mixed[i + k - 1];
    Curvature {
        along: std::array::from_fn(|i| along[i]),
        mixed: std::array::from_fn(|i| {
            std::array::from_fn(|k| if i < k { pair(i, k) } else { 0.0 })
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_differences_of_a_polynomial_are_its_second_derivatives() {
        // 3x² − 2y² + xy − 4yz.
        let f = |[x, y, z]: [f64; 3]| 3.0 * x * x - 2.0 * y * y + x * y - 4.0 * y * z;
        let along = [0.0, 1.0, 2.0, 3.0];
        let samples = along.map(|z| along.map(|y| along.map(|x| f([x, y, z]))));
        let found = second_differences::<3>(&samples, [4; 3]);
        assert_eq!(found.along, [[0.0, 6.0], [-4.0, 0.0], [0.0, 0.0]]);
        assert_eq!(found.mixed, [[0.0, 1.0, 0.0], [0.0, 0.0, 4.0], [0.0; 3]]);
        // Half sides of one and two cells of 0.1 m: ½·6·1² + |1|·1·2 above, ½·4·2² + 2 below.
        assert_eq!(found.off_tangent(0.1, [0.1, 0.2, 0.0]), [10.0, 5.0]);
    }
}
