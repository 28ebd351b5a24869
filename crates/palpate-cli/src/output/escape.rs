// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Escapes text from files for a terminal.
//!
//! A control character in a scene's name could move the cursor, and a bidirectional override
//! could reorder what a reader sees. Both are written as their numbers.

use std::borrow::Cow;

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
pub(crate) fn shown(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden, |c| c.escape_unicode().to_string())
}

/// As [`shown`], but line breaks stay.
pub(crate) fn shown_lines(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden_in_lines, |c| c.escape_unicode().to_string())
}

/// Equivalent JSON, each hidden character as its escape, such as `\u001b`. JSON that serde
/// writes has hidden characters only in strings.
pub(super) fn shown_json(json: &str) -> Cow<'_, str> {
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
