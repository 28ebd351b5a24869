// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A number that breaks the rule of its parameter.

use std::fmt;

/// A number that breaks the rule of its parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{parameter} must be {rule}, got {}{}{unit}",
    Short(*value),
    if unit.is_empty() { "" } else { " " }
)]
#[non_exhaustive]
pub struct NumberError {
    /// The parameter's name, as in scene files.
    pub parameter: &'static str,
    /// What it must be: "positive".
    pub rule: &'static str,
    /// What it was, in `unit`.
    pub value: f64,
    /// The unit of the parameter: "N/m"; empty for a plain number.
    pub unit: &'static str,
}

/// A number as messages show it: with an exponent if it has many zeros.
///
/// ```
/// use palpate_device::Short;
///
/// assert_eq!(format!("{} {}", Short(2.5), Short(1e-9)), "2.5 1e-9");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Short(
    /// The number.
    pub f64,
);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (number, size) = (self.0, self.0.abs());
        if size > 0.0 && size < 1e-6 || (1e15..f64::INFINITY).contains(&size) {
            write!(f, "{number:e}")
        } else {
            write!(f, "{number}")
        }
    }
}

impl NumberError {
    /// The error that `parameter` must be `rule`, but is `value` in this unit.
    ///
    /// ```
    /// use palpate_device::NumberError;
    ///
    /// let error = NumberError::new("teeth", "at least 3", 2.0, "");
    /// assert_eq!(error.to_string(), "teeth must be at least 3, got 2");
    /// ```
    #[must_use]
    pub const fn new(
        parameter: &'static str,
        rule: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Self {
        Self { parameter, rule, value, unit }
    }

    /// Checks that `value` is positive and finite.
    ///
    /// # Errors
    ///
    /// The error with the name and the unit given, also for NaN.
    ///
    /// ```
    /// use palpate_device::NumberError;
    ///
    /// assert_eq!(NumberError::check_positive("mass", 0.1, "kg"), Ok(0.1));
    /// let error = NumberError::check_positive("mass", -1.0, "kg").unwrap_err();
    /// assert_eq!(error.to_string(), "mass must be positive and finite, got -1 kg");
    /// ```
    pub fn check_positive(
        parameter: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<f64, Self> {
        // Written so that NaN fails.
        if value > 0.0 && value <= f64::MAX {
            Ok(value)
        } else {
            let rule = "positive and finite";
            Err(Self { parameter, rule, value, unit })
        }
    }

    /// Checks that `value` is not negative and finite.
    ///
    /// # Errors
    ///
    /// As [`check_positive`](Self::check_positive).
    pub fn check_not_negative(
        parameter: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<f64, Self> {
        if (0.0..=f64::MAX).contains(&value) {
            Ok(value)
        } else {
            let rule = "zero or more and finite";
            Err(Self { parameter, rule, value, unit })
        }
    }

    /// Checks that a rate [Hz] is from 1e-6 to 1e9, so that a clock can count its period.
    ///
    /// # Errors
    ///
    /// If it is outside, or NaN.
    pub fn check_rate(rate: f64) -> Result<f64, Self> {
        if (1e-6..=1e9).contains(&rate) {
            Ok(rate)
        } else {
            Err(Self { parameter: "rate", rule: "from 1e-6 to 1e9", value: rate, unit: "Hz" })
        }
    }

    /// Checks that `value` is not negative; it may be infinite.
    ///
    /// # Errors
    ///
    /// If it is negative or NaN.
    pub fn check_zero_or_more(
        parameter: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<f64, Self> {
        // Written so that NaN fails.
        if value >= 0.0 {
            Ok(value)
        } else {
            let rule = "zero or more";
            Err(Self { parameter, rule, value, unit })
        }
    }

    /// Checks that `value` is positive; it may be infinite.
    ///
    /// # Errors
    ///
    /// As [`check_positive`](Self::check_positive).
    pub fn check_positive_or_infinite(
        parameter: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<f64, Self> {
        // Written so that NaN fails.
        if value > 0.0 {
            Ok(value)
        } else {
            let rule = "positive";
            Err(Self { parameter, rule, value, unit })
        }
    }
}
