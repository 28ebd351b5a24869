// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers with their bounds.

use crate::error::QueryError;

/// The answer of a search: the true value lies in `[lower, upper]`, rounding included.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// The same bounds of another description of the best that was found.
    #[must_use]
    pub fn map<U>(self, describe: impl FnOnce(T) -> U) -> Certified<U> {
        let Self { best, lower, upper, stop, evaluations } = self;
        Certified { best: describe(best), lower, upper, stop, evaluations }
    }

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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Stop {
    /// The bounds are no farther apart than the tolerance.
    Converged,
    /// The sign of the value is proven, or the value is proven to exceed the margin.
    SignKnown,
    /// The budget of evaluations ended first: a larger one may help.
    BudgetSpent,
    /// The room of the workspace ended first: a larger budget does not help, a larger tolerance or
    /// more [room](crate::PairWorkspace::with_room) may.
    MemoryFull,
    /// Rounding allows no closer bounds.
    RoundingReached,
}

impl Stop {
    /// `true` if the search ended before its question was answered; its bounds hold all the same.
    #[must_use]
    pub fn is_early(self) -> bool {
        match self {
            Self::Converged | Self::SignKnown => false,
            Self::BudgetSpent | Self::MemoryFull | Self::RoundingReached => true,
        }
    }
}

/// How far a search goes: to a tolerance, and to a budget of evaluations at most.
///
/// A length has no good default, so that there is none; [`Query`](crate::Query) takes the
/// tolerance from the bodies.
///
/// ```
/// use palpate_query::Limits;
///
/// let limits = Limits::new(1e-4).with_budget(1000);
/// assert_eq!((limits.tolerance, limits.budget), (1e-4, 1000));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// How far apart the bounds may be at the end [m].
    pub tolerance: f64,
    /// Evaluation limit; the last round may exceed it.
    pub budget: u32,
}

impl Limits {
    /// The budget unless another is given. With a tenth of it, 8 in 1000 poses of thin and
    /// long bodies stop before 0.1 mm; with half of it, 1 in 1000.
    pub const BUDGET: u32 = 200_000;

    /// A tolerance [m], with [`Limits::BUDGET`].
    #[must_use]
    pub const fn new(tolerance: f64) -> Self {
        Self { tolerance, budget: Self::BUDGET }
    }

    /// The same limits with another tolerance [m].
    #[must_use]
    pub const fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The same limits with another budget.
    #[must_use]
    pub const fn with_budget(self, budget: u32) -> Self {
        Self { budget, ..self }
    }

    /// Refuses a tolerance that is negative, NaN or too large.
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        QueryError::check_length(self.tolerance)
    }
}
