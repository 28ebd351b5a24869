// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors of shapes, and the limits of parameters.

use std::borrow::Cow;
use std::fmt;

/// The unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Metres.
    Metre,
    /// Radians.
    Radian,
    /// A pure number.
    One,
}

impl Unit {
    /// The symbol that follows a number: `"m"`, `"rad"` or nothing.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Radian => "rad",
            Self::One => "",
        }
    }
}

/// A number with its unit, as messages show it: `-0.02 m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity(pub f64, pub Unit);

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size.is_finite() && size != 0.0 && !(1e-6..1e16).contains(&size) {
            write!(f, "{:e}", self.0)?;
        } else {
            write!(f, "{}", self.0)?;
        }
        match self.1.symbol() {
            "" => Ok(()),
            symbol => write!(f, " {symbol}"),
        }
    }
}

/// What kind of [`ShapeError`] an error is, for callers that map kinds to something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ShapeErrorKind {
    /// A number breaks the rule of its parameter.
    Number,
    /// A list is too short or too long.
    Count,
    /// Operators are nested too deeply.
    TooDeep,
    /// An operator needs something that its shape does not have.
    Unsuitable,
}

impl ShapeErrorKind {
    /// The name of the kind, which stays the same: `"number"`, `"count"`, `"too_deep"` or
    /// `"unsuitable"`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Number => "number",
            Self::Count => "count",
            Self::TooDeep => "too_deep",
            Self::Unsuitable => "unsuitable",
        }
    }
}

/// Why a shape cannot be built; the fields say it as data.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number breaks the rule of its parameter.
    #[error("{parameter} must be {rule}, got {value}")]
    Number {
        /// The parameter's name, as in scene files.
        parameter: Cow<'static, str>,
        /// The rule: "positive", "at most the radius 0.1 m".
        rule: Cow<'static, str>,
        /// The number given.
        value: Quantity,
    },
    /// A matrix mirrors, and is given as a rotation.
    #[error(
        "{parameter} must not mirror: the matrix is a reflection, with determinant -1; palpate is \
         right-handed, so mirror one axis of a left-handed frame before, for instance in the \
         device's driver"
    )]
    Reflection {
        /// The parameter's name, as in scene files.
        parameter: &'static str,
    },
    /// A list is too short or too long.
    #[error("{parameter} must have {rule}, got {count}")]
    Count {
        /// The parameter's name, as in scene files.
        parameter: Cow<'static, str>,
        /// The rule: "at least 3 points".
        rule: Cow<'static, str>,
        /// The number of items given.
        count: usize,
    },
    /// Operators are nested too deeply.
    #[error("shapes are nested {depth} deep, at most {limit} are allowed")]
    TooDeep {
        /// The depth, after nested booleans were flattened.
        depth: usize,
        /// The largest depth allowed.
        limit: usize,
    },
    /// An operator needs something that its shape does not have.
    #[error("{operator} needs {needs}")]
    Unsuitable {
        /// The operator's name, as in scene files.
        operator: &'static str,
        /// The missing property: "a shape with bounds".
        needs: Cow<'static, str>,
    },
}

impl ShapeError {
    /// The kind of the error.
    ///
    /// ```
    /// use palpate_field::{Quantity, Shape, ShapeError, ShapeErrorKind, Unit};
    ///
    /// let error = Shape::sphere(-0.02).unwrap_err();
    /// assert_eq!(error.kind(), ShapeErrorKind::Number);
    /// let ShapeError::Number { parameter, rule, value, .. } = error else { unreachable!() };
    /// assert_eq!((&*parameter, &*rule), ("radius", "positive"));
    /// assert_eq!(value, Quantity(-0.02, Unit::Metre));
    /// ```
    #[must_use]
    pub const fn kind(&self) -> ShapeErrorKind {
        match self {
            Self::Number { .. } | Self::Reflection { .. } => ShapeErrorKind::Number,
            Self::Count { .. } => ShapeErrorKind::Count,
            Self::TooDeep { .. } => ShapeErrorKind::TooDeep,
            Self::Unsuitable { .. } => ShapeErrorKind::Unsuitable,
        }
    }

    /// `parameter` breaks `rule`.
    pub fn number(
        parameter: impl Into<Cow<'static, str>>,
        rule: impl Into<Cow<'static, str>>,
        value: f64,
        unit: Unit,
    ) -> Self {
        Self::Number {
            parameter: parameter.into(),
            rule: rule.into(),
            value: Quantity(value, unit),
        }
    }
}

/// The largest coordinate or length accepted [m]: beyond, squares of lengths
/// would lose the range of single precision.
pub const LARGEST_LENGTH: f64 = 1e15;

/// The smallest positive length accepted [m]: below, squares of lengths would
/// lose the range of single precision.
pub const SMALLEST_LENGTH: f64 = 1e-15;

const FINITE: &str = "finite and at most 1e15 in size";

/// Checks that `value` is finite and positive.
#[inline]
pub(crate) fn positive(
    parameter: &'static str,
    value: f64,
    unit: Unit,
) -> Result<f64, ShapeError> {
    // Written so that NaN fails.
    if (SMALLEST_LENGTH..=LARGEST_LENGTH).contains(&value) {
        Ok(value)
    } else {
        Err(out_of_range(parameter, "positive", value, unit))
    }
}

/// Checks that `value` is finite and not negative.
#[inline]
pub(crate) fn not_negative(
    parameter: &'static str,
    value: f64,
    unit: Unit,
) -> Result<f64, ShapeError> {
    if (0.0..=LARGEST_LENGTH).contains(&value) {
        Ok(value)
    } else {
        Err(out_of_range(parameter, "zero or more", value, unit))
    }
}

/// Checks that `value` is finite.
#[inline]
pub(crate) fn finite(
    parameter: &'static str,
    value: f64,
    unit: Unit,
) -> Result<f64, ShapeError> {
    if value.abs() <= LARGEST_LENGTH {
        Ok(value)
    } else {
        Err(out_of_range(parameter, FINITE, value, unit))
    }
}

/// Apart, so that the checks are short where they are inlined.
#[cold]
fn out_of_range(
    parameter: &'static str,
    rule: &'static str,
    value: f64,
    unit: Unit,
) -> ShapeError {
    let rule = if value > LARGEST_LENGTH {
        FINITE
    } else if value > 0.0 {
        "at least 1e-15"
    } else {
        rule
    };
    ShapeError::number(parameter, rule, value, unit)
}
