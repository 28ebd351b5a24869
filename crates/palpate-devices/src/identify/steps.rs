// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The encoder step, from readings alone.
//!
//! Readings of an encoder with the step Δ lie in whole steps, so Δ divides their differences:
//! it is their greatest common divisor, by Euclid's algorithm with a tolerance for rounding.

use super::report::EncoderStep;
use super::strokes::Stroke;

/// The part of a step by which a multiple may miss: of rounding, not of other steps.
const MISS: f64 = 0.1;

/// The part of the travel below which a step is not told from rounding: a driver in single
/// precision rounds 0.1 m to 7 nm.
const LEAST: f64 = 1e-5;

/// The steps that the readings of strokes show, with the travel of the strokes.
pub(super) fn steps(strokes: &[Stroke], travel: f64) -> EncoderStep {
    let least = LEAST * travel;
    let differences = || {
        strokes.iter().flat_map(|stroke| {
            stroke.readings.windows(2).filter_map(move |pair| {
                let [before, after] = pair else { return None };
                let difference = (after.place - before.place).abs();
                (difference > least).then_some(difference)
            })
        })
    };
    let smallest = differences().fold(f64::INFINITY, f64::min);
    if smallest == f64::INFINITY {
        return EncoderStep::Unseen(least);
    }
    let divisor = differences().fold(smallest, |divisor, next| common(divisor, next, least));
    if divisor > least {
        // The least squares of all multiples, which averages their rounding.
        let (mut products, mut squares) = (0.0, 0.0);
        for difference in differences() {
            let count = (difference / divisor).round();
            products += count * difference;
            squares += count * count;
        }
        return EncoderStep::Even(products / squares);
    }
    let single = strokes.iter().flat_map(single_steps).fold(0.0, f64::max);
    if single > least { EncoderStep::Uneven(single) } else { EncoderStep::Unseen(least) }
}

/// The greatest common divisor; `least` or less if there is none.
fn common(divisor: f64, next: f64, least: f64) -> f64 {
    let (mut large, mut small) = (next, divisor);
    while small > least {
        let rest = (large - (large / small).round() * small).abs();
        if rest <= MISS * small {
            return small;
        }
        (large, small) = (small, rest);
    }
    small
}

/// The changes of readings between two that stayed: single steps of a slow motion.
fn single_steps(stroke: &Stroke) -> impl Iterator<Item = f64> {
    stroke.readings.windows(4).filter_map(|four| {
        let [a, b, c, d] = four else { return None };
        let is_single = a.place == b.place && b.place != c.place && c.place == d.place;
        is_single.then_some((c.place - b.place).abs())
    })
}
