// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sensations as sound: samples for voice coils and other actuators that take a waveform.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use super::cue::{Mapping, Sensation, Tap, Tone};
use super::ringing::Ringing;
use palpate_haptics::{HapticsError, NumberError};

/// The time over which an amplitude rises from zero to one [s]: a jump would click, a slower
/// rise would blur a texture.
const ATTACK: f64 = 0.002;

/// A sine whose phase never jumps, and whose amplitude changes slowly.
#[derive(Clone, Copy, Debug, Default)]
struct Oscillator {
    /// The phase in turns, in [0, 1).
    phase: f64,
    amplitude: f64,
}

/// From one sample to the next.
#[derive(Clone, Copy)]
struct Step {
    /// The time between two samples [s].
    period: f64,
    /// The largest change of an amplitude.
    slew: f64,
}

impl Oscillator {
    /// The next sample, a step after the last, while the oscillator moves towards `tone`.
    fn next(&mut self, tone: Tone, step: Step) -> f64 {
        let Step { period, slew } = step;
        let change = (tone.amplitude - self.amplitude).clamp(-slew, slew);
        self.amplitude += change;
        let sample = self.amplitude * libm::sin(TAU * self.phase);
        self.phase += tone.frequency * period;
        self.phase -= libm::floor(self.phase);
        sample
    }

    /// Starts at `amplitude` at once if the oscillator is silent: at phase zero this does not
    /// click.
    fn strike(&mut self, amplitude: f64) {
        if self.amplitude == 0.0 {
            *self = Self { phase: 0.0, amplitude };
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Player {
    hold: Oscillator,
    slide: Oscillator,
    tap: Oscillator,
    ringing: Ringing,
    /// The last tones of hold and slide, because a sine that fades out keeps its frequency.
    last: [f64; 2],
}

/// Makes the samples of one actuator from the sensations of some contact points.
///
/// The phase of every sine is continuous when its frequency changes, and its amplitude changes
/// over 2 ms; a tap begins at once, at phase zero. So neighbouring samples of a point differ by
/// at most [`largest_step`](Self::largest_step). The sum is clamped to ±1.
///
/// # Examples
///
/// A tap is `a exp(−d t) sin(2π f t)` from its first sample on:
///
/// ```
/// use palpate_vibration::{
///     Mapping, MappingOptions, Sensation, Synthesiser, Tap,
/// };
///
/// # fn main() -> Result<(), palpate_haptics::HapticsError> {
/// let mapping = Mapping::new(MappingOptions::default())?;
/// let mut synthesiser = Synthesiser::new(&mapping, 8000.0, 1)?;
/// let tap = Tap { amplitude: 0.5, frequency: 250.0, decay: 100.0 };
/// let mut samples = [0.0; 16];
/// synthesiser.render(&[Sensation { tap: Some(tap), ..Sensation::default() }], &mut samples);
///
/// assert_eq!(samples[0], 0.0);
/// // After 1 ms, a quarter of a turn.
/// assert!((f64::from(samples[8]) - 0.5 * (-0.1_f64).exp()).abs() < 1e-7);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Synthesiser {
    players: Vec<Player>,
    sample_rate: f64,
    highest_frequency: f64,
}

impl Synthesiser {
    /// A synthesiser of `sample_rate` [Hz] for `points` contact points, whose sensations come
    /// from `mapping`.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoContactPoint`] without a point; [`HapticsError::Number`] if the sample
    /// rate is less than twice the mapping's highest frequency, which would alias.
    pub fn new(
        mapping: &Mapping,
        sample_rate: f64,
        points: usize,
    ) -> Result<Self, HapticsError> {
        if points == 0 {
            return Err(HapticsError::NoContactPoint);
        }
        NumberError::check_positive("sample_rate", sample_rate, "Hz")?;
        let highest_frequency = mapping.options().highest_frequency;
        if sample_rate < 2.0 * highest_frequency {
            let (parameter, rule) = ("sample_rate", "at least twice the highest frequency");
            let (value, unit) = (sample_rate, "Hz");
            return Err(HapticsError::Number(NumberError::new(parameter, rule, value, unit)));
        }
        let player = Player {
            hold: Oscillator::default(),
            slide: Oscillator::default(),
            tap: Oscillator::default(),
            ringing: Ringing::new(sample_rate),
            last: [0.0; 2],
        };
        Ok(Self { players: vec![player; points], sample_rate, highest_frequency })
    }

    /// Samples a second [Hz].
    #[must_use]
    pub fn sample_rate(&self) -> f64 {
        self.sample_rate
    }

    /// The largest difference of neighbouring samples of one contact point: for three sines of
    /// full amplitude and the highest frequency f, `3 (2π f + 1 / 2 ms) / sample_rate`.
    #[must_use]
    pub fn largest_step(&self) -> f64 {
        3.0 * (TAU * self.highest_frequency + 1.0 / ATTACK) / self.sample_rate
    }

    /// Renders the samples of one tick, in [−1, 1], from the sensation of each contact point;
    /// silence for those missing. As many samples as `samples` has places: 8 for a tick of
    /// 1 kHz at 8 kHz.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn render(&mut self, sensations: &[Sensation], samples: &mut [f32]) {
        let step =
            Step { period: 1.0 / self.sample_rate, slew: 1.0 / (ATTACK * self.sample_rate) };
        let silence = Sensation::default();
        let felt = sensations.iter().chain(std::iter::repeat(&silence));
        for (player, sensation) in self.players.iter_mut().zip(felt) {
            player.begin(sensation);
        }
        for sample in samples {
            let mut sum = 0.0;
            let felt = sensations.iter().chain(std::iter::repeat(&silence));
            for (player, sensation) in self.players.iter_mut().zip(felt) {
                sum += player.next(sensation, step);
            }
            // Clamping makes no step larger.
            *sample = sum.clamp(-1.0, 1.0) as f32;
        }
    }
}

impl Player {
    fn begin(&mut self, sensation: &Sensation) {
        if let Some(tap) = sensation.tap {
            self.ringing.strike(tap);
            self.tap.strike(tap.amplitude);
        }
        let [hold, slide] = &mut self.last;
        for (last, tone) in [(hold, sensation.hold), (slide, sensation.slide)] {
            if tone.amplitude > 0.0 {
                *last = tone.frequency;
            }
        }
    }

