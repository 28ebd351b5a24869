// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes around groups of eight elements, around eight of those groups, and so on.
//!
//! The groups are those of [`BallTree`](crate::tree::BallTree): runs of elements in its order.

use palpate_field::{Aabb, Point};

use crate::tree::FAN;

/// The most levels: eight boxes around eight each, up to `u32::MAX` elements.
const MOST_LEVELS: usize = 11;

/// The most boxes that wait: seven of each level but the last.
const WAITING: usize = FAN + (FAN - 1) * (MOST_LEVELS - 1);

/// The boxes of one level, padded to whole groups of eight.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    min: [Vec<f64>; D],
    max: [Vec<f64>; D],
}

/// Boxes on the implicit order of the elements of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Boxes<const D: usize> {
    /// The first level has boxes around eight elements each, the last at most eight boxes.
    levels: Vec<Level<D>>,
}

/// A group of elements or of boxes, and the square of the distance to its box [m²].
#[derive(Clone, Copy, Debug)]
struct Waiting {
    squared: f64,
    level: usize,
    node: usize,
}

impl<const D: usize> Boxes<D> {
    /// The boxes around elements, which are in the order of the tree.
    pub(crate) fn new<const N: usize>(elements: &[[Point<D>; N]]) -> Self {
        let around = |group: &[[Point<D>; N]]| Aabb::around(group.iter().flatten().copied());
        let mut boxes: Vec<_> = elements.chunks(FAN).filter_map(around).collect();
        let mut levels = vec![Level::new(&boxes)];
        while boxes.len() > FAN {
            let union = |group: &[Aabb<D>]| group.iter().copied().reduce(|a, b| a.union(&b));
            boxes = boxes.chunks(FAN).filter_map(union).collect();
            levels.push(Level::new(&boxes));
        }
        Self { levels }
    }

    /// Calls `visit` with groups of eight elements, by number, the nearest first as far as boxes tell. `visit`
    /// returns the square of the distance [m²] beyond which no group matters any more. From a point that is
    /// not finite there are none.
    #[inline]
    pub(crate) fn nearest_first(
        &self,
        p: Point<D>,
        mut least: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        let mut waiting = Stack::new();
        waiting.push(self, p, [self.levels.len() - 1, 0], least);
        while let Some(Waiting { squared, level, node }) = waiting.pop() {
            // Written so that NaN, and padding, are passed over.
            let matters = squared < least;
            if !matters {
                continue;
            }
            if level == 0 {
                least = visit(node);
            } else {
                waiting.push(self, p, [level - 1, node], least);
            }
        }
    }

    /// Calls `visit` with the groups of eight elements, by number, whose boxes share a point with a box.
    pub(crate) fn overlapping(&self, around: &Aabb<D>, mut visit: impl FnMut(usize)) {
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, group)) = waiting.pop() {
            for i in self.levels[level].overlapping(around, group) {
                let node = group * FAN + i;
                if level == 0 {
                    visit(node);
                } else {
                    waiting.push((level - 1, node));
                }
            }
        }
    }
}

/// Boxes that wait, of each group the nearest last.
struct Stack {
    waiting: [Waiting; WAITING],
    count: usize,
}

impl Stack {
    fn new() -> Self {
        Self { waiting: [Waiting { squared: 0.0, level: 0, node: 0 }; WAITING], count: 0 }
    }

    #[inline]
    fn pop(&mut self) -> Option<Waiting> {
        self.count = self.count.checked_sub(1)?;
        Some(self.waiting[self.count])
    }

    /// Adds the boxes of a group of a level that are nearer than the square of a distance.
    #[inline]
    fn push<const D: usize>(
        &mut self,
        boxes: &Boxes<D>,
        p: Point<D>,
        [level, group]: [usize; 2],
        least: f64,
    ) {
        let first = self.count;
        let squared = boxes.levels[level].squared_distances(p, group);
        for (i, squared) in squared.into_iter().enumerate() {
            let matters = squared < least;
            if !matters {
                continue;
            }
            let mut place = self.count;
            while place > first && self.waiting[place - 1].squared < squared {
                self.waiting[place] = self.waiting[place - 1];
                place -= 1;
            }
            self.waiting[place] = Waiting { squared, level, node: group * FAN + i };
            self.count += 1;
        }
    }
}

impl<const D: usize> Level<D> {
    fn new(boxes: &[Aabb<D>]) -> Self {
        let padded = boxes.len().div_ceil(FAN) * FAN;
        // Padding boxes are at infinity.
        let mut level = Self {
            min: std::array::from_fn(|_| vec![f64::INFINITY; padded]),
            max: std::array::from_fn(|_| vec![f64::INFINITY; padded]),
        };
        for (i, aabb) in boxes.iter().enumerate() {
            for k in 0..D {
                (level.min[k][i], level.max[k][i]) = (aabb.min[k], aabb.max[k]);
            }
        }
        level
    }

    /// The squares of the distances to the boxes of a group [m²].
    #[inline]
    fn squared_distances(&self, p: Point<D>, group: usize) -> [f64; FAN] {
        let mut squared = [0.0; FAN];
        for k in 0..D {
            let min = &self.min[k][group * FAN..][..FAN];
            let max = &self.max[k][group * FAN..][..FAN];
            for i in 0..FAN {
                let away = (min[i] - p[k]).max(p[k] - max[i]).max(0.0);
                squared[i] += away * away;
            }
        }
        squared
    }

    /// Which boxes of a group share a point with a box.
    fn overlapping(&self, around: &Aabb<D>, group: usize) -> impl Iterator<Item = usize> {
        let is_apart = move |i: usize| {
            let i = group * FAN + i;
            (0..D).any(|k| self.min[k][i] > around.max[k] || self.max[k][i] < around.min[k])
        };
        (0..FAN).filter(move |i| !is_apart(*i))
    }
}
