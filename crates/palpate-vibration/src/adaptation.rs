// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Holds that last fade.
//!
//! The skin adapts to a lasting vibration: its threshold rises with a time constant of seconds
//! (Hollins, Goble, Whitsel and Tommerdahl, "Time course and action spectrum of vibrotactile
//! adaptation", 1990), so that a motor which goes on shaking wears, warms and is felt less and
//! less. A hold therefore fades by itself; time, fraction and revival are choices, not
//! measurements.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::cue::{MappingOptions, Tone};

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
mod tests {
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
