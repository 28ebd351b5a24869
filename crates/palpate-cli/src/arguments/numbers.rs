// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers on the command line, with the rules that they keep.

use std::fmt::Display;
use std::str::FromStr;

use palpate::field::LARGEST_LENGTH;

use palpate::scene::text::plain;

/// A positive number in `unit`.
pub(crate) fn positive(
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| ruled(text, "positive and finite", unit, |x| x > 0.0 && x.is_finite())
}

/// A number of zero or more in `unit`.
pub(crate) fn zero_or_more(
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| ruled(text, "zero or more and finite", unit, |x| x >= 0.0 && x.is_finite())
}

/// A positive length [m].
pub(crate) fn length(text: &str) -> Result<f64, String> {
    let rule = format!("positive and at most {LARGEST_LENGTH:e} m");
    ruled(text, &rule, "m", |x| x > 0.0 && x <= LARGEST_LENGTH)
}

/// A length of zero or more [m].
pub(crate) fn length_or_zero(text: &str) -> Result<f64, String> {
    let rule = format!("zero or more and at most {LARGEST_LENGTH:e} m");
    ruled(text, &rule, "m", |x| (0.0..=LARGEST_LENGTH).contains(&x))
}

/// A coordinate [m].
pub(crate) fn coordinate(text: &str) -> Result<f64, String> {
    let rule = format!("finite and at most {LARGEST_LENGTH:e} m in size");
    ruled(text, &rule, "m", |x| x.abs() <= LARGEST_LENGTH)
}

/// A number from `least` to `most` in `unit`.
pub(crate) fn within(
    least: f64,
    most: f64,
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| {
        let rule = format!("from {} to {}{}{unit}", plain(least), plain(most), space(unit));
        ruled(text, &rule, unit, |x| (least..=most).contains(&x))
    }
}

/// A whole number from `least` to `most`.
pub(crate) fn count<T>(
    least: T,
    most: T,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    move |text| {
        let count = text.trim().parse().ok().filter(|count| (least..=most).contains(count));
        count
            .ok_or_else(|| format!("must be a whole number from {least} to {most}, got {text}"))
    }
}

/// A number that keeps a rule, which is written so that NaN does not.
fn ruled(
    text: &str,
    rule: &str,
    unit: &str,
    is_kept: impl Fn(f64) -> bool,
) -> Result<f64, String> {
    let Ok(number) = text.trim().parse::<f64>() else {
        let point = text.trim().replacen(',', ".", 1);
        let is_comma = text.contains(',') && point.parse::<f64>().is_ok();
        let comma =
            if is_comma { &format!("; a decimal comma is written {point}") } else { "" };
        return Err(format!("must be a number{comma}"));
    };
    if is_kept(number) {
        return Ok(number);
    }
    Err(format!("must be {rule}, got {}{}{unit}", plain(number), space(unit)))
}

/// What stands between a number and its unit.
fn space(unit: &str) -> &'static str {
    if unit.is_empty() { "" } else { " " }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_rules() {
        assert_eq!(positive("s")("1.5"), Ok(1.5));
        assert_eq!(length_or_zero("0"), Ok(0.0));
        assert_eq!(count(1, 9)("9"), Ok(9));
        for (refused, message) in [
            (positive("s")("-1").map(drop), "must be positive and finite, got -1 s"),
            (positive("")("NaN").map(drop), "must be positive and finite, got NaN"),
            (zero_or_more("N")("inf").map(drop), "must be zero or more and finite, got inf N"),
            (length("2e15").map(drop), "must be positive and at most 1e15 m, got 2e15 m"),
            (length("0,5").map(drop), "must be a number; a decimal comma is written 0.5"),
            (
                within(-90.0, 90.0, "degrees")("nan").map(drop),
                "must be from -90 to 90 degrees, got NaN degrees",
            ),
            (coordinate("x").map(drop), "must be a number"),
            (count(1, 9)("10").map(drop), "must be a whole number from 1 to 9, got 10"),
            (count(1, 9)("0.5").map(drop), "must be a whole number from 1 to 9, got 0.5"),
        ] {
            assert_eq!(refused, Err(message.to_owned()));
        }
    }
}
