// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Levels above the threshold of the skin.
//!
//! The threshold of vibration on the skin, by frequency.
//!
//! The closed form is that of the psychohaptic model in the reference software of ISO/IEC
//! 23090-31, MPEG-I haptics coding (2024).
//!
//! Holds that last fade.
//!
//! The skin adapts to a lasting vibration: its threshold rises with a time constant of seconds
//! (Hollins, Goble, Whitsel and Tommerdahl, "Time course and action spectrum of vibrotactile
//! adaptation", 1990), so that a motor which goes on shaking wears, warms and is felt less and
//! less. A hold therefore fades by itself; time, fraction and revival are choices, not
//! measurements.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use palpate_device::NumberError;

use crate::actuator::check_sample_rate;
use crate::cue::{MappingOptions, Tone};

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

/// Where the skin is most sensitive [Hz].
pub(crate) const BEST_FREQUENCY: f64 = 250.0;
/// The threshold there [dB].
const BEST_THRESHOLD: f64 = -45.0;
/// The rise of the threshold from 250 Hz to 0 Hz [dB].
const RISE: f64 = 50.0;
/// The scale of the curve in frequency [Hz].
const BEND: f64 = 550.0;

/// The threshold of vibration at `frequency` [Hz], relative to full amplitude [dB].
///
/// ```text
/// T(f) = min(0, a (log₁₀(c f + b) / log₁₀ b)² − e)
/// ```
///
/// with a = 50 dB, c = 1/550 Hz, b = 1 − 250 Hz · c and e = 45 dB. The threshold is lowest at
/// 250 Hz. A threshold of 0 dB means that nothing is felt; NaN and frequencies outside the
/// formula's domain give 0 dB.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
///
/// ```
/// use palpate_vibration::threshold_db;
///
/// assert_eq!(threshold_db(250.0), -45.0);
/// assert!((threshold_db(100.0) - -31.2).abs() < 0.05);
/// assert_eq!(threshold_db(700.0), 0.0);
/// ```
#[must_use]
pub fn threshold_db(frequency: f64) -> f64 {
    let start = 1.0 - BEST_FREQUENCY / BEND;
    let ratio = libm::log10(frequency / BEND + start) / libm::log10(start);
    // `min` ignores NaN: below its domain the curve is not felt.
    (RISE * ratio * ratio + BEST_THRESHOLD).min(0.0)
}

/// The smallest amplitude at `frequency` [Hz] that is felt, as a part of full amplitude:
/// `10^(T(f)/20)`, in [0.0056, 1].
///
/// Amplitudes in the ratio of their weights are equally far above the threshold: scaling each
/// tone by its weight makes tones of one level feel equally strong.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
///
/// ```
/// use palpate_vibration::perceptual_weight;
///
/// // 60 Hz has to be 17 times as strong as 250 Hz.
/// let ratio = perceptual_weight(60.0) / perceptual_weight(250.0);
/// assert!((ratio - 16.7).abs() < 0.05);
/// ```
#[must_use]
pub fn perceptual_weight(frequency: f64) -> f64 {
    libm::exp10(threshold_db(frequency) / 20.0)
}

/// Fades the tone of a pressure that does not change.
///
/// While the level stays where it is, the fade f falls from 1 to a fraction φ: `f = φ + (1 − φ)
/// exp(−t / τ)`. A change of the level by the revival since it was last revived, in either
/// direction, brings it back to 1, and so does a new touch.
///
/// ```
/// use palpate_vibration::{Adaptation, MappingOptions, Tone};
///
/// let options = MappingOptions {
///     hold_fraction: 0.25,
///     hold_time: 2.0,
///     ..MappingOptions::default()
/// };
/// let mut adaptation = Adaptation::new(&options);
/// let hold = Tone { frequency: 60.0, amplitude: 0.5 };
/// adaptation.step(hold, 0.0);
/// let after = adaptation.step(hold, 2.0);
/// assert!((after.fade - (0.25 + 0.75 * (-1.0_f64).exp())).abs() < 1e-15);
/// assert_eq!(after.tone.amplitude, 0.5 * after.fade);
/// // The finger presses harder.
/// assert_eq!(adaptation.step(Tone { amplitude: 0.7, ..hold }, 0.001).fade, 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Adaptation {
    fraction: f64,
    time: f64,
    revival: f64,
    fade: f64,
    /// The level at which the hold was last revived; zero without a touch.
    revived_at: f64,
}

/// A hold that has faded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faded {
    /// The hold, weaker by the fade.
    pub tone: Tone,
    /// What is left of it, in (0, 1].
    pub fade: f64,
}

