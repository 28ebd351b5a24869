// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes around groups of eight elements, around eight of those groups, and so on.
//!
//! The groups are those of [`BallTree`](crate::tree::BallTree): runs of elements in its order.

use palpate_field::{Aabb, Point};

use crate::tree::FAN;

/// The most levels: eight boxes around eight each, up to `u32::MAX` elements.
const MOST_LEVELS: usize = 11;

/// The bits of a key that tell the number of its box.
const NUMBER: u64 = FAN as u64 - 1;

/// The key of a box that was visited, or of padding: `f64::MAX` without the bits of the number. All others are less.
const DONE: f64 = f64::from_bits(f64::MAX.to_bits() & !NUMBER);

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

    /// The groups of eight elements as seen from a point.
    #[inline(always)]
    pub(crate) fn from(&self, p: Point<D>) -> Walk<'_, D> {
        let level = self.levels.len() - 1;
        let mut keys = [[DONE; FAN]; MOST_LEVELS];
        keys[level] = self.levels[level].keys(p, 0);
        Walk { boxes: self, p, level, groups: [0; MOST_LEVELS], keys }
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

/// A walk over groups, the nearest first as far as boxes tell.
pub(crate) struct Walk<'a, const D: usize> {
    boxes: &'a Boxes<D>,
    p: Point<D>,
    level: usize,
    /// Of each level, the group that is looked into, and the keys of its boxes.
    groups: [usize; MOST_LEVELS],
    keys: [[f64; FAN]; MOST_LEVELS],
}

impl<const D: usize> Walk<'_, D> {
    /// The number of the next group of eight elements whose box is nearer than the square of a distance [m²]; none
    /// from a point that is not finite.
    #[inline(always)]
    pub(crate) fn next(&mut self, least: f64) -> Option<usize> {
        loop {
            let keys = &mut self.keys[self.level];
            let mut nearest = DONE;
            for key in *keys {
                nearest = if key < nearest { key } else { nearest };
            }
            let matters = nearest < least && nearest < DONE;
            if !matters {
                if self.level + 1 == self.boxes.levels.len() {
                    return None;
                }
                self.level += 1;
                continue;
            }
            let number = (nearest.to_bits() & NUMBER) as usize;
            keys[number] = DONE;
            let node = self.groups[self.level] * FAN + number;
            if self.level == 0 {
                return Some(node);
            }
            self.level -= 1;
            self.groups[self.level] = node;
            self.keys[self.level] = self.boxes.levels[self.level].keys(self.p, node);
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

    /// The squares of the distances to the boxes of a group [m²], each with the box's number in its last three bits, so
    /// that the least tells which box it is without a branch.
    #[inline(always)]
    fn keys(&self, p: Point<D>, group: usize) -> [f64; FAN] {
        let mut squared = [0.0; FAN];
        for k in 0..D {
            let min = &self.min[k][group * FAN..][..FAN];
            let max = &self.max[k][group * FAN..][..FAN];
            for i in 0..FAN {
                let away = (min[i] - p[k]).max(p[k] - max[i]).max(0.0);
                squared[i] += away * away;
            }
        }
        for (i, squared) in squared.iter_mut().enumerate() {
            // Padding is at infinity; what is not a number is passed over.
            let far = if *squared < DONE { *squared } else { DONE };
            *squared = f64::from_bits(far.to_bits() & !NUMBER | i as u64);
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
