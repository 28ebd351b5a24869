// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Minimax proximal steps: points at which the larger of two fields is less.

use palpate_field::{Point, Vector};

use super::body_pair::BodyPair;
use crate::goal::Goal;

/// Steps of a descent at most.
const STEPS: u32 = 40;

/// A descent ends with a step that gains less than this share of the value.
const SLOW: f64 = 0.1;

/// Factors of the step length: after a step that lowers the value, and after one that does
/// not.
const GROW: f64 = 1.5;
const SHRINK: f64 = 0.25;

/// The negative of a minimax proximal step: `p − minimax_step([a, b], [slope_a, slope_b], step)`
/// is where the larger of two tangent planes at `p`, `a + slope_a·e` and `b + slope_b·e`, plus
/// `|e|²/(2·step)` is least. It is `step` times a mean of both slopes.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_query::minimax_step;
///
/// // Two planes that rise towards each other meet in the middle.
/// let slopes = [Vector([1.0, 0.0]), Vector([-1.0, 0.0])];
/// assert_eq!(minimax_step([1.0, 1.0], slopes, 0.5), Vector([0.0, 0.0]));
/// ```
#[must_use]
#[inline]
pub fn minimax_step<const D: usize>(
    [a, b]: [f64; 2],
    [slope_a, slope_b]: [Vector<f64, D>; 2],
    step: f64,
) -> Vector<f64, D> {
    let between = slope_a - slope_b;
    let squared = between.dot(between);
    let share = if squared > 0.0 {
        (((a - b) / step - slope_b.dot(between)) / squared).clamp(0.0, 1.0)
    } else {
        0.5
    };
    (slope_a * share + slope_b * (1.0 - share)) * step
}

/// A point from `start` on at which the larger of both is less, and its value there;
/// values may be off by `slack`. The first step is `first` [m], or else as long as
/// the value there.
pub(crate) fn descend<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    start: Point<D>,
    first: Option<f64>,
    goal: Goal,
    slack: f64,
) -> (f64, Point<D>) {
    let mut p = start;
    let mut here = pair.slopes(p);
    let mut value = here[0].0.max(here[1].0);
    let mut step = first.unwrap_or(value.abs().max(goal.tolerance));
    let mut small_gains = 0;
    for _ in 0..STEPS {
        let [(a, slope_a), (b, slope_b)] = here;
        let next = p - minimax_step([a, b], [slope_a, slope_b], step);
        let there = pair.slopes(next);
        let next_value = there[0].0.max(there[1].0);
        if next_value < value {
            let gain = value - next_value;
            // Whether bodies that are far apart are so, boxes tell sooner.
            let is_slow = gain < SLOW * (next_value - goal.apart);
            (p, here, value) = (next, there, next_value);
            if is_slow {
                break;
            }
            step *= GROW;
            small_gains = if gain < 0.05 * goal.tolerance { small_gains + 1 } else { 0 };
        } else {
            step *= SHRINK;
        }
        let is_enough = goal.is_hit(value + slack);
        if is_enough || small_gains == 2 || step < 0.05 * goal.tolerance {
            break;
        }
    }
    (value, p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_is_along_the_larger_plane_or_to_where_both_are_equal() {
        let (left, up) = (Vector([-1.0, 0.0]), Vector([0.0, 1.0]));
        assert_eq!(minimax_step([5.0, 1.0], [left, up], 0.5), Vector([-0.5, 0.0]));
        assert_eq!(minimax_step([1.0, 1.0], [left, up], 0.5), Vector([-0.25, 0.25]));
        // Planes that face each other: to the middle, whatever the size.
        for size in [2.0, 50.0] {
            let way = minimax_step([1.0, 2.0], [left, -left], size);
            assert!((way - Vector([0.5, 0.0])).norm() < 1e-13, "{way:?}");
        }
    }
}
