// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers with bounds: what a search is for, when it stops, what it proves.

use std::fmt;

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
    /// Bounds leave open whether bodies touch in places far from all contacts that were found: a smaller
    /// spacing may tell.
    Unresolved,
}

impl Stop {
    /// `true` if the search ended before its question was answered; its bounds hold all the same.
    #[must_use]
    pub fn is_early(self) -> bool {
        match self {
            Self::Converged | Self::SignKnown => false,
            Self::BudgetSpent | Self::MemoryFull | Self::RoundingReached | Self::Unresolved => {
                true
            }
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

    /// The same limits with the budget that is left.
    pub(crate) const fn less(self, spent: u32) -> Self {
        self.with_budget(self.budget.saturating_sub(spent))
    }

    /// Refuses a tolerance that is negative, NaN or too large.
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        QueryError::check_length(self.tolerance)
    }
}

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

/// Whether two bodies touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// Their distance is proven to be at most the margin.
    Touching,
    /// Their distance is proven to be more than the margin.
    Apart,
    /// The margin lies between the bounds: the search ended early, the distance is so near the
    /// margin that the tolerance does not tell, the fields are bounds that do not tell how far the
    /// surfaces are apart, or neither body is bounded.
    Undecided,
}

impl Verdict {
    /// What bounds of a distance [m], the lower and the upper one, prove up to `margin` [m].
    ///
    /// ```
    /// use palpate_query::Verdict;
    ///
    /// let verdict = |lower, upper| Verdict::of_bounds([lower, upper], 0.5);
    /// assert_eq!(verdict(0.25, 0.5), Verdict::Touching);
    /// assert_eq!(verdict(0.625, 0.75), Verdict::Apart);
    /// assert_eq!(verdict(0.5, 0.625), Verdict::Undecided);
    /// ```
    #[must_use]
    pub fn of_bounds([lower, upper]: [f64; 2], margin: f64) -> Self {
        if lower > margin {
            Self::Apart
        } else if upper <= margin {
            Self::Touching
        } else {
            // Also where the bound that would decide is NaN.
            Self::Undecided
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Touching => "touching",
            Self::Apart => "apart",
            Self::Undecided => "undecided",
        })
    }
}