impl Adaptation {
    /// An adaptation with `hold_fraction`, `hold_time` and `hold_revival` of these options, without
    /// a touch.
    #[must_use]
    pub const fn new(options: &MappingOptions) -> Self {
        let MappingOptions { hold_fraction, hold_time, hold_revival, .. } = *options;
        Self {
            fraction: hold_fraction,
            time: hold_time,
            revival: hold_revival,
            fade: 1.0,
            revived_at: 0.0,
        }
    }

    /// The hold after another `period` [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, hold: Tone, period: f64) -> Faded {
        let change = (hold.amplitude - self.revived_at).abs();
        if self.revived_at == 0.0 || change >= self.revival {
            self.revived_at = hold.amplitude;
            self.fade = 1.0;
        } else if hold.amplitude > 0.0 {
            let left = libm::exp(-period / self.time);
            self.fade = self.fraction + (self.fade - self.fraction) * left;
        } else {
            self.revived_at = 0.0;
        }
        let tone = Tone { amplitude: hold.amplitude * self.fade, ..hold };
        Faded { tone, fade: self.fade }
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
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

#[cfg(test)]
mod threshold_tests {
    use super::*;

    #[test]
    fn the_curve_has_its_known_values() {
        let known = [
            (40.0, -13.5),
            (60.0, -20.6),
            (80.0, -26.4),
            (100.0, -31.2),
            (150.0, -39.5),
            (200.0, -43.8),
            (250.0, -45.0),
            (300.0, -44.0),
            (400.0, -37.1),
            (500.0, -25.9),
            (600.0, -12.0),
            (700.0, 0.0),
        ];
        for (frequency, expected) in known {
            // The expected values are given to a tenth.
            assert!((threshold_db(frequency) - expected).abs() <= 0.051, "{frequency} Hz");
        }
    }

    #[test]
    fn it_falls_to_its_best_and_rises_again() {
        for hertz in 0..700 {
            let (here, next) = (f64::from(hertz), f64::from(hertz + 1));
            let falls = threshold_db(next) <= threshold_db(here);
            assert!(if next <= BEST_FREQUENCY { falls } else { !falls || here > 650.0 });
        }
    }

    #[test]
    fn what_is_no_frequency_is_not_felt() {
        for frequency in [f64::NAN, f64::INFINITY, -1e6, -300.0, 0.0] {
            assert_eq!(threshold_db(frequency), 0.0);
            assert_eq!(perceptual_weight(frequency), 1.0);
        }
    }

    #[test]
    fn a_weight_is_its_threshold_as_a_ratio() {
        assert!((perceptual_weight(250.0) - 10_f64.powf(-2.25)).abs() < 1e-15);
        assert!((20.0 * perceptual_weight(60.0).log10() - threshold_db(60.0)).abs() < 1e-12);
    }
}

#[cfg(test)]
mod adaptation_tests {
    use super::*;

    fn hold(amplitude: f64) -> Tone {
        Tone { frequency: 60.0, amplitude }
    }

    #[test]
    fn a_minute_of_rest_leaves_the_fraction() {
        let mut adaptation = Adaptation::new(&MappingOptions::default());
        let last = (0..60_000).map(|_| adaptation.step(hold(0.8), 1e-3)).last().unwrap();
        assert!((last.fade - 0.1).abs() < 1e-9);
        assert!((last.tone.amplitude - 0.08).abs() < 1e-9);
    }

    #[test]
    fn a_tremor_does_not_revive_and_a_new_touch_does() {
        let mut adaptation = Adaptation::new(&MappingOptions::default());
        for tick in 0..5000 {
            adaptation.step(hold(0.5 + 0.04 * f64::from(tick % 2)), 1e-3);
        }
        assert!(adaptation.step(hold(0.5), 1e-3).fade < 0.2);
        assert_eq!(adaptation.step(hold(0.0), 1e-3).tone.amplitude, 0.0);
        assert_eq!(adaptation.step(hold(0.1), 1e-3).fade, 1.0);
    }

    #[test]
    fn the_fade_does_not_depend_on_the_period() {
        let [slow, fast] = [(10, 0.1), (1000, 0.001)].map(|(steps, period)| {
            let mut adaptation = Adaptation::new(&MappingOptions::default());
            adaptation.step(hold(0.3), period);
            (0..steps).map(|_| adaptation.step(hold(0.3), period).fade).last().unwrap()
        });
        assert!((slow - fast).abs() < 1e-12);
    }
}
