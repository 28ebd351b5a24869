// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How exactly a first touch is asked for.

use crate::certified::Stop;
use crate::error::QueryError;

/// Bodies that are apart by more than this share of the gap are free. It is less than one: a separation
/// that is known to a quarter of the gap proves a touch, or a step without one.
pub(super) const FREE: f64 = 0.5;

/// How often the time between the bounds is halved in the end, to find an earlier touch.
pub(super) const HALVES: u32 = 8;

/// How exactly a first touch is asked for.
///
/// ```
/// use palpate_query::SweepSettings;
///
/// let settings = SweepSettings { time_tolerance: 1e-6, ..SweepSettings::of_size(0.2) };
/// assert_eq!((settings.gap, settings.time_tolerance), (2e-7, 1e-6));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepSettings {
    /// Bodies whose separation is at most this touch [m]; those more than half of it apart may be called
    /// apart.
    pub gap: f64,
    /// How far apart the bounds of the time may be, as a share of the motion, which takes the time from 0
    /// to 1.
    pub time_tolerance: f64,
    /// How often the search in boxes evaluates fields at most; a round may exceed it. Conservative
    /// advancement and samples after an early end, and the contact, may use about as many again.
    pub budget: u32,
}

impl SweepSettings {
    /// The budget unless another is given.
    pub const BUDGET: u32 = 5_000_000;

    /// For bodies of a size [m]: a gap of a millionth of it, times to 1e-4 of the motion.
    #[must_use]
    pub const fn of_size(size: f64) -> Self {
        Self { gap: 1e-6 * size, time_tolerance: 1e-4, budget: Self::BUDGET }
    }

    /// A field that is at most this at a point of an element touches it [m].
    pub(super) fn touch_level(&self) -> f64 {
        (1.0 - FREE) * self.gap
    }

    /// Why a search ends that knows these bounds of the time; `None` if it goes on.
    pub(super) fn decided(&self, lower: f64, upper: f64) -> Option<Stop> {
        if upper < f64::INFINITY && lower >= upper - self.time_tolerance {
            return Some(Stop::Converged);
        }
        (lower >= 1.0).then_some(Stop::SignKnown)
    }

    pub(crate) fn check(&self) -> Result<(), QueryError> {
        for (what, value) in [("gap", self.gap), ("time_tolerance", self.time_tolerance)] {
            let limit = palpate_field::LARGEST_LENGTH;
            // Written so that NaN is refused.
            if !(value > 0.0 && value <= limit) {
                return Err(QueryError::Setting { what, value });
            }
        }
        Ok(())
    }
}
