// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Decaying taps: what an actuator plays from tick to tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::cue::{Mapping, Sensation, Tap, Tone};
use crate::sensation_level::Adaptation;
use palpate_device::NumberError;

/// The amplitude below which a tap ends: a tenth of the threshold at 250 Hz, where the skin is
/// most sensitive. The end of a louder tap could be felt; a quieter one cannot be felt at all.
const SILENT: f64 = 5e-4;

/// The longest duration of a tap [s], whatever its decay, so that no tone gets stuck.
const LONGEST: f64 = 1.0;

/// A decaying tap, in steps of fixed length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ringing {
    tap: Tap,
    /// The factor on the amplitude in a step.
    remainder: f64,
    steps_left: f64,
    rate: f64,
}

impl Ringing {
    /// Silence, in `rate` steps a second.
    pub(super) fn new(rate: f64) -> Self {
        let tap = Tap { amplitude: 0.0, frequency: 0.0, decay: 0.0 };
        Self { tap, remainder: 0.0, steps_left: 0.0, rate }
    }

    /// Starts `tap`, unless a stronger one is ringing.
    pub(super) fn strike(&mut self, tap: Tap) {
        if tap.amplitude > self.tap.amplitude {
            self.tap = tap;
            self.remainder = libm::exp(-tap.decay / self.rate);
            self.steps_left = LONGEST * self.rate;
        }
    }

    /// The tap in this step, which goes on as it is.
    pub(super) fn now(&self) -> Tap {
        self.tap
    }

    /// The tap in this step; it decays.
    pub(super) fn next(&mut self) -> Tap {
        let now = self.tap;
        self.steps_left -= 1.0;
        let left = now.amplitude * self.remainder;
        let goes_on = left >= SILENT && self.steps_left > 0.0;
        self.tap.amplitude = if goes_on { left } else { 0.0 };
        now
    }
}

/// What an actuator plays in a tick, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tones {
    /// The pressure that holds.
    pub hold: Tone,
    /// The texture that passes.
    pub slide: Tone,
    /// The tone of a ringing tap.
    pub tap: Tone,
    /// The tap's rate of decay [1/s].
    pub tap_decay: f64,
}

/// Lets the taps of one contact point decay at the servo's rate, and its holds fade.
///
/// A tap is replaced by a stronger one; it ends at a 2000th of full amplitude, or after one
/// second. A hold that does not change fades as [`Adaptation`] says.
///
/// ```
/// use palpate_vibration::{Mapping, MappingOptions, Sensation, Tap, Voice};
///
/// # fn main() -> Result<(), palpate_device::NumberError> {
/// let mapping = Mapping::new(MappingOptions::default())?;
/// let mut voice = Voice::new(&mapping, 1000.0)?;
/// let tap = Tap { amplitude: 0.5, frequency: 200.0, decay: 100.0 };
/// voice.step(&Sensation { tap: Some(tap), ..Sensation::default() });
/// for _ in 0..9 {
///     voice.step(&Sensation::default());
/// }
/// // After 10 ms of a decay of 100/s.
/// let tones = voice.step(&Sensation::default());
/// assert!((tones.tap.amplitude - 0.5 * (-1.0_f64).exp()).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Voice {
    ringing: Ringing,
    adaptation: Adaptation,
    /// The time of a step [s].
    period: f64,
}

impl Voice {
    /// A voice with `rate` steps a second [Hz], for sensations of this mapping.
    ///
    /// # Errors
    ///
    /// [`NumberError`] if the rate is not positive.
    pub fn new(mapping: &Mapping, rate: f64) -> Result<Self, NumberError> {
        let ringing = Ringing::new(NumberError::check_positive("rate", rate, "Hz")?);
        let adaptation = Adaptation::new(mapping.options());
        Ok(Self { ringing, adaptation, period: 1.0 / rate })
    }

    /// One tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, sensation: &Sensation) -> Tones {
        if let Some(tap) = sensation.tap {
            self.ringing.strike(tap);
        }
        let Tap { amplitude, frequency, decay } = self.ringing.next();
        let tap = Tone { frequency, amplitude };
        let hold = self.adaptation.step(sensation.hold, self.period).tone;
        Tones { hold, slide: sensation.slide, tap, tap_decay: decay }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MappingOptions;

    fn voice() -> Voice {
        Voice::new(&Mapping::new(MappingOptions::default()).unwrap(), 1000.0).unwrap()
    }

    fn struck(amplitude: f64, decay: f64) -> Sensation {
        let tap = Some(Tap { amplitude, frequency: 100.0, decay });
        Sensation { tap, ..Sensation::default() }
    }

    #[test]
    fn a_weaker_tap_does_not_end_a_stronger_one() {
        let mut voice = voice();
        voice.step(&struck(0.8, 10.0));
        let tones = voice.step(&struck(0.1, 500.0));
        assert!((tones.tap.amplitude - 0.8 * (-0.01_f64).exp()).abs() < 1e-12);
        assert_eq!(voice.step(&struck(1.0, 10.0)).tap.amplitude, 1.0);
    }

    #[test]
    fn every_tap_ends() {
        for decay in [0.0, 1e-3, 50.0, 1e9, f64::INFINITY] {
            let mut voice = voice();
            assert_eq!(voice.step(&struck(1.0, decay)).tap.amplitude, 1.0);
            let last = (0..1000).map(|_| voice.step(&Sensation::default())).last();
            assert_eq!(last.unwrap().tap.amplitude, 0.0, "decay {decay}");
        }
    }
}
