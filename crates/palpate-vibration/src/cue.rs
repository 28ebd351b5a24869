// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cues and sensations: from the touch of a contact point to what an actuator plays.
//!
//! A tap rings as a decaying sinusoid whose amplitude grows with the speed of the tap: Okamura,
//! Cutkosky and Dennerlein, "Reality-based models for vibration feedback in virtual
//! environments" (2001). A slide over a texture shakes at the rate at which its crests pass.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::sensation_level::perceptual_weight;
use palpate_device::NumberError;

/// A decaying sinusoid: `a exp(−d t) sin(2π f t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// The amplitude a: in a [`Cue`] per speed of the tap [N·s/m], in a [`Sensation`] as a part
    /// of the actuator's largest.
    pub amplitude: f64,
    /// The frequency f [Hz].
    pub frequency: f64,
    /// The rate of decay d [1/s].
    pub decay: f64,
}

/// The touch of a contact point in a tick, as vibration needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cue {
    /// The depth [m]; zero in free space.
    pub depth: f64,
    /// The normal force [N].
    pub normal_force: f64,
    /// The speed towards the surface [m/s]; negative when the hand moves out.
    pub normal_speed: f64,
    /// The speed along the surface [m/s].
    pub slide_speed: f64,
    /// The wavelength of the surface's texture [m]; `None` for a smooth surface.
    pub wavelength: Option<f64>,
    /// The ringing of a tap on the surface; `None` for a mute surface.
    pub impact: Option<Tap>,
    /// `true` in the tick in which contact begins.
    pub began: bool,
}

/// A vibration at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tone {
    /// The frequency [Hz].
    pub frequency: f64,
    /// The amplitude, as a part of the actuator's largest, in [0, 1].
    pub amplitude: f64,
}

/// The vibration of a cue on an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensation {
    /// The tone of pressure.
    pub hold: Tone,
    /// The tone of a slide over a texture.
    pub slide: Tone,
    /// The tap that begins in this tick; amplitude in [0, 1].
    pub tap: Option<Tap>,
}

/// Options of a [`Mapping`]. The defaults are choices for a hand-held actuator, not
/// measurements.
///
/// ```
/// use palpate_vibration::MappingOptions;
///
/// let options = MappingOptions {
///     full_depth: 0.004,
///     full_impact: 3.0,
///     ..MappingOptions::default()
/// };
/// assert_eq!((options.full_depth, options.full_impact), (0.004, 3.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappingOptions {
    /// The level of the lightest pressure, a_min, in [0, 1]: where the actuator starts to move.
    pub hold_floor: f64,
    /// The depth at which pressure is at full level, d_max [m]; positive.
    pub full_depth: f64,
    /// The exponent γ of depth, in (0, 4]; below one, light pressures differ more.
    pub hold_exponent: f64,
    /// The frequency of pressure [Hz], in the actuator's range.
    pub hold_frequency: f64,
    /// What is left of a pressure that does not change, as a part, φ, in [0, 1]; 1 for a pressure
    /// that lasts.
    pub hold_fraction: f64,
    /// The time constant with which such a pressure fades, τ [s]; positive.
    pub hold_time: f64,
    /// The change of the level of pressure that brings it back in full, in (0, 1].
    pub hold_revival: f64,
    /// The force at which a tap or its ringing is at full level [N]; positive.
    pub full_impact: f64,
    /// The speed at which a slide is at full level [m/s]; positive.
    pub full_slide_speed: f64,
    /// The normal force at which a slide is at full level [N]; positive.
    pub full_slide_force: f64,
    /// The exponent κ of speed and force in a slide's level, in (0, 4].
    pub slide_exponent: f64,
    /// The lowest frequency the actuator plays [Hz]; positive.
    pub lowest_frequency: f64,
    /// The highest frequency the actuator plays [Hz]; not below the lowest.
    pub highest_frequency: f64,
    /// Whether amplitudes are scaled by [`perceptual_weight`], so that a level feels alike at
    /// all frequencies of the range: full at the end where the skin is least sensitive.
    pub equalise: bool,
}

