// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How precise the answers of a query are.

/// How far apart the bounds of an answer may be.
///
/// ```
/// use palpate_query::Tolerance;
///
/// assert_eq!(Tolerance::default(), Tolerance::Relative(1e-4));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tolerance {
    /// As a share of the size of the smaller body: the diagonal of its box, the length of a
    /// ray, the diameter of a ball. Unbounded bodies have no size; where neither body has
    /// one, the tolerance is zero.
    Relative(f64),
    /// As a length [m].
    Absolute(f64),
}

impl Tolerance {
    /// The tolerance [m] for a smaller body of this size [m].
    #[must_use]
    pub fn for_size(self, size: f64) -> f64 {
        match self {
            Self::Relative(share) => share * size,
            Self::Absolute(length) => length,
        }
    }
}

impl Default for Tolerance {
    /// A ten-thousandth of the smaller body: below what is seen or felt of it.
    fn default() -> Self {
        Self::Relative(1e-4)
    }
}
