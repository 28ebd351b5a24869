// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes of a search, and what is known of them.

use std::cmp::Ordering;

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Point, Vector};

/// Sides that are halved, as a share of the longest.
const LONG_SIDE: f64 = 0.6;

/// The last bits of a sum of models.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// A box, and what is known of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell<const D: usize> {
    /// Nothing in it is less [m].
    pub(crate) lower: f64,
    pub(crate) centre: Point<D>,
    /// Half of its sides.
    pub(crate) half: Vector<f64, D>,
}

impl<const D: usize> Cell<D> {
    pub(crate) const NOTHING: Self =
        Self { lower: f64::NEG_INFINITY, centre: Vector::ZERO, half: Vector::ZERO };

    /// A box of which nothing is known.
    pub(crate) fn unknown(aabb: &Aabb<D>) -> Self {
        let mut half = aabb.half_extents();
        for k in 0..D {
            half[k] = half[k].max(0.0);
        }
        Self { centre: aabb.centre(), half, ..Self::NOTHING }
    }

    /// No point of the box is farther from its centre [m].
    #[inline]
    pub(crate) fn radius(&self) -> f64 {
        self.half.norm() * (1.0 + ROUNDINGS)
    }

    /// Halves the box along its long sides, puts the parts after the first `count` of
    /// `parts`, and says how many there are then.
    #[inline]
    pub(crate) fn halve(&self, parts: &mut [Self], count: usize) -> usize {
        let longest = (0..D).fold(0.0_f64, |longest, k| longest.max(self.half[k]));
        parts[count] = *self;
        let mut end = count + 1;
        for k in 0..D {
            if self.half[k] > LONG_SIDE * longest || longest == 0.0 {
                for i in count..end {
                    let mut other = parts[i];
                    let half = 0.5 * other.half[k];
                    other.half[k] = half;
                    parts[i].half[k] = half;
                    parts[i].centre[k] -= half;
                    other.centre[k] += half;
                    parts[end + i - count] = other;
                }
                end += end - count;
            }
        }
        end
    }

    /// The box in parts of similar sides, as many as fit into a block; how many there are.
    pub(crate) fn grid(&self, parts: &mut [Self; BLOCK]) -> usize {
        parts[0] = *self;
        let mut count = 1;
        while count << D <= BLOCK {
            let whole = *parts;
            let mut end = 0;
            for cell in &whole[..count] {
                end = cell.halve(parts, end);
            }
            if end == count {
                break;
            }
            count = end;
        }
        count
    }
}

/// The box of which least is known comes first.
impl<const D: usize> Ord for Cell<D> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower)
    }
}

impl<const D: usize> PartialOrd for Cell<D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const D: usize> PartialEq for Cell<D> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const D: usize> Eq for Cell<D> {}

/// A lower bound of the larger of two fields over a box, from their models: the largest
/// least value of their means, which is at the end of a range or where a component of
/// the mean's slope changes its sign.
#[inline]
pub(crate) fn least_of_larger([a, b]: [Model; 2]) -> f64 {
    let mut best = f64::NEG_INFINITY;
    let mut attempt = |share: f64| {
        let rest = 1.0 - share;
        let value = share * a.value + rest * b.value;
        let (mut slope, mut size) = (0.0, (share * a.value).abs() + (rest * b.value).abs());
        for (a, b) in a.gradient.iter().zip(b.gradient) {
            slope += (share * a + rest * b).abs();
            size += (share * a).abs() + (rest * b).abs();
        }
        let remainder = share * a.lower + rest * b.lower;
        let least = value - slope - remainder * (1.0 + ROUNDINGS) - ROUNDINGS * size;
        best = best.max(least);
    };
    attempt(0.0);
    attempt(1.0);
    for (a, b) in a.gradient.iter().zip(b.gradient) {
        let share = b / (b - a);
        if share > 0.0 && share < 1.0 {
            attempt(share);
        }
    }
    best
}
