// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can be wrong with a shape's parameters.

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

/// Why a shape cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A number breaks the rule of its parameter.
    #[error("{parameter} must be {rule}, got {value}")]
    Number {
        /// The parameter's name, as in scene files.
        parameter: Cow<'static, str>,
        /// What it must be: "positive", "at most the radius 0.1 m".
        rule: Cow<'static, str>,
        /// What it was.
        value: Quantity,
    },
    /// A list is too short or too long.
    #[error("{parameter} must have {rule}, got {count}")]
    Count {
        /// The parameter's name, as in scene files.
        parameter: Cow<'static, str>,
        /// What it must have: "at least 3 points".
        rule: Cow<'static, str>,
        /// How many there were.
        count: usize,
    },
    /// Operators are nested too deeply.
    #[error("shapes are nested {depth} deep, at most {limit} are allowed")]
    TooDeep {
        /// The depth after nested unions were flattened.
        depth: usize,
        /// The largest depth allowed.
        limit: usize,
    },
    /// An operator needs something that its shape does not have.
    #[error("{operator} needs {needs}")]
    Unsuitable {
        /// The operator's name, as in scene files.
        operator: &'static str,
        /// What is missing: "a shape with bounds".
        needs: Cow<'static, str>,
    },
}

impl ShapeError {
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

const FINITE: &str = "finite and at most 1e15";

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
