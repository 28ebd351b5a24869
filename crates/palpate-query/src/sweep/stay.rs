// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How long parts of what moves are free.

use palpate_field::Vector;
use palpate_field::scalar::SpaceTimeModel;

use crate::pair::cell::ROUNDINGS;

/// A part goes on undivided if its step is at least this share of its centre's alone.
const PAYS: f64 = 0.3;

/// Of the way that is left to a ball's edge, the share that bends of the way may take.
const BEND: f64 = 0.25;

/// Means of two models whose steps follow each other, at most.
const MEANS: usize = 4;

/// How long a part is free, and how long its centre alone is: smaller parts may gain the difference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stay {
    pub(super) part: f64,
    pub(super) centre: f64,
}

impl Stay {
    /// Whether smaller parts would gain little.
    #[inline]
    pub(super) fn pays(&self) -> bool {
        self.part > 0.0 && self.part >= PAYS * self.centre
    }

    /// The longer of both.
    #[inline]
    pub(super) fn or(&mut self, other: Self) {
        *self = Self { part: self.part.max(other.part), centre: self.centre.max(other.centre) };
    }

    /// Of all points within `radius` of one that moves at a `speed` from the middle of a ball that is
    /// proven `empty` [m].
    #[inline]
    pub(super) fn in_ball(empty: f64, radius: f64, speed: f64, acceleration: f64) -> Self {
        let spare = empty - radius;
        let (bend, most) = bend(spare, acceleration);
        // NaN is no time.
        match () {
            () if spare > 0.0 => Self {
                part: ((spare - bend) / speed).min(most) * (1.0 - 1e-12),
                centre: (empty / speed).min(most),
            },
            () if empty > 0.0 => Self { part: 0.0, centre: empty / speed },
            () => Self::default(),
        }
    }

    /// Of a box and a span of time, over which two fields have these models: until the best of
    /// their means falls to `level` [m].
    pub(super) fn of_models(
        a: &SpaceTimeModel,
        b: &SpaceTimeModel,
        level: f64,
        span: f64,
    ) -> Self {
        let mut candidates = [1.0, 0.0, -1.0, -1.0, -1.0];
        for k in 0..3 {
            // A component of the mean's slope changes its sign there.
            let (of_a, of_b) = (a.gradient[k], b.gradient[k]);
            if of_a * of_b < 0.0 {
                candidates[2 + k] = of_b / (of_b - of_a);
            }
        }
        let lines = candidates.map(|share| (share >= 0.0).then(|| Line::of(a, b, share)));
        let mut stay = Self::default();
        // From −1 on; where one mean ends, another may go on.
        let mut until = -1.0_f64;
        for _ in 0..MEANS {
            let mut end = until;
            for line in lines.iter().flatten() {
                if line.at(until) > level {
                    end = end.max(line.falls_to(level));
                }
            }
            if end <= until {
                break;
            }
            until = end;
        }
        let share = |until: f64| (0.5 * (until + 1.0)).clamp(0.0, 1.0);
        let rounding = if until < 1.0 { 1e-12 } else { 0.0 };
        stay.part = share(until) * span * (1.0 - rounding);
        for line in lines.iter().flatten() {
            let middle = Line { value: line.middle, ..*line };
            if middle.at(-1.0) > level {
                stay.centre = stay.centre.max(share(middle.falls_to(level)) * span);
            }
        }
        stay
    }
}

/// A lower bound over a box that is affine in time, from −1 to 1.
#[derive(Clone, Copy)]
struct Line {
    /// At the time 0.
    value: f64,
    slope: f64,
    /// The value in the middle of the box, without remainders.
    middle: f64,
}

impl Line {
    /// Of `share` of a and the rest of b.
    #[inline]
    fn of(a: &SpaceTimeModel, b: &SpaceTimeModel, share: f64) -> Self {
        let rest = 1.0 - share;
        let mean = |a: f64, b: f64| share * a + rest * b;
        let (mut least, mut size) = (0.0, share * a.value.abs() + rest * b.value.abs());
        for k in 0..3 {
            least += mean(a.gradient[k], b.gradient[k]).abs();
            size += share * a.gradient[k].abs() + rest * b.gradient[k].abs();
        }
        let (middle, slope) = (mean(a.value, b.value), mean(a.gradient[3], b.gradient[3]));
        size += slope.abs();
        let lower = mean(a.lower, b.lower) * (1.0 + ROUNDINGS) + 2.0 * ROUNDINGS * size;
        Self { value: middle - least - lower, slope, middle }
    }

    #[inline]
    fn at(&self, time: f64) -> f64 {
        self.value + self.slope * time
    }

    /// When it falls to a level, at most 1, from a time on at which it is higher.
    #[inline]
    fn falls_to(&self, level: f64) -> f64 {
        if self.at(1.0) > level { 1.0 } else { ((level - self.value) / self.slope).min(1.0) }
    }
}

/// What a bend takes of the way that is `spare`, and for how long a way of this acceleration bends
/// no farther.
#[inline]
pub(super) fn bend(spare: f64, acceleration: f64) -> (f64, f64) {
    if acceleration > 0.0 {
        let bend = BEND * spare;
        (bend, (2.0 * bend / acceleration).sqrt())
    } else {
        (0.0, f64::INFINITY)
    }
}

/// When a point leaves a ball of a `radius`, `apart` from its centre at first; zero if it is not in
/// it.
#[inline]
pub(super) fn exit<const D: usize>(
    apart: Vector<f64, D>,
    velocity: Vector<f64, D>,
    radius: f64,
) -> f64 {
    // |o + s v| < radius from s = 0 on.
    let (half, squared) = (apart.dot(velocity), velocity.dot(velocity));
    let rest = radius * radius - apart.dot(apart);
    let is_in_it = radius > 0.0 && rest > 0.0;
    let root = (half * half + squared * rest).sqrt();
    // Of both forms of the root the one that does not cancel. A point at rest never leaves. NaN is no
    // time.
    match () {
        () if is_in_it && squared == 0.0 => f64::INFINITY,
        () if is_in_it && half > 0.0 => rest / (root + half),
        () if is_in_it => (root - half) / squared,
        () => 0.0,
    }
}

/// A time after a step, rounded down to one that other parts are likely to have: their places are
/// computed once.
#[inline]
pub(super) fn later(time: f64, step: f64) -> f64 {
    /// Of the step, so much is given up at most.
    const COARSE: f64 = 8.0;
    let coarse = step / COARSE;
    // The power of two below.
    let grid = f64::from_bits(coarse.to_bits() & (0x7ff << 52));
    let rounded = ((time + step) / grid).floor() * grid;
    // What is free to the end needs no place any more.
    if rounded > time && time + step < 1.0 { rounded } else { time + step }
}
