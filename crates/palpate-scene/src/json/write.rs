// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pretty JSON: short lists and objects on one line, numbers as people write
//! them.

use serde_json::{Number, Value};

/// What fits on a line, indentation included.
const WIDTH: usize = 96;

/// The text of `value`, with a newline at its end.
pub(crate) fn write(value: &Value) -> String {
    let mut text = String::new();
    pretty(value, 0, 0, &mut text);
    text.push('\n');
    text
}

/// Writes `value` where `column` characters of the line are taken.
fn pretty(value: &Value, indent: usize, column: usize, text: &mut String) {
    let start = text.len();
    if compact(value, WIDTH.saturating_sub(column), text).is_some() {
        return;
    }
    text.truncate(start);
    let inner = indent + 2;
    let (open, close, count) = match value {
        Value::Array(elements) => ('[', ']', elements.len()),
        Value::Object(entries) => ('{', '}', entries.len()),
        scalar => return push_scalar(scalar, text),
    };
    text.push(open);
    let mut next = |i: usize, key: Option<&String>, element: &Value| {
        text.push('\n');
        text.push_str(&" ".repeat(inner));
        let mut column = inner + 1;
        if let Some(key) = key {
            let before = text.len();
            push_string(key, text);
            text.push_str(": ");
            column += text.len() - before;
        }
        pretty(element, inner, column, text);
        if i + 1 < count {
            text.push(',');
        }
    };
    match value {
        Value::Array(elements) => {
            elements.iter().enumerate().for_each(|(i, e)| next(i, None, e));
        }
        Value::Object(entries) => {
            entries.iter().enumerate().for_each(|(i, (key, e))| next(i, Some(key), e));
        }
        _ => {}
    }
    text.push('\n');
    text.push_str(&" ".repeat(indent));
    text.push(close);
}

/// Writes `value` on one line of at most `room` characters; `None` if it does
/// not fit.
fn compact(value: &Value, room: usize, text: &mut String) -> Option<()> {
    let end = text.len() + room;
    match value {
        Value::Array(elements) => {
            text.push('[');
            for (i, element) in elements.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { ", " });
                compact(element, end.checked_sub(text.len())?, text)?;
            }
            text.push(']');
        }
        Value::Object(entries) if entries.is_empty() => text.push_str("{}"),
        Value::Object(entries) => {
            text.push_str("{ ");
            for (i, (key, element)) in entries.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { ", " });
                push_string(key, text);
                text.push_str(": ");
                compact(element, end.checked_sub(text.len())?, text)?;
            }
            text.push_str(" }");
        }
        scalar => push_scalar(scalar, text),
    }
    (text.len() <= end).then_some(())
}

fn push_scalar(value: &Value, text: &mut String) {
    match value {
        Value::String(string) => push_string(string, text),
        Value::Number(number) => push_number(number, text),
        other => text.push_str(&other.to_string()),
    }
}

fn push_string(string: &str, text: &mut String) {
    text.push_str(&Value::from(string).to_string());
}

fn push_number(number: &Number, text: &mut String) {
    if number.is_f64() {
        text.push_str(&decimal(number.as_f64().unwrap_or_default()));
    } else {
        text.push_str(&number.to_string());
    }
}

/// The shortest decimal that reads back as `x`, without an exponent unless it
/// would be long.
fn decimal(x: f64) -> String {
    if x == 0.0 || (1e-6..1e15).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_bit_for_bit() {
        for (x, text) in
            [(800.0, "800"), (-0.0, "-0"), (0.1, "0.1"), (1e-7, "1e-7"), (2.5e20, "2.5e20")]
        {
            assert_eq!(decimal(x), text);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits());
        }
    }

    #[test]
    fn what_is_short_stays_on_a_line() {
        let value = serde_json::json!({ "a": [1, 2.0, 3.5], "b": "x".repeat(90) });
        let text = write(&value);
        assert!(text.starts_with("{\n  \"a\": [1, 2, 3.5],\n  \"b\": \"xxx"), "{text}");
    }
}
