// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far the part of a box beyond a plane is.

use palpate_field::Vector;

use crate::pair::cell::ROUNDINGS;

/// A lower bound of the distance from the origin to the part of a box with these corners
/// in which `n·y ≤ −d`, with `n` of length one and `d` positive.
///
/// For each λ ≥ 0 the least value of `|y|² + 2λ(n·y + d)` over the box bounds its square.
/// The largest is where `n·y = −d`, and Newton's method finds it, from the λ of a box that
/// does not matter.
pub(crate) fn distance_to_cut_box<const D: usize>(
    [low, high]: [Vector<f64, D>; 2],
    n: Vector<f64, D>,
    d: f64,
) -> f64 {
    /// Each makes one more coordinate free or fixed.
    const STEPS: usize = 8;
    let (mut multiplier, mut best) = (d, 0.0_f64);
    for _ in 0..STEPS {
        let (mut squared, mut along, mut size, mut free) = (0.0, d, d, 0.0);
        for k in 0..D {
            let wanted = -multiplier * n[k];
            let y = wanted.max(low[k]).min(high[k]);
            squared += y * y;
            along += n[k] * y;
            size += (n[k] * y).abs();
            free += if y == wanted { n[k] * n[k] } else { 0.0 };
        }
        let rounding = ROUNDINGS * (squared + 2.0 * multiplier * size);
        best = best.max(squared + 2.0 * multiplier * along - rounding);
        // Where no coordinate is free: all of the box is beyond the plane, or a longer way
        // makes one free, or nothing of it is.
        let next = if free > 0.0 {
            (multiplier + along / free).max(0.0)
        } else if along < 0.0 {
            0.0
        } else {
            2.0 * multiplier
        };
        if next == multiplier {
            break;
        }
        multiplier = next;
    }
    best.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_box_is_as_far_as_its_part() {
        let n = Vector([-0.6, -0.8]);
        let distance = |low: [f64; 2], high: [f64; 2], d: f64| {
            distance_to_cut_box([Vector(low), Vector(high)], n, d)
        };
        let is = |found: f64, truth: f64| truth - 1e-12 < found && found <= truth;
        // The line alone, from which (0.6, 0.8)·d is nearest.
        assert!(is(distance([-9.0, -9.0], [9.0, 9.0], 0.5), 0.5));
        // A side that cuts off that point: (2, y) with 1.2 + 0.8·y = 2.
        assert!(is(distance([2.0, -9.0], [5.0, 9.0], 2.0), 5.0_f64.sqrt()));
        // A corner alone.
        assert!(is(distance([-1.0, -1.0], [2.0, 1.0], 2.0), 5.0_f64.sqrt()));
        // The box is farther than the line.
        assert!(is(distance([3.0, 4.0], [5.0, 9.0], 2.0), 5.0));
        // No part of the box is beyond the line: farther than any.
        assert!(distance([-1.0, -1.0], [1.0, 1.0], 2.0) > 10.0);
    }
}
