// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is wrong with a scene, and where.

use std::fmt;

use palpate_field::ShapeError;

/// Why a scene cannot be read or built.
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
/// assert_eq!((error.line, error.column), (2, 54));
/// assert!(matches!(error.cause.as_deref(), Some(SceneCause::Shape(_))));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub struct SceneError {
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
    /// The error behind the problem, if another crate found it.
    pub cause: Option<Box<SceneCause>>,
}

/// The error behind a [`SceneError`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneCause {
    /// The file cannot be read.
    File(std::io::ErrorKind),
    /// A shape cannot be built.
    Shape(ShapeError),
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, line, problem, .. } = self;
        match (path.is_empty(), *line) {
            (true, 0) => write!(f, "{problem}"),
            (true, line) => write!(f, "line {line}: {problem}"),
            (false, 0) => write!(f, "{path}: {problem}"),
            (false, line) => write!(f, "{path}, line {line}: {problem}"),
        }
    }
}
