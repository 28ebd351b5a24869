// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a search is to find out, and when it has.

use crate::certified::Stop;

/// What is to be known of a least value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// How far apart the bounds may be [m].
    pub(crate) tolerance: f64,
    /// That nothing is as small as this is all that is to be known beyond it [m].
    pub(crate) apart: f64,
    /// Whether it is enough that something is at most zero.
    is_sign: bool,
}

impl Goal {
    /// The least value.
    pub(crate) fn least(tolerance: f64) -> Self {
        Self { tolerance, apart: f64::INFINITY, is_sign: false }
    }

    /// The least value, if it is at most `apart`.
    pub(crate) fn least_within(apart: f64, tolerance: f64) -> Self {
        Self { tolerance, apart, is_sign: false }
    }

    /// Whether anything is at most zero.
    pub(crate) fn sign(tolerance: f64) -> Self {
        Self { tolerance, apart: 0.0, is_sign: true }
    }

    /// `true` if it is enough that something is at most zero.
    pub(crate) fn is_sign(self) -> bool {
        self.is_sign
    }

    /// Cells with nothing below this need no more looking at.
    pub(crate) fn threshold(self, upper: f64) -> f64 {
        (upper - self.tolerance).min(self.apart + self.apart * f64::EPSILON + f64::MIN_POSITIVE)
    }

    /// Where nothing is below this, nothing needs looking at, when the best is `upper`.
    pub(crate) fn most(self, upper: f64) -> f64 {
        upper.min(self.apart + self.tolerance).max(0.0)
    }

    /// `true` if a value as small as this is all that is to be known.
    pub(crate) fn is_hit(self, upper: f64) -> bool {
        self.is_sign && upper <= 0.0
    }

    /// Why to stop, if the bounds allow it.
    pub(crate) fn reached(self, lower: f64, upper: f64) -> Option<Stop> {
        if self.is_hit(upper) || lower > self.apart {
            return Some(Stop::SignKnown);
        }
        // The same rule as that by which cells are left alone, to the last bit.
        (lower >= self.threshold(upper)).then_some(Stop::Converged)
    }
}
