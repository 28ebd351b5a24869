// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A JSON text, checked and with the place of everything in it.

use jsonc_parser::ast::{ObjectProp, Value as Tree};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::reading::Reading;
use super::source::Source;
use crate::error::{MOST, SceneError, SceneProblem};
use crate::names::shortened;
use crate::problem::{Problem, Step};
use crate::problems::Problems;

/// How deep objects and lists may nest: what two of them for each of the 64
/// levels of a shape need, twice over. Deeper ones could exhaust the stack.
const DEEPEST: usize = 250;

/// A JSON text, its value, and the tree that knows the places.
pub(crate) struct Document<'a> {
    source: &'a Source<'a>,
    tree: Tree<'a>,
    value: Value,
    /// Duplicate keys, of which the last is in the value, and numbers out of range, for which a
    /// number within it is.
    wrong: Vec<Problem>,
}

impl<'a> Document<'a> {
    /// Reads one JSON value, strictly: a key that is there twice and a number beyond the range of
    /// `f64` are problems.
    pub(crate) fn parse(source: &'a Source<'a>) -> Result<Self, SceneError> {
        // Serde has judged the grammar; the other parser, made for JSON with
        // comments, is more tolerant of odd whitespace and control characters.
        let text = source.readable()?;
        let at = |message: String, byte| {
            source.error([Problem::new(message).located(Some(source.position(byte)))])
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
        let mut wrong = Vec::new();
        let value = value(&tree, &mut wrong);
        Ok(Self { source, tree, value, wrong })
    }

    /// The JSON value.
    pub(crate) fn into_value(self) -> Result<Value, SceneError> {
        if self.source.is_good() && self.wrong.is_empty() {
            return Ok(self.value);
        }
        Err(self.error(Problems::default()))
    }

    /// What the text holds, which `build` checks.
    pub(crate) fn read<T: DeserializeOwned>(
        &self,
        build: impl FnOnce(&T) -> Result<(), Problems>,
    ) -> Result<T, SceneError> {
        let mut reading = Reading::new(&self.value);
        let read: Option<T> = reading.read();
        let is_built = read.is_some() && reading.is_buildable();
        if let (Some(read), true) = (&read, is_built) {
            reading.add_built(build(read).err().unwrap_or_default());
        }
        let problems = reading.into_problems();
        let is_good = self.source.is_good() && self.wrong.is_empty() && !problems.is_failed();
        match read.filter(|_| is_good) {
            Some(read) => Ok(read),
            None if is_built => Err(self.error(problems)),
            None => Err(self.error(problems).and_maybe_more()),
        }
    }

    /// The error of the text and of what is wrong with the value, but for what is wrong where the
    /// text already is.
    fn error(&self, problems: Problems) -> SceneError {
        let found = problems.into_vec();
        let found = found.iter().filter(|problem| !self.is_told(problem));
        let all = self.wrong.iter().chain(found);
        self.source.error(all.map(|problem| self.locate(problem)))
    }

    /// `true` if the text is wrong where a problem is.
    fn is_told(&self, problem: &Problem) -> bool {
        let (_, place) = self.place(problem);
        let is_inside = |wrong: &Problem| {
            let mut steps = wrong.steps();
            problem.steps().all(|step| steps.next() == Some(step))
        };
        !matches!(place, Tree::Object(_))
            && (self.source.is_guessed(place.range().start..place.range().end)
                || self.wrong.iter().any(is_inside))
    }

    /// `problem` with the place of the deepest value on its path.
    fn locate(&self, problem: &Problem) -> SceneProblem {
        let (start, _) = self.place(problem);
        problem.clone().located(Some(self.source.position(start)))
    }

    /// The deepest value on the path of a problem, and where it, or its key, begins.
    fn place(&self, problem: &Problem) -> (usize, &Tree<'a>) {
        let (mut start, mut tree) = (self.tree.range().start, &self.tree);
        for step in problem.steps() {
            let next = match (step, tree) {
                (Step::Key(key), Tree::Object(object)) => object
                    .properties
                    .iter()
                    // Of duplicates the last is the one too many.
                    .rfind(|property| name(property) == key)
                    .map(|property| (property.range.start, &property.value)),
                (Step::Index(index), Tree::Array(array)) => {
                    array.elements.get(*index).map(|element| (element.range().start, element))
                }
                _ => None,
            };
            match next {
                Some(inner) => (start, tree) = inner,
                None => break,
            }
        }
        (start, tree)
    }
}

/// The value of a tree; what is wrong in it is added to `wrong`.
fn value(tree: &Tree<'_>, wrong: &mut Vec<Problem>) -> Value {
    match tree {
        Tree::StringLit(text) => Value::String(text.value.clone().into_owned()),
        Tree::NumberLit(literal) => number(literal.value).unwrap_or_else(|problem| {
            add(wrong, problem);
            f64::MAX.into()
        }),
        Tree::BooleanLit(literal) => Value::Bool(literal.value),
        Tree::NullKeyword(_) => Value::Null,
        Tree::Array(array) => {
            let elements = array.elements.iter().enumerate();
            let element = |(i, tree)| {
                let known = wrong.len();
                let value = value(tree, wrong);
                seen_from(&mut wrong[known..], |problem| problem.at(i));
                value
            };
            elements.map(element).collect()
        }
        Tree::Object(object) => {
            let mut entries = Map::with_capacity(object.properties.len());
            for property in &object.properties {
                let (key, known) = (name(property), wrong.len());
                let value = value(&property.value, wrong);
                seen_from(&mut wrong[known..], |problem| problem.under(key));
                if entries.insert(key.to_owned(), value).is_some() {
                    let shown = shortened(key);
                    let message = format!("duplicate key `{shown}`");
                    add(wrong, Problem::new(message).under(key));
                }
            }
            Value::Object(entries)
        }
    }
}

/// Adds a problem, if it is not one of too many to tell.
fn add(wrong: &mut Vec<Problem>, problem: Problem) {
    if wrong.len() <= MOST {
        wrong.push(problem);
    }
}

/// Changes the problems of a part to those of what holds it.
fn seen_from(wrong: &mut [Problem], change: impl Fn(Problem) -> Problem) {
    for problem in wrong {
        *problem = change(problem.clone());
    }
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
        assert!(Document::parse(&Source::of(&text)).is_ok());
        let deep = format!("{}{}", "[".repeat(251), "]".repeat(251));
        assert_eq!(too_deep(&deep), Some((251, 250)));
    }

    #[test]
    fn only_json_is_json() {
        for text in
            ["", "{} {}", "[1,]", "[01]", "// no\n1", "'a'", "\u{b}1", "\"\u{1}\"", "[1 2]"]
        {
            let source = Source::of(text);
            let error = Document::parse(&source).and_then(Document::into_value).unwrap_err();
            assert!(error.to_string().contains("not JSON: "), "{text:?}: {error}");
        }
    }
}
