// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a search is to find out, and when it has.

use crate::certified::Stop;

/// What is to be known.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Goal {
    Least { tolerance: f64 },
    Sign { tolerance: f64 },
}

impl Goal {
    /// How far apart the bounds may be [m].
    pub(crate) fn tolerance(self) -> f64 {
        let (Self::Least { tolerance } | Self::Sign { tolerance }) = self;
        tolerance
    }

    /// Cells with nothing below this need no more looking at.
    pub(crate) fn threshold(self, upper: f64) -> f64 {
        match self {
            Self::Least { tolerance } => upper - tolerance,
            Self::Sign { tolerance } => (upper - tolerance).min(f64::MIN_POSITIVE),
        }
    }

    /// `true` if a value as small as this is all that is to be known.
    pub(crate) fn is_hit(self, upper: f64) -> bool {
        matches!(self, Self::Sign { .. }) && upper <= 0.0
    }

    /// Why to stop, if the bounds allow it.
    pub(crate) fn reached(self, lower: f64, upper: f64) -> Option<Stop> {
        if self.is_hit(upper) || matches!(self, Self::Sign { .. }) && lower > 0.0 {
            return Some(Stop::SignKnown);
        }
        (upper - lower <= self.tolerance()).then_some(Stop::Converged)
    }
}
