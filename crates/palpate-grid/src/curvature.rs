// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much the interpolation bends over a few cells.
//!
//! A second derivative of a B-spline is a mean of second differences of its samples: of those along the axis, or of
//! the mixed ones of two axes. So they bound it over every cell that takes these samples. In a cell of products of
//! linear functions only mixed ones are not zero, and nothing bounds it across a side of the cell.

use crate::lattice::{indices, raveled, unravelled};
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
        let mut samples = [0.0; MOST.pow(3)];
        let all = counts.iter().product();
        for (number, sample) in samples.iter_mut().enumerate().take(all) {
            let index: [usize; D] = unravelled(number, counts);
            *sample =
                self.decoded(first + (0..D).map(|i| index[i] * strides[i]).sum::<usize>());
        }
        Some(second_differences(&samples, counts))
    }
}

/// The second differences of samples, the first axis first.
fn second_differences<const D: usize>(samples: &[f64], counts: [usize; D]) -> Curvature<D> {
    let ways = crate::samples::strides(counts);
    let mut along = [[0.0_f64; 2]; D];
    let mut mixed = [[0.0_f64; D]; D];
    for (i, [least, largest]) in along.iter_mut().enumerate() {
        let mut end = counts;
        end[i] = end[i].saturating_sub(2);
        for index in indices([0; D], end) {
            let place = raveled(index, counts);
            let second =
                samples[place] - 2.0 * samples[place + ways[i]] + samples[place + 2 * ways[i]];
            (*least, *largest) = (least.min(second), largest.max(second));
        }
        for k in i + 1..D {
            let mut end = counts;
            (end[i], end[k]) = (end[i] - 1, end[k] - 1);
            for index in indices([0; D], end) {
                let place = raveled(index, counts);
                let twice =
                    samples[place] - samples[place + ways[i]] - samples[place + ways[k]]
                        + samples[place + ways[i] + ways[k]];
                mixed[i][k] = mixed[i][k].max(twice.abs());
            }
        }
    }
    Curvature { along, mixed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_differences_of_a_polynomial_are_its_second_derivatives() {
        // 3x² − 2y² + xy − 4yz.
        let f = |[x, y, z]: [f64; 3]| 3.0 * x * x - 2.0 * y * y + x * y - 4.0 * y * z;
        let samples: Vec<f64> =
            indices([0; 3], [4; 3]).map(|index| f(index.map(|i| i as f64))).collect();
        let found = second_differences(&samples, [4; 3]);
        assert_eq!(found.along, [[0.0, 6.0], [-4.0, 0.0], [0.0, 0.0]]);
        assert_eq!(found.mixed, [[0.0, 1.0, 0.0], [0.0, 0.0, 4.0], [0.0; 3]]);
        // Half sides of one and two cells of 0.1 m: ½·6·1² + |1|·1·2 above, ½·4·2² + 2 below.
        assert_eq!(found.off_tangent(0.1, [0.1, 0.2, 0.0]), [10.0, 5.0]);
    }
}
