// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers with their bounds.

use crate::error::{QueryError, check_length};

/// The answer of a search: the true value lies in `[lower, upper]`, rounding included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certified<T> {
    /// The best point or contact that was found.
    pub best: T,
    /// Proven lower bound [m].
    pub lower: f64,
    /// Upper bound, attained at `best` [m].
    pub upper: f64,
    /// Why the search stopped.
    pub stop: Stop,
    /// How often fields were evaluated; a gradient counts twice.
    pub evaluations: u32,
}

impl<T> Certified<T> {
    /// `true` if the value is proven to be at most zero, `false` if it is proven to be
    /// positive; `None` if the search stopped before either was proven.
    #[must_use]
    pub fn is_hit(&self) -> Option<bool> {
        if self.upper <= 0.0 {
            Some(true)
        } else if self.lower > 0.0 {
            Some(false)
        } else {
            None
        }
    }
}

/// Why a search stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The bounds are no farther apart than the tolerance.
    Converged,
    /// The sign of the value is proven, or that it exceeds the largest value asked for.
    SignKnown,
    /// The budget of evaluations or the room of the workspace ended first.
    BudgetSpent,
}

/// When a search may stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// How far apart the bounds may be [m].
    pub tolerance: f64,
    /// The most evaluations, but for those of the round that reaches it.
    pub budget: u32,
}

impl Limits {
    /// Refuses a tolerance that is negative, no number or too large.
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        check_length(self.tolerance)
    }
}

impl Default for Limits {
    /// A tolerance of 0.1 mm, and 200 000 evaluations.
    fn default() -> Self {
        Self { tolerance: 1e-4, budget: 200_000 }
    }
}
