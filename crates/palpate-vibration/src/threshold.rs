// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The threshold of vibration on the skin, by frequency.
//!
//! The closed form is that of the psychohaptic model in the reference software of ISO/IEC
//! 23090-31, MPEG-I haptics coding (2024).

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

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

#[cfg(test)]
mod tests {
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
