// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Strengths: tones as amplitudes in units of the skin's threshold at their frequency.
//!
//! A tone that moves to another frequency keeps its strength, so that it is felt as far above the
//! threshold as before.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use crate::cue::{MappingOptions, Sensation, Tap, Tone, level};
use crate::ringing::Ringing;
use crate::sensation_level::{Adaptation, BEST_FREQUENCY, perceptual_weight};

/// The least strength with which a touch begins on an actuator, and a slide goes on: 10 dB above
/// the threshold, which everybody feels who feels the actuator at all.
pub(crate) const CLEARLY_FELT: f64 = 3.162_277_660_168_379_5;

/// The least strength of a tap: 20 dB above the threshold, since a tap ends before the skin has
/// summed it up.
const TAP_FELT: f64 = 10.0;

/// The level of a slide from which on it is clearly felt; a weaker one begins softly.
const SLIDE_FELT: f64 = 0.1;

/// The frequency below which the threshold counts as that at this frequency [Hz]: the curve is that
/// of the channel that feels best at 250 Hz, and slower crests are felt by another.
const LOWEST_FELT: f64 = 40.0;

/// The skin and a resonant actuator follow a rhythm of its carrier in full up to the first of these
/// frequencies [Hz], and not at all from the second on.
const RHYTHM: [f64; 2] = [50.0, 80.0];

/// The strength of a tone.
pub(crate) fn strength(tone: Tone) -> f64 {
    tone.amplitude / perceptual_weight(tone.frequency.max(LOWEST_FELT))
}

/// The strength of a hold that has faded to this part; zero for silence.
pub(crate) fn hold_strength(hold: Tone, fade: f64) -> f64 {
    if hold.amplitude > 0.0 { strength(hold).max(CLEARLY_FELT) * fade } else { 0.0 }
}

/// The strength of a slide.
pub(crate) fn slide_strength(slide: Tone) -> f64 {
    strength(slide).max(CLEARLY_FELT * level(slide.amplitude / SLIDE_FELT))
}

/// The strength of a tap when it begins.
pub(crate) fn tap_strength(tap: &Tap) -> f64 {
    let Tap { amplitude, frequency, .. } = *tap;
    strength(Tone { amplitude, frequency }).max(TAP_FELT)
}

/// The amplitude at `frequency` [Hz] that is felt with `strength`, at most 1.
pub(crate) fn amplitude(strength: f64, frequency: f64) -> f64 {
    level(strength * perceptual_weight(frequency))
}

/// How deep a rhythm of `frequency` [Hz] goes, in [0, 1].
fn rhythm(frequency: f64) -> f64 {
    let [whole, none] = RHYTHM;
    level((none - frequency) / (none - whole))
}

/// The strength of one touch from sample to sample, for actuators that have one frequency.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strengths {
    adaptation: Adaptation,
    ringing: Ringing,
    /// Whether the crests of a slow slide are a rhythm.
    has_rhythm: bool,
    /// The least threshold: strengths times this are at most 1.
    least_weight: f64,
    /// The samples for which the tap stays as it is, so that a slow actuator reaches it.
    waits: f64,
    hold: f64,
    slide: Tone,
    /// The phase of the slide's crests in turns, in [0, 1).
    crest: f64,
    period: f64,
}

impl Strengths {
    /// Of a touch whose sensations come from a mapping with these options, for an actuator that
    /// can follow a rhythm or not.
    pub(crate) fn new(options: &MappingOptions, sample_rate: f64, has_rhythm: bool) -> Self {
        Self {
            adaptation: Adaptation::new(options),
            ringing: Ringing::new(sample_rate),
            has_rhythm,
            least_weight: perceptual_weight(BEST_FREQUENCY),
            waits: 0.0,
            hold: 0.0,
            slide: Tone::default(),
            crest: 0.0,
            period: 1.0 / sample_rate,
        }
    }

    /// A tick of `samples` begins. `reach` is the time [s] that the actuator needs for a strength.
    pub(crate) fn begin(
        &mut self,
        sensation: &Sensation,
        samples: usize,
        reach: impl Fn(f64) -> f64,
    ) {
        let faded = self.adaptation.step(sensation.hold, samples as f64 * self.period);
        self.hold = hold_strength(sensation.hold, faded.fade);
        self.slide = Tone { amplitude: slide_strength(sensation.slide), ..sensation.slide };
        if let Some(tap) = sensation.tap {
            let strength = tap_strength(&tap);
            let amplitude = level(strength * self.least_weight);
            if amplitude > self.ringing.now().amplitude {
                self.ringing.strike(Tap { amplitude, ..tap });
                self.waits = reach(strength) / self.period;
            }
        }
    }

