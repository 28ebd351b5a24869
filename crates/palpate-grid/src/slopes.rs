// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ranges of the slopes over blocks of nodes, and over blocks of blocks.
//!
//! Over any cells, each derivative of the interpolation is a mean of differences of neighbours along its axis.

use palpate_field::Aabb;

use crate::lattice::{Lattice, indices, raveled};

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
