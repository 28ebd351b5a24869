// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A JSON text, checked and with the place of everything in it.

use jsonc_parser::ast::{ObjectProp, Value};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use serde::de::{DeserializeOwned, IgnoredAny};

use super::deserialize::Node;
use crate::error::SceneError;
use crate::problem::{Problem, Step};

/// How deep objects and lists may nest: what two of them for each of the 64
/// levels of a shape need, twice over. Deeper ones could exhaust the stack.
const DEEPEST: usize = 250;

/// A place in a text, in characters from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Position {
    pub(crate) line: usize,
    pub(crate) column: usize,
}

impl Position {
    fn of_byte(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.bytes().filter(|b| *b == b'\n').count() + 1,
            column: before.get(line_start..).map_or(0, |line| line.chars().count()) + 1,
        }
    }
}

/// A JSON text and its tree.
pub(crate) struct Document<'a> {
    text: &'a str,
    root: Value<'a>,
}

impl<'a> Document<'a> {
    /// Reads one JSON value, strictly.
    pub(crate) fn parse(text: &'a str) -> Result<Self, SceneError> {
        // serde_json judges the grammar; the other parser, made for JSON with
        // comments, is more tolerant of odd whitespace and control characters.
        if let Err(error) = serde_json::from_str::<IgnoredAny>(text) {
            let full = error.to_string();
            let end = full.rfind(" at line ").unwrap_or(full.len());
            return Err(SceneError {
                path: String::new(),
                line: error.line(),
                column: error.column(),
                problem: format!("not JSON: {}", full.get(..end).unwrap_or(&full)),
            });
        }
        let at = |message: String, byte| {
            Problem::new(message).located(Some(Position::of_byte(text, byte)))
        };
        if let Some((depth, byte)) = too_deep(text) {
            let message = format!(
                "objects and lists are nested {depth} deep, at most {DEEPEST} are allowed"
            );
            return Err(at(message, byte));
        }
        let options = CollectOptions::default();
        let parsed = parse_to_ast(text, &options, &STRICT)
            .map_err(|error| at(format!("not JSON: {}", error.kind()), error.range().start))?;
        match parsed.value {
            Some(root) => Ok(Self { text, root }),
            None => Err(at("not JSON: nothing there".into(), 0)),
        }
    }

    /// The text deserialised as a `T`.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, Problem> {
        T::deserialize(Node(&self.root))
    }

    /// `problem` with the place of the deepest value on its path.
    pub(crate) fn locate(&self, problem: Problem) -> SceneError {
        let mut place = self.root.range().start;
        let mut value = Some(&self.root);
        for step in problem.steps() {
            let next = match (step, value) {
                (Step::Key(key), Some(Value::Object(object))) => object
                    .properties
                    .iter()
                    // Of duplicates the last is the one too many.
                    .rfind(|property| name(property) == key)
                    .map(|property| (property.range.start, &property.value)),
                (Step::Index(index), Some(Value::Array(array))) => {
                    array.elements.get(*index).map(|element| (element.range().start, element))
                }
                _ => None,
            };
            match next {
                Some((start, inner)) => (place, value) = (start, Some(inner)),
                None => break,
            }
        }
        problem.located(Some(Position::of_byte(self.text, place)))
    }
}

/// The key of a property.
pub(super) fn name<'a>(property: &'a ObjectProp<'_>) -> &'a str {
    property.name.as_str()
}

/// JSON and nothing else.
const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// The greatest depth of a JSON text and where [`DEEPEST`] is first passed, if
/// it is.
fn too_deep(text: &str) -> Option<(usize, usize)> {
    let (mut depth, mut greatest, mut place) = (0_usize, 0, None);
    let mut bytes = text.bytes().enumerate();
    while let Some((i, byte)) = bytes.next() {
        match byte {
            b'"' => {
                while let Some((_, inner)) = bytes.next() {
                    match inner {
                        b'\\' => drop(bytes.next()),
                        b'"' => break,
                        _ => {}
                    }
                }
            }
            b'{' | b'[' => {
                depth += 1;
                greatest = greatest.max(depth);
                if depth > DEEPEST {
                    place = place.or(Some(i));
                }
            }
            b'}' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    place.map(|byte| (greatest, byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_in_strings_do_not_nest() {
        let text = format!("[\"{}\\\"[\"]", "[".repeat(1000));
        assert!(Document::parse(&text).is_ok());
        let deep = format!("{}{}", "[".repeat(251), "]".repeat(251));
        assert_eq!(too_deep(&deep), Some((251, 250)));
    }

    #[test]
    fn only_json_is_json() {
        for text in
            ["", "{} {}", "[1,]", "[01]", "// no\n1", "'a'", "\u{b}1", "\"\u{1}\"", "[1 2]"]
        {
            let error = Document::parse(text).map(|_| ()).unwrap_err();
            assert!(error.to_string().contains("not JSON: "), "{text:?}: {error}");
        }
    }
}
