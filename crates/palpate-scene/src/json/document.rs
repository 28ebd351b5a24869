// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A JSON text, checked and with the place of everything in it.

use std::collections::HashSet;

use jsonc_parser::ast::{ObjectProp, Value as Tree};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::{Map, Value};

use crate::error::SceneError;
use crate::problem::{Problem, Step, shortened};

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

/// How many characters the first `bytes` of a line are; serde counts bytes.
fn characters(text: &str, line: usize, bytes: usize) -> usize {
    let line = text.split('\n').nth(line.saturating_sub(1)).unwrap_or_default();
    line.char_indices().take_while(|(at, _)| *at < bytes).count()
}

/// A JSON text, its value, and the tree that knows the places.
pub(crate) struct Document<'a> {
    text: &'a str,
    tree: Tree<'a>,
    value: Value,
}

impl<'a> Document<'a> {
    /// Reads one JSON value, strictly: a key that is there twice and a number beyond the range of
    /// `f64` are errors.
    pub(crate) fn parse(text: &'a str) -> Result<Self, SceneError> {
        // serde_json judges the grammar; the other parser, made for JSON with
        // comments, is more tolerant of odd whitespace and control characters.
        if let Err(error) = serde_json::from_str::<IgnoredAny>(text) {
            let full = error.to_string();
            let end = full.rfind(" at line ").unwrap_or(full.len());
            return Err(SceneError {
                path: String::new(),
                line: error.line(),
                column: characters(text, error.line(), error.column()),
                problem: format!("not JSON: {}", full.get(..end).unwrap_or(&full)),
                cause: None,
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
        let Some(tree) = parsed.value else {
            return Err(at("not JSON: nothing there".into(), 0));
        };
        let mut document = Self { text, tree, value: Value::Null };
        document.value = value(&document.tree).map_err(|problem| document.locate(problem))?;
        Ok(document)
    }

    /// The JSON value.
    pub(crate) fn into_value(self) -> Value {
        self.value
    }

    /// The text deserialised as a `T`.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, Problem> {
        super::read(&self.value)
    }

    /// `problem` with the place of the deepest value on its path.
    pub(crate) fn locate(&self, problem: Problem) -> SceneError {
        let mut place = self.tree.range().start;
        let mut tree = Some(&self.tree);
        for step in problem.steps() {
            let next = match (step, tree) {
                (Step::Key(key), Some(Tree::Object(object))) => object
                    .properties
                    .iter()
                    // Of duplicates the last is the one too many.
                    .rfind(|property| name(property) == key)
                    .map(|property| (property.range.start, &property.value)),
                (Step::Index(index), Some(Tree::Array(array))) => {
                    array.elements.get(*index).map(|element| (element.range().start, element))
                }
                _ => None,
            };
            match next {
                Some((start, inner)) => (place, tree) = (start, Some(inner)),
                None => break,
            }
        }
        problem.located(Some(Position::of_byte(self.text, place)))
    }
}

/// The value of a tree.
fn value(tree: &Tree<'_>) -> Result<Value, Problem> {
    Ok(match tree {
        Tree::StringLit(text) => Value::String(text.value.clone().into_owned()),
        Tree::NumberLit(literal) => number(literal.value)?,
        Tree::BooleanLit(literal) => Value::Bool(literal.value),
        Tree::NullKeyword(_) => Value::Null,
        Tree::Array(array) => {
            let elements = array.elements.iter().enumerate();
            let element = |(i, tree)| value(tree).map_err(|problem| problem.at(i));
            elements.map(element).collect::<Result<_, _>>()?
        }
        Tree::Object(object) => {
            refuse_duplicates(&object.properties)?;
            let entry = |property: &ObjectProp<'_>| {
                let key = name(property);
                let value = value(&property.value).map_err(|problem| problem.under(key))?;
                Ok((key.to_owned(), value))
            };
            Value::Object(
                object.properties.iter().map(entry).collect::<Result<Map<_, _>, _>>()?,
            )
        }
    })
}

/// Reads whole numbers as integers, for counts, and all others as `f64`.
fn number(literal: &str) -> Result<Value, Problem> {
    if let Ok(whole) = literal.parse::<u64>() {
        return Ok(whole.into());
    }
    match literal.parse::<i64>() {
        // "-0" is a float of its own.
        Ok(whole) if whole != 0 => return Ok(whole.into()),
        _ => {}
    }
    match literal.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number.into()),
        _ => {
            let literal = shortened(literal);
            Err(Problem::about(format!("must be within the range of numbers, got {literal}")))
        }
    }
}

fn refuse_duplicates(properties: &[ObjectProp<'_>]) -> Result<(), Problem> {
    let mut seen = HashSet::with_capacity(properties.len());
    match properties.iter().map(name).find(|key| !seen.insert(*key)) {
        None => Ok(()),
        Some(key) => {
            let shown = shortened(key);
            Err(Problem::new(format!("duplicate key `{shown}`")).under(key))
        }
    }
}

/// The key of a property.
fn name<'a>(property: &'a ObjectProp<'_>) -> &'a str {
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
