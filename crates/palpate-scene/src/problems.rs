// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All that is wrong, collected part by part.

use crate::error::{MOST, SceneError};
use crate::problem::Problem;

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
