// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Slopes and curvature of samples.
//!
//! Ranges of the slopes over blocks of nodes, and over blocks of blocks.
//!
//! Over any cells, each derivative of the interpolation is a mean of differences of neighbours along its axis.
//!
//! How much the interpolation bends over a few cells.
//!
//! A second derivative of a B-spline is a mean of second differences of its samples: of those along the axis, or of
//! the mixed ones of two axes. So they bound it over every cell that takes these samples. In a cell of products of
//! linear functions only mixed ones are not zero, and nothing bounds it across a side of the cell.

use palpate_field::Aabb;

use crate::grid::{Lattice, indices, raveled};
use crate::samples::{BRICK, Order, Samples, Window};
use crate::spline::TRILINEAR;

/// Nodes along an axis of the smallest blocks.
pub(crate) const SLOPE_BLOCK: usize = 2;

/// Blocks that one question looks at, at most, along an axis.
const MOST_BLOCKS: usize = 3;

/// The least and the largest difference of neighbours [m], rounded outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    pub(crate) least: f32,
    pub(crate) largest: f32,
}

impl Range {
    /// The range of nothing.
    pub(crate) const EMPTY: Self = Self { least: f32::INFINITY, largest: f32::NEG_INFINITY };

    /// Widens the range to hold a difference that may be off by `slack` [m].
    pub(crate) fn include(&mut self, difference: f64, slack: f64) {
        let [low, high] = [difference - slack, difference + slack];
        let [below, above] = [low as f32, high as f32];
        let below = if f64::from(below) > low { below.next_down() } else { below };
        let above = if f64::from(above) < high { above.next_up() } else { above };
        self.least = self.least.min(below);
        self.largest = self.largest.max(above);
    }

    fn union(&mut self, other: Self) {
        self.least = self.least.min(other.least);
        self.largest = self.largest.max(other.largest);
    }
}

/// The ranges of blocks, of twice as large ones, and so on, up to one for all nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slopes<const D: usize> {
    levels: Vec<Level<D>>,
}

#[derive(Clone, Debug, PartialEq)]
struct Level<const D: usize> {
    counts: [usize; D],
    ranges: Vec<[Range; D]>,
}

impl<const D: usize> Level<D> {
    fn empty(counts: [usize; D]) -> Self {
        Self { counts, ranges: vec![[Range::EMPTY; D]; counts.iter().product()] }
    }

    /// Calls `visit` with the ranges of the blocks from `from` to before `end`, row by row of the first axis.
    #[inline]
    fn rows(&self, from: [usize; D], end: [usize; D], mut visit: impl FnMut(&[[Range; D]])) {
        // An axis that is not there has one row.
        let of =
            |all: &[usize; D], axis: usize, none: usize| all.get(axis).copied().unwrap_or(none);
        let [ys, zs] = [1, 2].map(|axis| of(&from, axis, 0)..of(&end, axis, 1));
        for z in zs {
            for y in ys.clone() {
                let row = self.counts[0] * (y + of(&self.counts, 1, 1) * z);
                visit(&self.ranges[row + from[0]..row + end[0]]);
            }
        }
    }

    fn add(&mut self, block: [usize; D], ranges: &[Range; D]) {
        for (range, more) in self.ranges[raveled(block, self.counts)].iter_mut().zip(ranges) {
            range.union(*more);
        }
    }
}

impl<const D: usize> Slopes<D> {
    /// From the ranges in the parts of each brick, the first axis first.
    pub(crate) fn new<'a>(
        bricks: [usize; D],
        parts: usize,
        of_brick: impl Fn([usize; D]) -> &'a [[Range; D]],
    ) -> Self {
        let mut level = Level::empty(bricks.map(|count| count * parts));
        for brick in indices([0; D], bricks) {
            for (part, ranges) in indices([0; D], [parts; D]).zip(of_brick(brick)) {
                level.add(std::array::from_fn(|i| brick[i] * parts + part[i]), ranges);
            }
        }
        let mut levels = vec![level];
        while let Some(last) = levels.last().filter(|last| last.ranges.len() > 1) {
            let mut next = Level::empty(last.counts.map(|count| count.div_ceil(2)));
            for (block, ranges) in indices([0; D], last.counts).zip(&last.ranges) {
                next.add(block.map(|i| i / 2), ranges);
            }
            levels.push(next);
        }
        Self { levels }
    }

    /// The least and the largest of each derivative over a box, within the cells of `K` samples along each axis.
    pub(crate) fn of_box<const K: usize>(
        &self,
        lattice: &Lattice<D>,
        around: &Aabb<D>,
    ) -> [[f64; 2]; D] {
        let (first, _) = lattice.locate::<K>(around.min);
        let (last, _) = lattice.locate::<K>(around.max);
        self.over(first, last.map(|index| index + K - 1)).map(|range| {
            [range.least, range.largest].map(|difference| f64::from(difference) / lattice.cell)
        })
    }

    /// A range for each axis that holds the differences [m] between the nodes from `first` to `last`.
    fn over(&self, first: [usize; D], last: [usize; D]) -> [Range; D] {
        let mut size = SLOPE_BLOCK;
        let mut ranges = [Range::EMPTY; D];
        for (number, level) in self.levels.iter().enumerate() {
            let spans = (0..D).map(|i| last[i] / size - first[i] / size + 1);
            let is_last = number + 1 == self.levels.len();
            if is_last || spans.max() <= Some(MOST_BLOCKS) {
                let from = first.map(|i| i / size);
                let end: [usize; D] =
                    std::array::from_fn(|i| (last[i] / size + 1).min(level.counts[i]));
                level.rows(from, end, |row| {
                    for more in row {
                        for (range, more) in ranges.iter_mut().zip(more) {
                            range.union(*more);
                        }
                    }
                });
                break;
            }
            size *= 2;
        }
        ranges
    }
}

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
mod curvature_tests {
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
