// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Actuators as data: what moves in them, how fast it answers, and where each figure is from.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod drive;
mod model;
mod profiles;

use std::borrow::Cow;

use palpate_device::NumberError;

use crate::cue::MappingOptions;

pub(crate) use drive::{CarrierDrive, Motor, MotorDrive};
pub use model::ActuatorModel;
pub use profiles::{ACTUATORS, actuator_named};

/// The lowest frequency of a slide over a resonant actuator [Hz], whose carrier follows crests of
/// any slowness: far below one crest a second nothing passes.
const SLOWEST_CRESTS: f64 = 1.0;

/// What moves in an actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mechanism {
    /// An eccentric rotating mass (ERM): a motor with an unbalanced weight, whose level drives
    /// speed and amplitude together.
    RotatingMass {
        /// The turns a second at the rated level [Hz].
        frequency: f64,
        /// The least level at which the resting motor starts, as a part of the rated one, in
        /// (0, 1].
        start_level: f64,
        /// The largest level for a short time, as a part of the rated one; at least 1. Backwards
        /// it brakes.
        overdrive: f64,
        /// The time constant of the speed when the motor is driven [s].
        rise: f64,
        /// The time constant of the speed when the motor coasts [s].
        fall: f64,
    },
    /// A linear resonant actuator (LRA): a mass on a spring, which is strong at its resonance
    /// alone.
    Resonant {
        /// The resonance f₀ [Hz].
        resonance: f64,
        /// The width B of the resonance between the points at which its power is halved [Hz]. The
        /// amplitude rises and falls with the time constant `1 / (π B)`.
        bandwidth: f64,
        /// The largest level for a short time, as a part of the rated one; at least 1.
        overdrive: f64,
    },
    /// A voice coil: follows a waveform within its band.
    VoiceCoil {
        /// The lower end of the band, at half the power [Hz].
        lowest: f64,
        /// The upper end of the band, at half the power [Hz].
        highest: f64,
    },
}

/// An actuator that shakes the skin.
///
/// ```
/// use palpate_vibration::{Mechanism, actuator_named};
///
/// let lra = actuator_named("lra").unwrap();
/// let Mechanism::Resonant { resonance, .. } = lra.mechanism else { unreachable!() };
/// assert_eq!(resonance, 170.0);
/// // The data sheet's resonance is published; the width of the resonance is not.
/// assert_eq!(*lra.assumed, ["bandwidth", "overdrive"]);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Actuator {
    /// The maker's name of it.
    pub name: Cow<'static, str>,
    /// What moves in it, with its figures.
    pub mechanism: Mechanism,
    /// Where the figures are from.
    pub source: Cow<'static, str>,
    /// The figures that are not from the source, by the names of their fields.
    pub assumed: Cow<'static, [&'static str]>,
}

impl Actuator {
    /// An actuator of your own, whose figures all count as measured.
    ///
    /// # Errors
    ///
    /// [`NumberError`] if a figure is not positive and finite, a start level is above
    /// the rated level, an overdrive below it, or a band ends below its beginning.
    ///
    /// ```
    /// use palpate_vibration::{Actuator, Mechanism};
    ///
    /// let mechanism = Mechanism::VoiceCoil { lowest: 20.0, highest: 10.0 };
    /// let error = Actuator::new("mine", "measured on the bench", mechanism).unwrap_err();
    /// assert_eq!(error.to_string(), "highest must be above lowest, got 10 Hz");
    /// ```
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        source: impl Into<Cow<'static, str>>,
        mechanism: Mechanism,
    ) -> Result<Self, NumberError> {
        mechanism.check()?;
        Ok(Self {
            name: name.into(),
            mechanism,
            source: source.into(),
            assumed: Cow::Borrowed(&[]),
        })
    }

    /// The options of a mapping for this actuator: as `base`, within the actuator's band.
    ///
    /// - A voice coil plays the tones of `base` that lie in its band, and moves the others to its
    ///   nearer end.
    /// - A resonant actuator plays slow crests as a rhythm of its carrier, so there is no lowest
    ///   frequency of a slide, down to one crest a second.
    /// - A rotating mass plays what there is at the speeds that it has.
    ///
    /// ```
    /// use palpate_vibration::{MappingOptions, actuator_named};
    ///
    /// let coil = actuator_named("voice_coil").unwrap();
    /// let options = coil.options(MappingOptions::default());
    /// assert_eq!((options.lowest_frequency, options.highest_frequency), (90.0, 400.0));
    /// assert_eq!(options.hold_frequency, 90.0);
    /// ```
    #[must_use]
    pub fn options(&self, base: MappingOptions) -> MappingOptions {
        match self.mechanism {
            Mechanism::RotatingMass { .. } => base,
            Mechanism::Resonant { .. } => MappingOptions {
                lowest_frequency: base.lowest_frequency.min(SLOWEST_CRESTS),
                ..base
            },
            Mechanism::VoiceCoil { lowest, highest } => {
                let within = |frequency: f64| frequency.max(lowest).min(highest);
                MappingOptions {
                    lowest_frequency: within(base.lowest_frequency),
                    highest_frequency: within(base.highest_frequency),
                    hold_frequency: within(base.hold_frequency),
                    ..base
                }
            }
        }
    }
}

