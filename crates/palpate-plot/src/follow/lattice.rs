// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The corners and cells of the finest level, by whole numbers.

use super::Cell;
use crate::geometry::Point;
use crate::sampling::Sampling;
use crate::view::PlaneView;

/// Finest cells along a cell of the sampling, as a power of two.
const FINER: u32 = 2;

/// Cells along the longer side at the coarsest level, at most.
const COARSEST: usize = 16;

/// The window begins this many finest cells within the lattice, across and up. No round numbers:
/// the axes of a scene, along which its surfaces like to lie, then run between corners.
const SHIFT: Point = [1.381_966, 1.708_204];

/// A rectangle of square cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lattice {
    /// Lower left corner [m].
    origin: Point,
    /// Edge of a finest cell [m].
    pub(super) edge: f64,
    /// Finest cells across and up.
    pub(super) count: [usize; 2],
    /// Levels above the finest one.
    pub(super) levels: u32,
}

/// A cell by the finest cells that it spans: from `at`, 2 to the `level` of them across and up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Spot {
    pub(super) at: [usize; 2],
    pub(super) level: u32,
}

impl Lattice {
    /// The lattice over `view` and a border.
    pub(super) fn over(view: &PlaneView, sampling: Sampling) -> Self {
        let longer = view.width().max(view.height());
        let edge = longer / (sampling.cells() << FINER) as f64;
        let count = |size: f64, shift: f64| (size / edge + 2.0 * shift).ceil() as usize;
        let count = [count(view.width(), SHIFT[0]), count(view.height(), SHIFT[1])];
        let largest = count[0].max(count[1]);
        let mut levels = 0;
        while largest.div_ceil(1 << levels) > COARSEST {
            levels += 1;
        }
        let origin = [0, 1].map(|k| view.min()[k] - SHIFT[k] * edge);
        Self { origin, edge, count, levels }
    }

    /// The lattice with cells of `level` as the finest ones, which may reach beyond this one.
    pub(super) fn coarser(&self, level: u32) -> Self {
        Self {
            edge: self.edge * f64::from(1_u32 << level),
            count: self.count.map(|count| count.div_ceil(1 << level)),
            levels: self.levels - level,
            ..*self
        }
    }

    /// The place of a corner [m].
    pub(super) fn corner(&self, at: [usize; 2]) -> Point {
        [0, 1].map(|k| self.origin[k] + at[k] as f64 * self.edge)
    }

    /// A cell of any level.
    pub(super) fn cell(&self, spot: Spot) -> Cell {
        let half = 0.5 * self.edge * f64::from(1_u32 << spot.level);
        Cell { centre: self.corner(spot.at).map(|x| x + half), half }
    }

    /// The cells of the coarsest level.
    pub(super) fn roots(&self) -> Vec<Spot> {
        let level = self.levels;
        let [across, up] = self.count.map(|count| count.div_ceil(1 << level));
        let spot = |i: usize| Spot { at: [i % across, i / across].map(|k| k << level), level };
        (0..across * up).map(spot).collect()
    }

    /// The quarters of a cell that lie in the lattice.
    pub(super) fn quarters(&self, spot: Spot) -> impl Iterator<Item = Spot> {
        let level = spot.level - 1;
        let quarters = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|quarter: [usize; 2]| Spot {
            at: [0, 1].map(|k| spot.at[k] + (quarter[k] << level)),
            level,
        });
        let count = self.count;
        quarters.into_iter().filter(move |spot| (0..2).all(|k| spot.at[k] < count[k]))
    }
}
