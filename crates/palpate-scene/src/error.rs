// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is wrong with a scene, and where.

use std::fmt;

use palpate_field::ShapeError;

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