impl Mechanism {
    /// What such an actuator is called: `"ERM"`, `"LRA"`, `"voice coil"`.
    #[must_use]
    pub const fn kind_name(&self) -> &'static str {
        match self {
            Self::RotatingMass { .. } => "ERM",
            Self::Resonant { .. } => "LRA",
            Self::VoiceCoil { .. } => "voice coil",
        }
    }

    /// The figures: the name of the field, the value and its unit.
    ///
    /// ```
    /// use palpate_vibration::Mechanism;
    ///
    /// let coil = Mechanism::VoiceCoil { lowest: 90.0, highest: 1000.0 };
    /// assert_eq!(coil.figures(), [("lowest", 90.0, "Hz"), ("highest", 1000.0, "Hz")]);
    /// ```
    #[must_use]
    pub fn figures(&self) -> Vec<(&'static str, f64, &'static str)> {
        match *self {
            Self::RotatingMass { frequency, start_level, overdrive, rise, fall } => vec![
                ("frequency", frequency, "Hz"),
                ("start_level", start_level, ""),
                ("overdrive", overdrive, ""),
                ("rise", rise, "s"),
                ("fall", fall, "s"),
            ],
            Self::Resonant { resonance, bandwidth, overdrive } => vec![
                ("resonance", resonance, "Hz"),
                ("bandwidth", bandwidth, "Hz"),
                ("overdrive", overdrive, ""),
            ],
            Self::VoiceCoil { lowest, highest } => {
                vec![("lowest", lowest, "Hz"), ("highest", highest, "Hz")]
            }
        }
    }

    /// The highest frequency at which the actuator moves [Hz].
    pub(crate) const fn highest_frequency(&self) -> f64 {
        match self {
            Self::RotatingMass { frequency, .. } => *frequency,
            Self::Resonant { resonance, .. } => *resonance,
            Self::VoiceCoil { highest, .. } => *highest,
        }
    }

    pub(crate) fn check(&self) -> Result<(), NumberError> {
        for (parameter, value, unit) in self.figures() {
            NumberError::check_positive(parameter, value, unit)?;
        }
        let wrong =
            |parameter, rule, value, unit| Err(NumberError::new(parameter, rule, value, unit));
        match *self {
            Self::RotatingMass { start_level, .. } if start_level > 1.0 => {
                wrong("start_level", "at most 1", start_level, "")
            }
            Self::RotatingMass { overdrive, .. } | Self::Resonant { overdrive, .. }
                if overdrive < 1.0 =>
            {
                wrong("overdrive", "at least 1", overdrive, "")
            }
            Self::VoiceCoil { lowest, highest } if highest <= lowest => {
                wrong("highest", "above lowest", highest, "Hz")
            }
            _ => Ok(()),
        }
    }
}

/// The highest sample rate [Hz]: what is kept of the last milliseconds stays small.
const HIGHEST_SAMPLE_RATE: f64 = 1e6;

/// Checks that `sample_rate` [Hz] is at least twice the `highest` frequency [Hz] that it carries.
pub(crate) fn check_sample_rate(sample_rate: f64, highest: f64) -> Result<f64, NumberError> {
    NumberError::check_positive("sample_rate", sample_rate, "Hz")?;
    let wrong = |rule| Err(NumberError::new("sample_rate", rule, sample_rate, "Hz"));
    if sample_rate < 2.0 * highest {
        return wrong("at least twice the highest frequency");
    }
    if sample_rate > HIGHEST_SAMPLE_RATE {
        return wrong("at most 1e6 Hz");
    }
    Ok(sample_rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_figures_are_named() {
        let refused = |mechanism| Actuator::new("a", "b", mechanism).unwrap_err().to_string();
        let motor = |start_level, overdrive| Mechanism::RotatingMass {
            frequency: 200.0,
            start_level,
            overdrive,
            rise: 0.05,
            fall: 0.1,
        };
        assert_eq!(refused(motor(1.25, 1.5)), "start_level must be at most 1, got 1.25");
        assert_eq!(refused(motor(0.5, 0.5)), "overdrive must be at least 1, got 0.5");
        let lra = Mechanism::Resonant { resonance: f64::NAN, bandwidth: 10.0, overdrive: 1.0 };
        assert_eq!(refused(lra), "resonance must be positive and finite, got NaN Hz");
        assert!(Actuator::new("a", "b", motor(0.5, 1.5)).is_ok());
    }

    #[test]
    fn a_coil_that_ends_low_holds_in_its_band() {
        let low = Mechanism::VoiceCoil { lowest: 5.0, highest: 50.0 };
        let options = Actuator::new("a", "b", low).unwrap().options(MappingOptions::default());
        assert_eq!(options.hold_frequency, 50.0);
        assert!(crate::Mapping::new(options).is_ok());
    }
}