impl Default for MappingOptions {
    /// Pressure from 0.1 to full at 5 mm, as its 0.8th power, at 60 Hz, fading to a tenth with 2 s
    /// until its level changes by a tenth; taps full at 2 N; slides full at 0.2 m/s and 2 N, by
    /// square roots; 40 to 400 Hz, as the actuator plays them.
    fn default() -> Self {
        Self {
            hold_floor: 0.1,
            full_depth: 0.005,
            hold_exponent: 0.8,
            hold_frequency: 60.0,
            hold_fraction: 0.1,
            hold_time: 2.0,
            hold_revival: 0.1,
            full_impact: 2.0,
            full_slide_speed: 0.2,
            full_slide_force: 2.0,
            slide_exponent: 0.5,
            lowest_frequency: 40.0,
            highest_frequency: 400.0,
            equalise: false,
        }
    }
}

/// Turns cues into sensations.
///
/// Pressure holds at `a_min + (1 − a_min) (depth / d_max)^γ`; a tap at normal speed v begins at
/// `a v / full_impact`; a slide at speed u over crests λ apart, pressed by F, shakes at `u / λ`
/// within the actuator's range, at the level `(u / full_slide_speed)^κ (F /
/// full_slide_force)^κ`. Levels are at most one. A number that is not finite gives silence.
///
/// # Examples
///
/// ```
/// use palpate_vibration::{Cue, Mapping, MappingOptions, Tone};
///
/// # fn main() -> Result<(), palpate_device::NumberError> {
/// let options = MappingOptions {
///     hold_floor: 0.25,
///     full_depth: 0.004,
///     hold_exponent: 1.0,
///     full_slide_speed: 0.5,
///     ..MappingOptions::default()
/// };
/// let cue = Cue {
///     depth: 0.001,
///     normal_force: 2.0,
///     slide_speed: 0.125,
///     wavelength: Some(0.0009765625), // 1/1024 m
///     ..Cue::default()
/// };
/// let felt = Mapping::new(options)?.feel(&cue);
/// assert_eq!(felt.hold, Tone { frequency: 60.0, amplitude: 0.4375 });
/// assert_eq!(felt.slide, Tone { frequency: 128.0, amplitude: 0.5 });
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    options: MappingOptions,
    /// The largest perceptual weight in the range, by which weights are divided.
    heaviest: f64,
}

/// The largest exponent: a larger one would silence all but the strongest level.
const LARGEST_EXPONENT: f64 = 4.0;

impl Mapping {
    /// A mapping with these options.
    ///
    /// # Errors
    ///
    /// [`NumberError`] if one is outside its range.
    pub fn new(options: MappingOptions) -> Result<Self, NumberError> {
        let o = &options;
        for (parameter, part) in
            [("hold_floor", o.hold_floor), ("hold_fraction", o.hold_fraction)]
        {
            let part = NumberError::check_not_negative(parameter, part, "")?;
            at_most(parameter, part, 1.0, "at most 1")?;
        }
        let revival = NumberError::check_positive("hold_revival", o.hold_revival, "")?;
        at_most("hold_revival", revival, 1.0, "at most 1")?;
        for (parameter, exponent) in
            [("hold_exponent", o.hold_exponent), ("slide_exponent", o.slide_exponent)]
        {
            let exponent = NumberError::check_positive(parameter, exponent, "")?;
            at_most(parameter, exponent, LARGEST_EXPONENT, "at most 4")?;
        }
        for (parameter, value, unit) in [
            ("full_depth", o.full_depth, "m"),
            ("hold_time", o.hold_time, "s"),
            ("full_impact", o.full_impact, "N"),
            ("full_slide_speed", o.full_slide_speed, "m/s"),
            ("full_slide_force", o.full_slide_force, "N"),
            ("lowest_frequency", o.lowest_frequency, "Hz"),
            ("highest_frequency", o.highest_frequency, "Hz"),
            ("hold_frequency", o.hold_frequency, "Hz"),
        ] {
            NumberError::check_positive(parameter, value, unit)?;
        }
        let refuse =
            |parameter, rule, value| Err(NumberError::new(parameter, rule, value, "Hz"));
        if o.highest_frequency < o.lowest_frequency {
            let rule = "at least the lowest frequency";
            return refuse("highest_frequency", rule, o.highest_frequency);
        }
        if !(o.lowest_frequency..=o.highest_frequency).contains(&o.hold_frequency) {
            return refuse("hold_frequency", "in the actuator's range", o.hold_frequency);
        }
        let weight = perceptual_weight;
        // The threshold falls and rises again: it is highest at an end of any range.
        let heaviest = weight(o.lowest_frequency).max(weight(o.highest_frequency));
        Ok(Self { options, heaviest })
    }

