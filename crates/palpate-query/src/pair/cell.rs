// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes of a search with their bounds.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Point, Vector};

use crate::engine::{Bounded, Rebound};
use crate::larger::larger;

/// A side is halved if it is longer than this share of the longest.
const LONG_SIDE: f64 = 0.63;

/// A side is level if fields change along it by less than this share of the largest change.
const LEVEL: f64 = 0.01;

/// A level side is at most this many times as long as the others.
const THIN: f64 = 8.0;

/// The rounding of a sum of models, relative to the sum of sizes.
pub(crate) const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// A box, and what is known of it, in a cache line of its own.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct BoxCell<const D: usize> {
    /// Proven lower bound in the box [m].
    pub(crate) lower: f64,
    pub(crate) centre: Point<D>,
    /// Half of its sides.
    pub(crate) half: Vector<f64, D>,
    /// Bit k: side k is level.
    pub(crate) level: u8,
}

impl<const D: usize> Bounded for BoxCell<D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.lower
    }
}

impl<const D: usize> Rebound for BoxCell<D> {
    #[inline]
    fn with_lower(&self, lower: f64) -> Self {
        Self { lower, ..*self }
    }
}

impl<const D: usize> BoxCell<D> {
    pub(crate) const NOTHING: Self =
        Self { lower: f64::NEG_INFINITY, centre: Vector::ZERO, half: Vector::ZERO, level: 0 };

    /// A box without a bound.
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

    /// Marks the level sides, from models.
    #[inline]
    pub(crate) fn learn(&mut self, [a, b]: &[Model; 2]) {
        let change = |k: usize| a.gradient[k].abs() + b.gradient[k].abs();
        let most = (0..D).fold(0.0_f64, |most, k| most.max(change(k)));
        self.level = 0;
        for k in 0..D {
            self.level |= u8::from(change(k) < LEVEL * most) << k;
        }
    }

    /// Cuts off the ends of the box where one of the models is everywhere at least `enough`.
    #[inline]
    pub(crate) fn contract(&mut self, models: &[Model; 3], enough: f64) {
        let (mut low, mut high) = ([-1.0_f64; D], [1.0_f64; D]);
        for model in models {
            let gradient = &model.gradient[..D];
            let slope = gradient.iter().fold(0.0, |sum, side| sum + side.abs());
            let size = model.value.abs() + slope;
            let room = enough - model.value
                + model.lower * (1.0 + ROUNDINGS)
                + 2.0 * ROUNDINGS * (size + enough.abs());
            for k in 0..D {
                let side = gradient[k].abs();
                let end = (room + (slope - side)) / side;
                // Written so that NaN leaves all.
                let end = if end < 1.0 { end.max(-1.0) } else { 1.0 };
                if gradient[k] > 0.0 {
                    high[k] = high[k].min(end);
                } else {
                    low[k] = low[k].max(-end);
                }
            }
        }
        for k in 0..D {
            let half = self.half[k];
            self.centre[k] += half * (0.5 * (low[k] + high[k]));
            self.half[k] = half * larger(0.5 * (high[k] - low[k]), 0.0) * (1.0 + ROUNDINGS)
                + 2.0 * f64::EPSILON * self.centre[k].abs();
        }
    }

    /// Whether each side is to be halved: the long ones of those along which the fields
    /// vary, or of all where the box is thin already.
    #[inline]
    fn splits(&self) -> [bool; D] {
        let longest = |level: u8| {
            let sides = (0..D).filter(|k| level & (1 << k) == 0);
            sides.fold(0.0_f64, |longest, k| longest.max(self.half[k]))
        };
        let all = longest(0);
        let varying = longest(self.level);
        let is_thin = THIN * varying < all;
        let (level, longest) = if is_thin { (0, all) } else { (self.level, varying) };
        std::array::from_fn(|k| {
            level & (1 << k) == 0 && (self.half[k] > LONG_SIDE * longest || longest == 0.0)
        })
    }

    /// Appends the parts of the box, halved along its long sides.
    #[inline]
    pub(crate) fn halve(&self, parts: &mut Vec<Self>) {
        let first = parts.len();
        parts.push(*self);
        for (k, is_split) in self.splits().into_iter().enumerate() {
            if is_split {
                for i in first..parts.len() {
                    let mut other = parts[i];
                    let half = 0.5 * other.half[k];
                    other.half[k] = half;
                    parts[i].half[k] = half;
                    parts[i].centre[k] -= half;
                    other.centre[k] += half;
                    parts.push(other);
                }
            }
        }
    }

    /// Fills `cells` with the parts of the box, of similar sides, as many as fit into a
    /// block.
    pub(crate) fn grid(&self, cells: &mut Vec<Self>) {
        cells.clear();
        cells.push(*self);
        let mut first = 0;
        while (cells.len() - first) << D <= BLOCK {
            let end = cells.len();
            for i in first..end {
                let cell = cells[i];
                cell.halve(cells);
            }
            if cells.len() - end == end - first {
                // A point has no parts.
                cells.truncate(end);
                break;
            }
            first = end;
        }
        cells.drain(..first);
    }
}