    /// The square of the strength of the next sample.
    pub(crate) fn next_squared(&mut self) -> f64 {
        let tap = if self.waits > 0.0 {
            self.waits -= 1.0;
            self.ringing.now()
        } else {
            self.ringing.next()
        };
        let depth = if self.has_rhythm { rhythm(self.slide.frequency) } else { 0.0 };
        // From a trough, so that a slide begins softly.
        let wave = 0.5 + 0.5 * libm::cos(TAU * self.crest);
        let slide = self.slide.amplitude * (1.0 - depth * wave);
        self.crest += self.slide.frequency * self.period;
        self.crest -= libm::floor(self.crest);
        let tap = tap.amplitude / self.least_weight;
        self.hold * self.hold + slide * slide + tap * tap
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use crate::threshold_db;

    fn above(amplitude: f64, frequency: f64) -> f64 {
        20.0 * amplitude.log10() - threshold_db(frequency)
    }

    #[test]
    fn a_tone_that_moves_is_as_far_above_the_threshold() {
        let tone = Tone { frequency: 60.0, amplitude: 0.5 };
        let moved = amplitude(strength(tone), 170.0);
        assert!((above(moved, 170.0) - above(0.5, 60.0)).abs() < 1e-12);
        assert!(moved < 0.05);
        assert_eq!(amplitude(1e9, 170.0), 1.0);
    }

    #[test]
    fn the_weakest_are_10_and_20_db_above_the_threshold() {
        let weak = Tone { frequency: 250.0, amplitude: 1e-6 };
        let hold = amplitude(hold_strength(weak, 1.0), 250.0);
        assert!((above(hold, 250.0) - 10.0).abs() < 1e-12);
        let tap = Tap { amplitude: 1e-6, frequency: 250.0, decay: 50.0 };
        assert!((above(amplitude(tap_strength(&tap), 250.0), 250.0) - 20.0).abs() < 1e-12);
        assert_eq!(hold_strength(Tone { amplitude: 0.0, ..weak }, 1.0), 0.0);
        assert_eq!(slide_strength(Tone { amplitude: 0.0, ..weak }), 0.0);
        // At 40 Hz a tenth of the largest is below the threshold.
        let slide = Tone { frequency: 40.0, amplitude: 0.1 };
        assert!(strength(slide) < 1.0);
        assert_eq!(slide_strength(slide), CLEARLY_FELT);
    }

    #[test]
    fn slow_crests_are_a_rhythm_and_fast_ones_are_not() {
        assert_eq!([20.0, 50.0, 65.0, 80.0, 300.0].map(rhythm), [1.0, 1.0, 0.5, 0.0, 0.0]);
        let mut touch = Strengths::new(&MappingOptions::default(), 1000.0, true);
        let slide = Tone { frequency: 20.0, amplitude: 0.5 };
        touch.begin(&Sensation { slide, ..Sensation::default() }, 1, |_| 0.0);
        let samples: Vec<f64> = (0..1000).map(|_| touch.next_squared().sqrt()).collect();
        let most = slide_strength(slide);
        let crests = samples.iter().filter(|sample| **sample > most * (1.0 - 1e-9)).count();
        let troughs = samples.iter().filter(|sample| **sample < most * 1e-9).count();
        assert_eq!((crests, troughs), (20, 20));
    }

    #[test]
    fn a_tap_waits_for_its_actuator() {
        let tap = Tap { amplitude: 0.5, frequency: 250.0, decay: 100.0 };
        let mut touch = Strengths::new(&MappingOptions::default(), 1000.0, true);
        touch.begin(&Sensation { tap: Some(tap), ..Sensation::default() }, 1, |_| 0.02);
        let samples: Vec<f64> = (0..40).map(|_| touch.next_squared().sqrt()).collect();
        let most = 0.5 / perceptual_weight(250.0);
        assert!(samples[..21].iter().all(|sample| (sample / most - 1.0).abs() < 1e-12));
        assert!((samples[30] / most - (-1.0_f64).exp()).abs() < 1e-12);
    }
}
