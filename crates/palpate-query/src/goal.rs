// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a search is for, and when it may stop.

use crate::certified::{Limits, Stop};

/// The question about a least value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// How far apart the bounds may be [m].
    pub(crate) tolerance: f64,
    /// Stop once the minimum is proven above this [m].
    pub(crate) apart: f64,
    /// How far apart the bounds may be while the largest value asked for lies between them [m].
    finest: f64,
    /// Stop once the minimum is proven to be at most zero.
    is_sign: bool,
}

/// While the largest value asked for lies between the bounds, they may be apart by this share of
/// the tolerance. With the whole of it, pairs near the margin would stay undecided; without any, a
/// pair at the margin would spend its budget.
const FINEST: f64 = 1.0 / 64.0;

impl Goal {
    /// The least value.
    pub(crate) fn least(tolerance: f64) -> Self {
        Self { tolerance, apart: f64::INFINITY, finest: tolerance, is_sign: false }
    }

    /// The least value, if it is at most `apart`, which is to be decided.
    pub(crate) fn least_within(apart: f64, tolerance: f64) -> Self {
        Self { tolerance, apart, finest: FINEST * tolerance, is_sign: false }
    }

    /// Whether anything is at most zero.
    pub(crate) fn sign(tolerance: f64) -> Self {
        Self { tolerance, apart: 0.0, finest: tolerance, is_sign: true }
    }

    /// The separation of two bodies, which is twice the least value of the larger of their fields:
    /// bounds of that value are half as far apart.
    pub(crate) fn separation(limits: &Limits) -> Self {
        Self::least(0.5 * limits.tolerance)
    }

    /// The separation, if it is at most `margin`, which is to be decided.
    pub(crate) fn separation_within(margin: f64, limits: &Limits) -> Self {
        Self::least_within(0.5 * margin, 0.5 * limits.tolerance)
    }

    /// Whether two bodies overlap.
    pub(crate) fn overlap(limits: &Limits) -> Self {
        Self::sign(0.5 * limits.tolerance)
    }

    /// The same question, with bounds that are so much closer, as a share.
    pub(crate) fn finer(self, share: f64) -> Self {
        let beyond = 4.0 * (1.0 - share) * self.tolerance;
        Self {
            tolerance: share * self.tolerance,
            finest: share * self.finest,
            apart: self.apart + beyond,
            ..self
        }
    }

    /// `true` if a minimum of at most zero ends the search.
    pub(crate) fn is_sign(self) -> bool {
        self.is_sign
    }

    /// Cells with a lower bound from this on are closed.
    pub(crate) fn threshold(self, upper: f64) -> f64 {
        let tolerance = if upper > self.apart { self.finest } else { self.tolerance };
        (upper - tolerance).min(self.apart + self.apart * f64::EPSILON + f64::MIN_POSITIVE)
    }

    /// Places with values above this cannot matter, when the best value is `upper`.
    pub(crate) fn most(self, upper: f64) -> f64 {
        upper.min(self.apart + self.tolerance).max(0.0)
    }

    /// `true` if a best value of `upper` ends the search.
    pub(crate) fn is_hit(self, upper: f64) -> bool {
        self.is_sign && upper <= 0.0
    }

    /// Why to stop, if these bounds suffice.
    pub(crate) fn reached(self, lower: f64, upper: f64) -> Option<Stop> {
        if self.is_hit(upper) || lower > self.apart {
            return Some(Stop::SignKnown);
        }
        // The same rule as the one that closes cells, to the last bit: else a search could
        // close all cells and not be done.
        (lower >= self.threshold(upper)).then_some(Stop::Converged)
    }
}
