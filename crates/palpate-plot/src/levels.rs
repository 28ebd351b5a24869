// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which isolines a figure draws.

use crate::error::PlotError;
use crate::numbers::{multiples, round_up};

/// The isolines are at most about so many if no step is given: enough to show slopes, few enough
/// to label.
const AIM: f64 = 14.0;
/// Most isolines of a figure. At 800 px they are then about 4 px apart.
const MOST: usize = 200;

/// The levels of a figure's isolines [m]: multiples of a step, zero among them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels {
    pub(crate) step: f64,
    /// Ascending; all within the range of the samples.
    pub(crate) values: Vec<f64>,
}

impl Levels {
    /// Levels for samples in `[low, high]` in a window with the shorter side `size`, all [m].
    ///
    /// The step is the round number (1, 2, 5 times a power of ten) that gives up to 14 levels.
    pub(crate) fn choose(low: f64, high: f64, size: f64) -> Self {
        let span = high - low;
        // A field that is constant, or constant to rounding, has no span to divide.
        let span = if span > 1e-9 * low.abs().max(high.abs()) { span } else { size };
        let step = round_up(span / AIM);
        Self { step, values: multiples(low, high, step, MOST) }
    }

    /// Levels at multiples of `step` in `[low, high]`, all [m].
    ///
    /// # Errors
    ///
    /// [`PlotError::Step`] or [`PlotError::TooManyLevels`].
    pub(crate) fn with_step(low: f64, high: f64, step: f64) -> Result<Self, PlotError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(PlotError::Step { step });
        }
        let count = (high / step).floor() - (low / step).ceil() + 1.0;
        if count > MOST as f64 {
            return Err(PlotError::TooManyLevels { step, count, max: MOST });
        }
        Ok(Self { step, values: multiples(low, high, step, MOST + 1) })
    }

    /// The number of bands inside and outside.
    pub(crate) fn bands(&self) -> (usize, usize) {
        let inside = self.values.iter().filter(|&&v| v < 0.0).count() + 1;
        let outside = self.values.iter().filter(|&&v| v > 0.0).count() + 1;
        (inside, outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contain_zero_and_cover_the_range() {
        for (low, high) in [(-0.1, 0.4), (-1.0, 1e6), (-3e-7, 2e-7), (-5.0, 0.001)] {
            let Levels { step, values } = Levels::choose(low, high, 1.0);
            assert!(values.contains(&0.0), "{low} {high}: {values:?}");
            assert!(values.len() >= 5 && values.len() <= 15, "{values:?}");
            assert!(values[0] - low < step * 1.000_001);
            assert!(high - values[values.len() - 1] < step * 1.000_001);
        }
    }

    #[test]
    fn constant_fields_have_a_step_and_no_lines() {
        let levels = Levels::choose(0.123, 0.123, 1.0);
        assert_eq!((levels.step, levels.values.len()), (0.1, 0));
        assert!(Levels::choose(1e9, 1e9, 1e-6).values.len() < 2);
    }

    #[test]
    fn refuses_steps_that_cannot_be_drawn() {
        assert!(Levels::with_step(-1.0, 1.0, f64::NAN).is_err());
        assert!(Levels::with_step(-1.0, 1.0, 0.0).is_err());
        let error = Levels::with_step(-1.0, 1.0, 1e-3).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a step of 0.001 m draws 2001 isolines; at most 200 can be told apart"
        );
    }
}
