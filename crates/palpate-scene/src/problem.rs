// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Problems of scenes.

use std::fmt;
use std::path::Path;

use palpate_field::ShapeError;
use serde::de::{self, Expected, Unexpected};

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

/// All that is wrong with a part of a scene.
///
/// As an error it may be empty: then what is wrong is told elsewhere.
#[derive(Clone, Debug, Default)]
pub(crate) struct Problems {
    found: Vec<Problem>,
    is_failed: bool,
}

impl Problems {
    /// An error that is told elsewhere.
    pub(crate) fn told() -> Self {
        Self { found: Vec::new(), is_failed: true }
    }

    /// All errors of some results.
    pub(crate) fn all<E: Into<Self>>(
        results: impl IntoIterator<Item = Result<(), E>>,
    ) -> Result<(), Self> {
        let mut problems = Self::default();
        for result in results {
            problems.kept(result);
        }
        problems.end(Ok(()))
    }

    /// Two values, or the problems of both.
    pub(crate) fn both<A, B>(
        first: Result<A, impl Into<Self>>,
        second: Result<B, impl Into<Self>>,
    ) -> Result<(A, B), Self> {
        let mut problems = Self::default();
        match (problems.kept(first), problems.kept(second)) {
            (Some(first), Some(second)) => Ok((first, second)),
            _ => Err(problems),
        }
    }

    /// Adds what is wrong. Beyond one more than can be told, only the failure is kept.
    pub(crate) fn add(&mut self, others: impl Into<Self>) {
        let others = others.into();
        self.is_failed |= others.is_failed;
        let room = (MOST + 1).saturating_sub(self.found.len());
        self.found.extend(others.found.into_iter().take(room));
    }

    /// The value of a result, whose error is added.
    pub(crate) fn kept<T, E: Into<Self>>(&mut self, result: Result<T, E>) -> Option<T> {
        result.map_err(|error| self.add(error)).ok()
    }

    /// The result of a part whose other problems these are.
    pub(crate) fn end<T>(mut self, result: Result<T, Self>) -> Result<T, Self> {
        match self.kept(result) {
            Some(value) if !self.is_failed => Ok(value),
            _ => Err(self),
        }
    }

    /// `true` if anything is wrong.
    pub(crate) fn is_failed(&self) -> bool {
        self.is_failed
    }

    /// `true` if more is wrong than can be told.
    pub(crate) fn is_full(&self) -> bool {
        self.found.len() > MOST
    }

    /// The same problems, seen from the object that has them under `key`.
    pub(crate) fn under(self, key: &str) -> Self {
        self.map(|problem| problem.under(key))
    }

    /// The same problems, seen from the list that has them at `index`.
    pub(crate) fn at(self, index: usize) -> Self {
        self.map(|problem| problem.at(index))
    }

    /// The same problems, at a place whose dimension is fixed.
    pub(crate) fn in_any_dimension(self) -> Self {
        self.map(Problem::in_any_dimension)
    }

    /// A problem that the other dimension may not have.
    pub(crate) fn of_dimension(&self) -> Option<&Problem> {
        self.found.iter().find(|problem| problem.is_of_dimension())
    }

    /// The same problems without those that a shape found.
    pub(crate) fn of_the_text(mut self) -> Self {
        self.found.retain(|problem| !problem.is_of_shape());
        self
    }

    /// The problems.
    pub(crate) fn into_vec(self) -> Vec<Problem> {
        self.found
    }

    fn map(self, change: impl FnMut(Problem) -> Problem) -> Self {
        Self { found: self.found.into_iter().map(change).collect(), ..self }
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self { found: vec![problem], is_failed: true }
    }
}

impl From<Problems> for SceneError {
    /// Of a scene that does not come from a file.
    fn from(problems: Problems) -> Self {
        Self::of(problems.found.into_iter().map(|problem| problem.located(None)))
    }
}

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

/// The most problems that an error tells of.
pub(crate) const MOST: usize = 20;

