// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The rules of plain numbers, with their units.

use crate::problem::Problem;

/// The version of a format, of which one is read.
pub(crate) fn version(key: &str, got: u64, read: u64) -> Result<(), Problem> {
    if got == read {
        return Ok(());
    }
    Err(Problem::about(format!("must be {read}, got {got}")).under(key))
}

/// Checks that `value` is finite and at least `least`.
pub(crate) fn at_least(key: &str, value: f64, least: f64, unit: &str) -> Result<(), Problem> {
    // Written so that NaN fails.
    if value >= least && value.is_finite() {
        return Ok(());
    }
    let rule = if least == 0.0 { "zero or more".into() } else { format!("at least {least}") };
    refused(key, &rule, value, unit)
}

/// Checks that `value` is finite and positive.
pub(crate) fn positive(key: &str, value: f64, unit: &str) -> Result<(), Problem> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    refused(key, "positive", value, unit)
}

/// Checks that `value` is positive, if it is there.
pub(crate) fn positive_if(key: &str, value: Option<f64>, unit: &str) -> Result<(), Problem> {
    value.map_or(Ok(()), |value| positive(key, value, unit))
}

fn refused(key: &str, rule: &str, value: f64, unit: &str) -> Result<(), Problem> {
    let space = if unit.is_empty() { "" } else { " " };
    let finite = if value.is_infinite() { " and finite" } else { "" };
    Err(Problem::about(format!("must be {rule}{finite}, got {value}{space}{unit}")).under(key))
}

/// Checks that `value`, if it is given, is a part of a whole: more than 0 and at most 1.
pub(crate) fn part_if(key: &str, value: Option<f64>) -> Result<(), Problem> {
    match value {
        // Written so that NaN fails.
        Some(part) if !(part > 0.0 && part <= 1.0) => {
            refused(key, "more than 0 and at most 1", part, "")
        }
        _ => Ok(()),
    }
}

/// `true` if `value` is the default of its key, which is then left out.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
