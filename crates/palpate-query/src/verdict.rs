// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether two bodies touch.

use std::fmt;

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