    /// The options.
    #[must_use]
    pub fn options(&self) -> &MappingOptions {
        &self.options
    }

    /// The sensation of `cue` on the actuator.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn feel(&self, cue: &Cue) -> Sensation {
        let o = &self.options;
        let hold = if cue.depth > 0.0 {
            let part = libm::pow(level(cue.depth / o.full_depth), o.hold_exponent);
            self.tone(o.hold_frequency, o.hold_floor + (1.0 - o.hold_floor) * part)
        } else {
            Tone::default()
        };
        let slide = cue.wavelength.filter(|length| *length > 0.0).map(|wavelength| {
            let speed = cue.slide_speed.abs();
            let fast = (speed / o.full_slide_speed).max(0.0);
            let hard = (cue.normal_force / o.full_slide_force).max(0.0);
            self.tone(speed / wavelength, libm::pow(fast * hard, o.slide_exponent))
        });
        let tap = cue.impact.filter(|_| cue.began && cue.normal_speed > 0.0).map(|tap| {
            let strength = tap.amplitude * cue.normal_speed / o.full_impact;
            let Tone { frequency, amplitude } = self.tone(tap.frequency, strength);
            // Written so that a tap with NaN decay ends at once.
            let decay = if tap.decay >= 0.0 { tap.decay } else { f64::INFINITY };
            Tap { amplitude, frequency, decay }
        });
        let tap = tap.filter(|tap| tap.amplitude > 0.0);
        Sensation { hold, slide: slide.unwrap_or_default(), tap }
    }

    /// The tone within the actuator's range; silence for NaN.
    fn tone(&self, frequency: f64, amplitude: f64) -> Tone {
        let o = &self.options;
        if frequency.is_nan() {
            return Tone::default();
        }
        let frequency = frequency.clamp(o.lowest_frequency, o.highest_frequency);
        let weight =
            if o.equalise { perceptual_weight(frequency) / self.heaviest } else { 1.0 };
        Tone { frequency, amplitude: level(amplitude) * weight }
    }
}