    fn next(&mut self, sensation: &Sensation, step: Step) -> f64 {
        let [hold, slide] = self.last;
        let Tap { amplitude, frequency, .. } = self.ringing.next();
        self.hold.next(Tone { frequency: hold, ..sensation.hold }, step)
            + self.slide.next(Tone { frequency: slide, ..sensation.slide }, step)
            + self.tap.next(Tone { frequency, amplitude }, step)
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use crate::{Cue, MappingOptions};
    use palpate_testkit::cases::each as cases;

    const WOOD: Tap = Tap { amplitude: 8.0, frequency: 100.0, decay: 80.0 };

    fn mapping() -> Mapping {
        Mapping::new(MappingOptions::default()).unwrap()
    }

    #[test]
    fn nothing_clicks_whatever_happens() {
        let mapping = mapping();
        cases(50, |u| {
            let mut synthesiser = Synthesiser::new(&mapping, 8000.0, 1).unwrap();
            // The sines of f32 samples round at 2^-24.
            let largest = synthesiser.largest_step() + 1e-6;
            let mut last = 0.0;
            for _ in 0..300 {
                let mut number = || u.int_in_range(0..=100).map(|i: i32| f64::from(i) * 1e-2);
                let cue = Cue {
                    depth: number()? * 0.01,
                    normal_force: number()? * 5.0,
                    normal_speed: number()?,
                    slide_speed: number()?,
                    wavelength: Some(0.002),
                    impact: Some(WOOD),
                    began: number()? < 0.2,
                };
                let mut samples = [0.0_f32; 8];
                synthesiser.render(&[mapping.feel(&cue)], &mut samples);
                for sample in samples {
                    assert!(sample.abs() <= 1.0);
                    assert!(f64::from(sample - last).abs() <= largest);
                    last = sample;
                }
            }
            Ok(())
        });
    }

    #[test]
    fn a_slide_is_a_sine_of_its_frequency() {
        let slide = Tone { frequency: 200.0, amplitude: 0.5 };
        let mut synthesiser = Synthesiser::new(&mapping(), 8000.0, 1).unwrap();
        let mut samples = vec![0.0_f32; 8000];
        for tick in samples.chunks_mut(8) {
            synthesiser.render(&[Sensation { slide, ..Sensation::default() }], tick);
        }
        let up = samples.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        assert!((199..=200).contains(&up), "{up} turns in a second");
        let largest = samples.iter().copied().fold(0.0, f32::max);
        assert!((f64::from(largest) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn silence_becomes_and_stays_silent() {
        let mut synthesiser = Synthesiser::new(&mapping(), 8000.0, 2).unwrap();
        let cue = Cue {
            depth: 0.01,
            normal_speed: 1.0,
            impact: Some(WOOD),
            began: true,
            ..Cue::default()
        };
        let mut samples = [0.0_f32; 8];
        synthesiser.render(&[mapping().feel(&cue)], &mut samples);
        assert!(samples.iter().any(|sample| *sample != 0.0));
        for _ in 0..1100 {
            synthesiser.render(&[], &mut samples);
        }
        assert_eq!(samples, [0.0; 8]);
    }

    #[test]
    fn too_few_samples_are_refused() {
        let error = Synthesiser::new(&mapping(), 700.0, 1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "sample_rate must be at least twice the highest frequency, got 700 Hz"
        );
        assert!(Synthesiser::new(&mapping(), 8000.0, 0).is_err());
    }
}