/// A lower bound of one field over a box, from its model.
#[inline]
pub(crate) fn least<const D: usize>(model: &Model) -> f64 {
    let slope = model.gradient[..D].iter().fold(0.0, |sum, side| sum + side.abs());
    let size = model.value.abs() + slope;
    model.value - slope - model.lower * (1.0 + ROUNDINGS) - ROUNDINGS * size
}

/// A lower bound of the larger of two fields over a box, from their models: the largest
/// least value of their means, which is at the end of a range or where a component of
/// the mean's slope changes its sign. No more than `enough` is looked for. Also returns the
/// share that the first has in that mean.
#[inline]
pub(crate) fn least_of_larger<const D: usize>(a: &Model, b: &Model, enough: f64) -> (f64, f64) {
    let mut best = (least::<D>(a), 1.0);
    let of_b = least::<D>(b);
    if of_b > best.0 {
        best = (of_b, 0.0);
    }
    for k in 0..D {
        if best.0 >= enough {
            break;
        }
        let (of_a, of_b) = (a.gradient[k], b.gradient[k]);
        // Of like signs the mean's has the same.
        if of_a * of_b < 0.0 {
            let share = of_b / (of_b - of_a);
            let lower = least::<D>(&mean(a, b, share));
            if lower > best.0 {
                best = (lower, share);
            }
        }
    }
    best
}

/// `share` of a and the rest of b, with the roundings of their sum among its remainders.
#[inline]
pub(crate) fn mean(a: &Model, b: &Model, share: f64) -> Model {
    let (rest, mut size) = (1.0 - share, 0.0);
    let mut sum = |a: f64, b: f64| {
        let (a, b) = (share * a, rest * b);
        size += a.abs() + b.abs();
        a + b
    };
    let value = sum(a.value, b.value);
    let gradient = std::array::from_fn(|k| sum(a.gradient[k], b.gradient[k]));
    let rounding = ROUNDINGS * size;
    Model {
        value,
        gradient,
        lower: share * a.lower + rest * b.lower + rounding,
        upper: share * a.upper + rest * b.upper + rounding,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of a fixed sequence in [−1, 1], evenly spread.
    fn spread(i: u32) -> f64 {
        2.0 * (f64::from(i) * 0.618_033_988_749_894_9).fract() - 1.0
    }

    #[test]
    fn a_contracted_box_leaves_out_only_what_a_model_rules_out() {
        for case in 0..400 {
            let number = |i: u32| spread(31 * case + i);
            let model = |first: u32| Model {
                value: 0.4 * number(first),
                gradient: [number(first + 1), number(first + 2), number(first + 3)],
                lower: 0.1 * number(first + 4).abs(),
                upper: 0.0,
            };
            let (a, b) = (model(0), model(5));
            let models = [a, b, mean(&a, &b, number(10).abs())];
            let enough = 0.3 * number(11);
            let whole = BoxCell::<3> {
                centre: Vector([number(12), number(13), number(14)]),
                half: Vector([0.5, 0.2, 0.1]),
                ..BoxCell::NOTHING
            };
            let mut part = whole;
            part.contract(&models, enough);
            for sample in 0..100 {
                let u: [f64; 3] = std::array::from_fn(|k| spread(97 * sample + k as u32));
                let least_at = |m: &Model| {
                    m.value - m.lower + (0..3).map(|k| m.gradient[k] * u[k]).sum::<f64>()
                };
                let is_left = (0..3).all(|k| {
                    let p = whole.centre[k] + whole.half[k] * u[k];
                    (p - part.centre[k]).abs() <= part.half[k]
                });
                assert!(is_left || models.iter().any(|m| least_at(m) >= enough));
            }
        }
    }

    #[test]
    fn a_contracted_box_ends_where_a_model_alone_is_enough() {
        // Less than 0.5 where 0.2 + u₀ − 0.1 < 0.5, and where −2u₁ < 0.5.
        let rising = Model { value: 0.2, gradient: [1.0, 0.0, 0.0], lower: 0.1, upper: 0.0 };
        let falling = Model { value: 0.0, gradient: [0.0, -2.0, 0.0], lower: 0.0, upper: 0.0 };
        let half = Vector([4.0, 4.0]);
        let mut part = BoxCell::<2> { half, ..BoxCell::NOTHING };
        part.contract(&[rising, falling, rising], 0.5);
        let ends = [part.centre - part.half, part.centre + part.half];
        let expected = [Vector([-4.0, -1.0]), Vector([1.6, 4.0])];
        for (end, expected) in ends.into_iter().zip(expected) {
            assert!((end - expected).norm() < 1e-13, "{end:?}, not {expected:?}");
        }
    }
}