/// `value` clamped to [0, 1]; zero for NaN.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(super) fn level(value: f64) -> f64 {
    // Written so that NaN gives zero.
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn at_most(
    parameter: &'static str,
    value: f64,
    most: f64,
    rule: &'static str,
) -> Result<(), NumberError> {
    if value <= most {
        return Ok(());
    }
    Err(NumberError::new(parameter, rule, value, ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    const STEEL: Tap = Tap { amplitude: 4.0, frequency: 300.0, decay: 90.0 };

    fn mapping(change: impl FnOnce(&mut MappingOptions)) -> Result<Mapping, NumberError> {
        let mut options = MappingOptions::default();
        change(&mut options);
        Mapping::new(options)
    }

    #[test]
    fn a_tap_is_as_strong_as_it_is_fast() {
        let mapping = mapping(|_| ()).unwrap();
        let cue =
            Cue { normal_speed: 0.125, impact: Some(STEEL), began: true, ..Cue::default() };
        assert_eq!(mapping.feel(&cue).tap, Some(Tap { amplitude: 0.25, ..STEEL }));
        assert_eq!(mapping.feel(&Cue { began: false, ..cue }).tap, None);
        assert_eq!(mapping.feel(&Cue { normal_speed: -0.1, ..cue }).tap, None);
        let hard = mapping.feel(&Cue { normal_speed: 100.0, ..cue });
        assert_eq!(hard.tap.unwrap().amplitude, 1.0);
    }

    #[test]
    fn a_slide_stays_in_the_range_of_the_actuator() {
        let mapping = mapping(|_| ()).unwrap();
        let at = |speed: f64| {
            let cue = Cue {
                slide_speed: speed,
                normal_force: 1.0,
                wavelength: Some(1e-3),
                ..Cue::default()
            };
            mapping.feel(&cue).slide
        };
        assert_eq!(at(0.001).frequency, 40.0);
        assert_eq!(at(1.0).frequency, 400.0);
        assert_eq!(at(0.0).amplitude, 0.0);
    }

    #[test]
    fn every_level_is_between_nothing_and_all() {
        let odd = [0.0, -1.0, 1e-9, 0.3, 1e9, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        for equalise in [false, true] {
            let mapping = mapping(|o| o.equalise = equalise).unwrap();
            cases(2000, |u| {
                let mut number = || u.choose(&odd).copied();
                let cue = Cue {
                    depth: number()?,
                    normal_force: number()?,
                    normal_speed: number()?,
                    slide_speed: number()?,
                    wavelength: Some(number()?),
                    impact: Some(Tap {
                        amplitude: number()?,
                        frequency: number()?,
                        decay: number()?,
                    }),
                    began: true,
                };
                let felt = mapping.feel(&cue);
                for tone in [felt.hold, felt.slide] {
                    assert!((0.0..=1.0).contains(&tone.amplitude), "{cue:?}");
                    assert!((0.0..=400.0).contains(&tone.frequency), "{cue:?}");
                }
                if let Some(tap) = felt.tap {
                    assert!(tap.amplitude > 0.0 && tap.amplitude <= 1.0, "{cue:?}");
                    assert!((40.0..=400.0).contains(&tap.frequency) && tap.decay >= 0.0);
                }
                Ok(())
            });
        }
    }

    #[test]
    fn equal_levels_are_equally_far_above_the_threshold() {
        let mapping = mapping(|o| o.equalise = true).unwrap();
        let above = |frequency: f64| {
            mapping.tone(frequency, 0.5).amplitude / perceptual_weight(frequency)
        };
        assert!((above(250.0) / above(60.0) - 1.0).abs() < 1e-12);
        assert!((mapping.tone(40.0, 1.0).amplitude - 1.0).abs() < 1e-15);
    }

    #[test]
    fn wrong_numbers_are_named() {
        let error = mapping(|o| o.full_depth = 0.0).unwrap_err();
        assert_eq!(error.to_string(), "full_depth must be positive and finite, got 0 m");
        let error = mapping(|o| o.hold_frequency = 30.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "hold_frequency must be in the actuator's range, got 30 Hz"
        );
        assert!(mapping(|o| o.hold_floor = 1.5).is_err());
        assert!(mapping(|o| o.hold_fraction = 1.5).is_err());
        assert!(mapping(|o| o.hold_time = 0.0).is_err());
        assert!(mapping(|o| o.hold_revival = 0.0).is_err());
        assert!(mapping(|o| o.slide_exponent = 5.0).is_err());
        assert!(mapping(|o| o.highest_frequency = 30.0).is_err());
        assert!(mapping(|o| o.lowest_frequency = f64::NAN).is_err());
    }
}
