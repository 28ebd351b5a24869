// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far a vibration is above the threshold of the skin.

use std::f64::consts::TAU;

use crate::actuator::check_sample_rate;
use crate::threshold::threshold_db;
use palpate_device::NumberError;

/// The time over which the skin sums up a vibration here [s]. The threshold falls with the duration
/// of a vibration up to some tenths of a second (Verrillo, "Temporal summation in vibrotactile
/// sensitivity", 1965); a shorter time would count a tap for more than it is.
const WINDOW: f64 = 0.05;

/// The distance between the frequencies that are looked at [Hz]: a quarter of the width 1/WINDOW of
/// a line.
const STEP: f64 = 5.0;

/// Frequencies from this one [Hz] to 700 Hz, above which the threshold is that of full amplitude.
const LOWEST: f64 = 20.0;
const COUNT: usize = 137;

/// The sensation level of a vibration: how far its strongest line is above the threshold of the
/// skin, at its best moment [dB]. `None` for silence; negative for what is not felt.
///
/// The samples, in which 1 is the largest amplitude of the actuator, are cut into pieces of 50 ms
/// that overlap by half, with Hann's window; the level is the largest `20 log₁₀ A(f) − T(f)` over
/// the pieces and over frequencies from 20 to 700 Hz, with the amplitude A of the piece's line and
/// the [`threshold_db`] T.
///
/// # Errors
///
/// [`NumberError`] if the sample rate [Hz] is less than 1400 Hz.
///
/// ```
/// use palpate_vibration::{sensation_level, threshold_db};
///
/// # fn main() -> Result<(), palpate_device::NumberError> {
/// let turn = |i: u32| std::f64::consts::TAU * 250.0 * f64::from(i) / 8000.0;
/// let sine: Vec<f64> = (0..800).map(|i| 0.5 * turn(i).sin()).collect();
/// // Half the amplitude is 6.02 dB less.
/// let level = sensation_level(&sine, 8000.0)?.unwrap_or_default();
/// assert!((level - (45.0 - 6.02)).abs() < 0.01);
/// assert_eq!(sensation_level(&[0.0; 800], 8000.0)?, None);
/// # Ok(())
/// # }
/// ```
pub fn sensation_level(samples: &[f64], sample_rate: f64) -> Result<Option<f64>, NumberError> {
    let frequencies: [f64; COUNT] = std::array::from_fn(|i| LOWEST + STEP * i as f64);
    let [.., highest] = frequencies;
    check_sample_rate(sample_rate, highest)?;
    let length = (WINDOW * sample_rate).round() as usize;
    let window = |i: usize| 0.5 - 0.5 * libm::cos(TAU * i as f64 / length as f64);
    let window: Vec<f64> = (0..length).map(window).collect();
    // The amplitude of a sine is twice its line, and a window weighs half of its length.
    let scale = 2.0 / window.iter().sum::<f64>();
    let mut level = f64::NEG_INFINITY;
    let mut piece = vec![0.0; length];
    // The first piece begins half a window early, so that a beginning is weighed in full.
    let half = length / 2;
    for start in (0..samples.len() + half).step_by(half.max(1)) {
        for (i, (place, weight)) in piece.iter_mut().zip(&window).enumerate() {
            let sample = (start + i).checked_sub(half).and_then(|i| samples.get(i));
            *place = weight * sample.copied().unwrap_or_default();
        }
        if piece.iter().all(|sample| *sample == 0.0) {
            continue;
        }
        for frequency in frequencies {
            let amplitude = scale * line(&piece, frequency / sample_rate);
            level = level.max(20.0 * libm::log10(amplitude) - threshold_db(frequency));
        }
    }
    Ok(Some(level).filter(|level| *level > f64::NEG_INFINITY))
}

/// The magnitude of the Fourier sum of `samples` at `frequency` [1/sample]: Goertzel, "An algorithm
/// for the evaluation of finite trigonometric series" (1958).
fn line(samples: &[f64], frequency: f64) -> f64 {
    let twice = 2.0 * libm::cos(TAU * frequency);
    let [last, before] =
        samples.iter().fold([0.0, 0.0], |[last, before], x| [x + twice * last - before, last]);
    (last * last + before * before - twice * last * before).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 8000.0;

    fn sine(frequency: f64, amplitude: f64) -> Vec<f64> {
        let turn = |i: u32| TAU * frequency * f64::from(i) / RATE;
        (0..4000).map(|i| amplitude * turn(i).sin()).collect()
    }

    fn level(samples: &[f64]) -> f64 {
        sensation_level(samples, RATE).unwrap().unwrap()
    }

    #[test]
    fn a_line_is_its_fourier_sum() {
        let samples: Vec<f64> = (0..200).map(|i| f64::from(i * i % 17) - 8.0).collect();
        for frequency in [0.01, 0.13, 0.37] {
            let sum = samples.iter().enumerate().fold([0.0, 0.0], |[re, im], (i, x)| {
                let (sin, cos) = (TAU * frequency * i as f64).sin_cos();
                [re + x * cos, im + x * sin]
            });
            let expected = f64::hypot(sum[0], sum[1]);
            assert!((line(&samples, frequency) - expected).abs() < 1e-9 * expected);
        }
    }

    #[test]
    fn a_sine_at_its_threshold_has_level_zero() {
        for frequency in [60.0, 100.0, 250.0, 400.0] {
            let quiet = sine(frequency, libm::exp10(threshold_db(frequency) / 20.0));
            // A window's line is wide: 10 Hz beside it, it is 1.4 dB lower, and the threshold is
            // up to 3.1 dB lower.
            assert!((-0.01..1.7).contains(&level(&quiet)), "{frequency}: {}", level(&quiet));
        }
    }

    #[test]
    fn a_short_tone_is_felt_less_than_a_long_one() {
        let long = sine(250.0, 0.5);
        let mut short = long.clone();
        short[80..].fill(0.0);
        assert!(level(&short) < level(&long) - 6.0);
        assert!(level(&short) > 20.0);
    }
}