/// Why a scene cannot be read or built: everything that is wrong, at least one problem.
///
/// What is wrong only because something else is, such as a reference to a shape that cannot be
/// built, is left out. At most 20 problems are told, in their order in the file.
///
/// ```
/// use palpate_scene::{Scene, SceneCause};
///
/// let text = r#"{ "palpate": 1, "dimension": 3,
///   "bodies": [ { "name": "ball", "shape": { "ball": { "radius": -0.02 } } } ] }"#;
/// let error = Scene::from_json(text).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "bodies[0].shape.ball.radius, line 2: radius must be positive, got -0.02 m",
/// );
/// let problem = error.first();
/// assert_eq!((problem.line, problem.column), (2, 54));
/// assert!(matches!(problem.cause.as_deref(), Some(SceneCause::Shape(_))));
///
/// let error = Scene::from_json(&text.replace("\"ball\",", "\"\", \"colour\": 3,")).unwrap_err();
/// assert_eq!(error.problems().count(), 3);
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct SceneError {
    first: Box<SceneProblem>,
    others: Vec<SceneProblem>,
    is_all: bool,
}

/// One thing that is wrong with a scene.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SceneProblem {
    /// Where in the scene: keys joined by dots, places in lists in brackets;
    /// empty for the whole.
    pub path: String,
    /// The line, from 1; 0 if the scene does not come from a file.
    pub line: usize,
    /// The column in characters, from 1; 0 if the scene does not come from a
    /// file.
    pub column: usize,
    /// What is wrong there.
    pub problem: String,
    /// Of a text that is no JSON: the line, or the part of it around the place, and below it a
    /// line with a caret at the place. Empty for all other problems.
    pub excerpt: String,
    /// The error behind the problem, if another crate found it.
    pub cause: Option<Box<SceneCause>>,
}

impl SceneProblem {
    /// That a file cannot be read.
    pub(crate) fn of_file(path: &Path, error: &std::io::Error) -> Self {
        // The words of `read_file` have no subject.
        let it = if error.raw_os_error().is_none() { "it " } else { "" };
        Self {
            problem: format!("cannot read {}: {it}{error}", path.display()),
            cause: Some(Box::new(SceneCause::File(error.kind()))),
            ..Self::default()
        }
    }
}

/// The error behind a [`SceneProblem`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneCause {
    /// The file cannot be read.
    File(std::io::ErrorKind),
    /// A shape cannot be built.
    Shape(ShapeError),
}

impl SceneError {
    /// All these problems, which are sorted by place, or the first [`MOST`] of them.
    pub(crate) fn of(problems: impl IntoIterator<Item = SceneProblem>) -> Self {
        let mut problems = problems.into_iter();
        let first = problems.next().unwrap_or_else(|| SceneProblem {
            problem: "the scene cannot be built".into(),
            ..SceneProblem::default()
        });
        let others: Vec<_> = problems.by_ref().take(MOST - 1).collect();
        Self { first: Box::new(first), others, is_all: problems.next().is_none() }
    }

    /// The same error of a file that was not read to its end.
    pub(crate) fn and_maybe_more(self) -> Self {
        Self { is_all: false, ..self }
    }

    /// The first problem in the file.
    #[must_use]
    pub fn first(&self) -> &SceneProblem {
        &self.first
    }

    /// The problems, in their order in the file.
    pub fn problems(&self) -> impl Iterator<Item = &SceneProblem> {
        std::iter::once(&*self.first).chain(&self.others)
    }

    /// `false` if there may be further problems: more than are told, or in parts of a text that
    /// cannot be read.
    #[must_use]
    pub fn is_all(&self) -> bool {
        self.is_all
    }
}

impl From<SceneProblem> for SceneError {
    fn from(problem: SceneProblem) -> Self {
        Self::of([problem])
    }
}

impl fmt::Display for SceneError {
    /// One problem, or a line that counts them and each on a line of its own.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.others.is_empty() {
            return write!(f, "{}", self.first);
        }
        let more = if self.is_all { "" } else { ", and maybe more" };
        write!(f, "{} problems{more}:", 1 + self.others.len())?;
        for problem in self.problems() {
            write!(f, "\n  {}", problem.to_string().replace('\n', "\n  "))?;
        }
        Ok(())
    }
}

impl fmt::Display for SceneProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, line, column, problem, excerpt, .. } = self;
        match (path.is_empty(), *line) {
            (true, 0) => write!(f, "{problem}"),
            (true, line) if excerpt.is_empty() => write!(f, "line {line}: {problem}"),
            (true, line) => write!(f, "line {line}, column {column}: {problem}\n{excerpt}"),
            (false, 0) => write!(f, "{path}: {problem}"),
            (false, line) => write!(f, "{path}, line {line}: {problem}"),
        }
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
