// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a word that JSON does not have may mean.

use serde::de::IgnoredAny;

use crate::names::shortened;

/// What is wrong with a word, and what to read in its place.
pub(super) struct Meant {
    pub(super) message: String,
    pub(super) value: String,
    /// `true` if the value is not surely what was meant.
    pub(super) is_guess: bool,
}

/// Parts of a metre.
const LENGTHS: [(&str, f64); 4] = [("mm", 1e3), ("cm", 1e2), ("um", 1e6), ("µm", 1e6)];

/// What a word may mean that stands where a value is wanted; `None` if JSON has it.
pub(super) fn meant(word: &str) -> Option<Meant> {
    if is_json(word) {
        return None;
    }
    let certain = |message: String, value: String| Meant { message, value, is_guess: false };
    let guess = |message: String, value: &str| {
        let value = value.to_owned();
        Meant { message, value, is_guess: true }
    };
    let shown = shortened(word);
    let lower = word.to_lowercase();
    Some(match lower.trim_start_matches(['+', '-']) {
        "true" | "false" => certain(format!("`{shown}` is written {lower}"), lower.clone()),
        "null" | "none" | "nil" | "undefined" => {
            guess(format!("`{shown}` is no value; leave the key out"), "null")
        }
        "nan" | "inf" | "infinity" => {
            guess(format!("`{shown}` is no number that JSON, or a scene, can have"), "0")
        }
        _ => {
            if let Some(number) = number(word) {
                certain(format!("the number `{shown}` is written {number}"), number)
            } else if let Some((number, unit)) = with_unit(word) {
                let factor = LENGTHS.iter().find(|(name, _)| *name == unit);
                let message = match factor {
                    Some((_, parts)) => {
                        let metres = number.parse::<f64>().unwrap_or(f64::NAN) / parts;
                        format!("`{shown}` has a unit; lengths are in metres: write {metres}")
                    }
                    None => format!("`{shown}` has a unit; write {number}"),
                };
                guess(message, number)
            } else {
                let quoted = serde_json::Value::from(word).to_string();
                certain(format!("the text `{shown}` stands without double quotes"), quoted)
            }
        }
    })
}

/// `true` if a word is a number or a literal of JSON.
pub(super) fn is_json(word: &str) -> bool {
    serde_json::from_str::<IgnoredAny>(word).is_ok()
}

/// The number that a word is in another spelling: hexadecimal, with a plus sign, with zeros too
/// many or too few, with underscores, or with another minus sign.
fn number(word: &str) -> Option<String> {
    let plain = word.replace('_', "").replace('−', "-");
    let (sign, digits) = match plain.strip_prefix(['+', '-']) {
        Some(digits) => (if plain.starts_with('-') { "-" } else { "" }, digits),
        None => ("", plain.as_str()),
    };
    if let Some(digits) = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        return u32::from_str_radix(digits, 16).ok().map(|number| format!("{sign}{number}"));
    }
    let digits = digits.trim_start_matches('0');
    let zero = if digits.starts_with(|c: char| c.is_ascii_digit()) { "" } else { "0" };
    let mut number = format!("{sign}{zero}{digits}");
    if let Some(point) = number.find('.') {
        let after = number.get(point + 1..).unwrap_or_default();
        if !after.starts_with(|c: char| c.is_ascii_digit()) {
            number.insert(point + 1, '0');
        }
    }
    is_json(&number).then_some(number)
}

/// A number and the unit behind it.
fn with_unit(word: &str) -> Option<(&str, &str)> {
    let end = word.rfind(|c: char| c.is_ascii_digit() || c == '.')? + 1;
    let (number, unit) = word.split_at(end);
    (is_json(number) && !unit.is_empty()).then_some((number, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_mean_what_they_may() {
        for (word, value) in [
            ("0x1F", "31"),
            ("007", "7"),
            ("+1.5", "1.5"),
            (".5", "0.5"),
            ("-.5", "-0.5"),
            ("5.", "5.0"),
            ("5.e3", "5.0e3"),
            ("1_000", "1000"),
            ("−2", "-2"),
            ("00", "0"),
            ("True", "true"),
            ("None", "null"),
            ("-Infinity", "0"),
            ("5mm", "5"),
            ("30°", "30"),
            ("ball", "\"ball\""),
        ] {
            assert_eq!(meant(word).unwrap().value, value, "{word}");
        }
        for word in ["1", "-0.5e3", "true", "null"] {
            assert!(meant(word).is_none(), "{word}");
        }
        let message = meant("25.4mm").unwrap().message;
        assert_eq!(message, "`25.4mm` has a unit; lengths are in metres: write 0.0254");
    }
}
