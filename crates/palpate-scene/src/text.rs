// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers and names in reports for people.
//!
//! A control character in a scene's name could move the cursor, and a bidirectional override
//! could reorder what a reader sees. [`shown`] writes both as their numbers.

use std::borrow::Cow;
use std::fmt;

/// Numbers smaller than this are written with an exponent.
const SMALL: f64 = 1e-6;

/// Numbers of this size and larger ones are written with an exponent.
const LARGE: f64 = 1e15;

/// A number with all its digits, which are few even if it is very large or very small.
#[must_use]
pub fn plain(number: f64) -> String {
    let size = number.abs();
    let is_long = size >= LARGE && size.is_finite() || size > 0.0 && size < SMALL;
    if is_long { format!("{number:e}") } else { number.to_string() }
}

/// A number with four significant digits.
#[must_use]
pub fn rounded(number: f64) -> String {
    let size = number.abs();
    if size < f64::MIN_POSITIVE {
        return "0".to_owned();
    }
    if !number.is_finite() {
        return number.to_string();
    }
    if !(SMALL..LARGE).contains(&size) {
        let text = format!("{number:.3e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", without_zeros(digits));
    }
    let digits = 3 - size.log10().floor() as i32;
    let unit = 10.0_f64.powi(-digits);
    let text = format!("{:.*}", digits.max(0) as usize, (number / unit).round() * unit);
    without_zeros(&text).to_owned()
}

/// Numbers with so many decimals.
#[must_use]
pub fn decimals(numbers: &[f64], digits: usize) -> String {
    numbers.iter().map(|&x| decimal(x, digits)).collect::<Vec<_>>().join(", ")
}

/// A number with so many decimals, without a sign if they are all zero.
#[must_use]
pub fn decimal(number: f64, digits: usize) -> String {
    let text = format!("{number:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_owned(),
        _ => text,
    }
}

/// A decimal without the zeros at its end.
fn without_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A number with the digits that an error leaves: the last stands below the error's first, and
/// there are seven at most. Small ones have an exponent where [`rounded`] ones have it.
#[must_use]
pub fn measured(number: f64, error: f64) -> String {
    const MOST: i32 = 6;
    let place = |x: f64| x.abs().log10().floor() as i32;
    let first = place(number);
    let digits = if error > 0.0 {
        first.saturating_sub(place(error)).saturating_add(1).min(MOST)
    } else {
        MOST
    };
    if digits < 0 || number.abs() < f64::MIN_POSITIVE {
        return "0".to_owned();
    }
    match usize::try_from(digits - first) {
        Ok(decimals) if first < 6 && number.abs() >= SMALL => format!("{number:.decimals$}"),
        _ => format!("{number:.*e}", digits as usize),
    }
}

/// A count with its noun: "1 body", "2 bodies".
#[must_use]
pub fn counted<N>(count: N, one: &str, many: &str) -> String
where
    N: fmt::Display + PartialEq + From<u8>,
{
    let noun = if count == N::from(1) { one } else { many };
    format!("{count} {noun}")
}

/// Numbers with all their digits, joined by commas.
#[must_use]
pub fn joined(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}

/// `true` for characters that change how a terminal shows others.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            // Marks, embeddings, overrides and isolates of bidirectional text; separators of
            // lines and paragraphs.
            '\u{061c}'
                | '\u{200e}'
                | '\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2066}'..='\u{2069}'
        )
}

/// `text` on one line, each hidden character as its number, such as `\u{1b}`.
#[must_use]
pub fn shown(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden, |c| c.escape_unicode().to_string())
}

/// As [`shown`], but line breaks stay.
#[must_use]
pub fn shown_lines(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden_in_lines, |c| c.escape_unicode().to_string())
}

/// Equivalent JSON, each hidden character as its escape, such as `\u001b`. JSON that serde
/// writes has hidden characters only in strings.
#[must_use]
pub fn shown_json(json: &str) -> Cow<'_, str> {
    replaced(json, is_hidden_in_lines, |c| format!("\\u{:04x}", u32::from(c)))
}

fn is_hidden_in_lines(c: char) -> bool {
    c != '\n' && is_hidden(c)
}

fn replaced(
    text: &str,
    is_hidden: fn(char) -> bool,
    escaped: impl Fn(char) -> String,
) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) {
            shown.push_str(&escaped(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_a_reader_needs() {
        for (number, all, four) in [
            (0.0, "0", "0"),
            (-0.25, "-0.25", "-0.25"),
            (1234.5678, "1234.5678", "1235"),
            (0.012_345, "0.012345", "0.01235"),
            (2e15, "2e15", "2e15"),
            (1.234_56e30, "1.23456e30", "1.235e30"),
            (-1e-9, "-1e-9", "-1e-9"),
            (f64::INFINITY, "inf", "inf"),
        ] {
            assert_eq!((plain(number), rounded(number)), (all.to_owned(), four.to_owned()));
        }
    }

    #[test]
    fn no_digit_stands_far_below_the_error() {
        for (number, error, text) in [
            (4.185_366e-6, 4.1e-9, "0.0000041854"),
            (3.4e-5, 1.2e-6, "0.0000340"),
            (4.185_366e-7, 4.1e-10, "4.1854e-7"),
            (0.5, 1e-5, "0.500000"),
            (5994.08, 5.9, "5994.1"),
            (5994.08, 590.0, "5.99e3"),
            (4.4e-25, 4.6e-10, "0"),
            (2.0, 3.0, "2.0"),
            (1.0 / 3.0, 1e-30, "0.3333333"),
            (1.0 / 3.0, 0.0, "0.3333333"),
            (-0.0, 1e-3, "0"),
            (1.5, f64::INFINITY, "0"),
        ] {
            assert_eq!(measured(number, error), text, "{number} ± {error}");
        }
    }

    /// An escape for red, a line break, a right-to-left override, the one-byte escape of C1,
    /// and characters that stay.
    const HOSTILE: &str = "a\u{1b}[31mb\nc\u{202e}d\u{9b}e – é";

    #[test]
    fn hidden_characters_are_shown_by_their_numbers() {
        assert_eq!(shown(HOSTILE), r"a\u{1b}[31mb\u{a}c\u{202e}d\u{9b}e – é");
        assert_eq!(shown_lines(HOSTILE), "a\\u{1b}[31mb\nc\\u{202e}d\\u{9b}e – é");
        assert!(matches!(shown("plain – é"), Cow::Borrowed(_)));
    }

    #[test]
    fn escaped_json_says_the_same() {
        let value = serde_json::json!({ "name": HOSTILE });
        let plain = format!("{value:#}");
        let shown = shown_json(&plain);
        assert!(!shown.contains(['\u{1b}', '\u{202e}', '\u{9b}']), "{shown}");
        assert!(shown.contains(r"\u202e") && shown.contains(r"\u009b"), "{shown}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), value);
    }
}
