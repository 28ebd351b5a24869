// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An error on its way up: each level adds its step to the path.

use std::fmt;

use serde::de::{self, Expected, Unexpected};

use palpate_field::ShapeError;

use crate::error::{SceneCause, SceneError, SceneProblem};
use crate::json::Position;
use crate::names::{shortened, unknown};

/// One step down into a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// To the value of a key.
    Key(String),
    /// To a place in a list.
    Index(usize),
}

/// Something wrong, and the way to it.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// The steps from the place up to the root: the last is the outermost.
    steps: Vec<Step>,
    /// `true` if the message lacks its subject: the name of the place.
    wants_subject: bool,
    /// `true` if the other dimension may accept what is wrong here.
    of_dimension: bool,
    /// The key that is missing, if that is what is wrong.
    missing: Option<String>,
    message: String,
    cause: Option<Box<SceneCause>>,
}

impl Problem {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            steps: Vec::new(),
            wants_subject: false,
            of_dimension: false,
            missing: None,
            message: message.into(),
            cause: None,
        }
    }

    /// A key that must be there, and what it is for.
    pub(crate) fn missing(key: &str, about: &str) -> Self {
        let colon = if about.is_empty() { "" } else { ": " };
        let problem = Self::new(format!("missing key `{key}`{colon}{about}"));
        Self { missing: Some(key.to_owned()), ..problem }
    }

    /// What a shape refuses.
    pub(crate) fn of_shape(error: ShapeError) -> Self {
        let problem = Self::new(error.to_string());
        Self { cause: Some(Box::new(SceneCause::Shape(error))), ..problem }
    }

    /// The same problem in other words.
    pub(crate) fn saying(self, message: String) -> Self {
        Self { message, ..self }
    }

    /// A message that begins with its verb: "must be positive".
    pub(crate) fn about(message: impl Into<String>) -> Self {
        Self { wants_subject: true, ..Self::new(message) }
    }

    /// The same problem, seen from the object that has it under `key`.
    pub(crate) fn under(mut self, key: &str) -> Self {
        self.steps.push(Step::Key(key.to_owned()));
        self
    }

    /// The same problem, seen from the list that has it at `index`.
    pub(crate) fn at(mut self, index: usize) -> Self {
        self.steps.push(Step::Index(index));
        self
    }

    /// The same problem, which the other dimension may not have.
    pub(crate) fn of_dimension(self) -> Self {
        Self { of_dimension: true, ..self }
    }

    /// `true` if the other dimension may accept what is wrong here.
    pub(crate) fn is_of_dimension(&self) -> bool {
        self.of_dimension
    }

    /// The same problem, at a place whose dimension is fixed.
    pub(crate) fn in_any_dimension(self) -> Self {
        Self { of_dimension: false, ..self }
    }

    /// The key that is missing, if that is what is wrong.
    pub(crate) fn missing_key(&self) -> Option<&str> {
        self.missing.as_deref()
    }

    /// `true` if a shape refused to be made.
    pub(crate) fn is_of_shape(&self) -> bool {
        self.cause.is_some()
    }

    /// What is wrong, without the place.
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// The steps from the root to the place.
    pub(crate) fn steps(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter().rev()
    }

    /// The same problem, each step of its path replaced, from the root to the place.
    pub(crate) fn with_steps(mut self, change: impl FnMut(Step) -> Step) -> Self {
        let mut steps: Vec<_> = self.steps.into_iter().rev().map(change).collect();
        steps.reverse();
        self.steps = steps;
        self
    }

    /// The error for users, at `position` if it is known.
    pub(crate) fn located(self, position: Option<Position>) -> SceneProblem {
        let path = display(self.steps.iter().rev());
        let problem = if self.wants_subject {
            let named = self.steps.iter().position(|step| matches!(step, Step::Key(_)));
            let subject = match named {
                Some(key) => display(self.steps.iter().take(key + 1).rev()),
                None => "the file".to_owned(),
            };
            format!("{subject} {}", self.message)
        } else {
            self.message
        };
        let (line, column) = position.map_or((0, 0), |p| (p.line, p.column));
        SceneProblem { path, line, column, problem, cause: self.cause, ..Default::default() }
    }
}

/// `a.b[2].c`; keys that would be ambiguous are quoted.
fn display<'a>(steps: impl Iterator<Item = &'a Step>) -> String {
    let mut path = String::new();
    for step in steps {
        match step {
            Step::Index(index) => path.push_str(&format!("[{index}]")),
            Step::Key(key) => {
                if !path.is_empty() {
                    path.push('.');
                }
                let plain = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
                let key = shortened(key);
                if !key.is_empty() && key.chars().all(plain) {
                    path.push_str(&key);
                } else {
                    path.push_str(&format!("{key:?}"));
                }
            }
        }
    }
    path
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Problem {}

impl From<Problem> for SceneError {
    /// Of a scene that does not come from a file.
    fn from(problem: Problem) -> Self {
        problem.located(None).into()
    }
}

impl de::Error for Problem {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(message.to_string())
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::about(format!("must be {}, got {}", plain(expected), quoted(found)))
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(found, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::about(format!("must be {}, got {length}", plain(expected)))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::new(unknown("value", variant, expected))
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::new(unknown("key", field, expected))
    }

    fn missing_field(field: &'static str) -> Self {
        let about = match field {
            "palpate" => "the version of the format, 1",
            "dimension" => "2 for the plane, 3 for space",
            "bodies" => "what is there to be touched",
            _ => "",
        };
        Self::missing(field, about)
    }

    fn duplicate_field(field: &'static str) -> Self {
        Self::new(format!("duplicate key `{field}`"))
    }
}

/// What was expected, without the words of Rust.
fn plain(expected: &dyn Expected) -> String {
    let expected = expected.to_string();
    let plain = match expected.as_str() {
        "f64" => "a number",
        "i32" => "a whole number",
        "u32" | "usize" => "a whole number, zero or more",
        "a sequence" => "a list",
        "a map" => "an object",
        "an array of length 2" => "a list of 2 numbers",
        "an array of length 3" => "a list of 3 numbers",
        "an array of length 4" => "a list of 4 numbers",
        other => other,
    };
    plain.to_owned()
}

fn quoted(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Str(text) => format!("{:?}", shortened(text)),
        Unexpected::Bool(value) => value.to_string(),
        Unexpected::Unsigned(number) => number.to_string(),
        Unexpected::Signed(number) => number.to_string(),
        Unexpected::Float(number) => format!("{number:?}"),
        Unexpected::Seq => "a list".into(),
        Unexpected::Map => "an object".into(),
        Unexpected::Unit => "null".into(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_quote_what_is_not_a_plain_name() {
        let problem = Problem::about("must be short").at(1).at(0).under("a.b").under("shapes");
        let error = problem.located(None);
        assert_eq!(error.to_string(), r#"shapes."a.b"[0][1]: "a.b"[0][1] must be short"#);
    }
}
