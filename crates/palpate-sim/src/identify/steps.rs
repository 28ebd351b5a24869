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

#[cfg(test)]
mod tests {
    use super::super::port::Reading;
    use super::*;

    fn stroke(places: impl IntoIterator<Item = f64>) -> Stroke {
        let reading = |(i, place)| Reading { time: f64::from(i), place, held: 0.0 };
        Stroke { readings: (0..).zip(places).map(reading).collect() }
    }

    #[test]
    fn the_step_divides_all_differences() {
        // Steps of 6, 10 and 15 times 7 µm, without a single one.
        let places = [0.0, 6.0, 16.0, 31.0, 31.0, 25.0].map(|n| n * 7e-6);
        let EncoderStep::Even(step) = steps(&[stroke(places)], 0.005) else { panic!("even") };
        assert!((step / 7e-6 - 1.0).abs() < 1e-12, "{step}");
    }

    #[test]
    fn rounding_to_single_precision_hides_no_step() {
        let places = (0..200_i32).map(|i| {
            let place = 0.1 + 1e-5 * f64::from(i * i % 37);
            f64::from(place as f32)
        });
        let EncoderStep::Even(step) = steps(&[stroke(places)], 0.005) else { panic!("even") };
        assert!((step / 1e-5 - 1.0).abs() < 1e-4, "{step}");
    }

    #[test]
    fn readings_without_steps_show_none() {
        let places = (0..200).map(|i| 1e-3 * f64::from(i).sin());
        assert_eq!(steps(&[stroke(places)], 0.005), EncoderStep::Unseen(1e-5 * 0.005));
        assert_eq!(steps(&[stroke([0.0; 3])], 0.005), EncoderStep::Unseen(1e-5 * 0.005));
    }
}
