// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a command ends: with yes, with no, interrupted, or with a failure.

use std::fmt;
use std::io;

use crate::interrupt::Interrupt;

/// The answer of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done; the answer is yes.
    Yes,
    /// Done; the answer is no.
    No,
    /// Interrupted before all was done.
    Interrupted,
}

impl Outcome {
    /// The exit status.
    pub(crate) fn status(self) -> u8 {
        match self {
            Self::Yes => 0,
            Self::No => 1,
            Self::Interrupted => Interrupt::STATUS,
        }
    }
}

/// Why a command has no answer.
#[derive(Debug)]
pub(crate) enum Failure {
    /// What was wrong with the input, in a sentence.
    Input(String),
    /// Writing the answer failed.
    Output(io::Error),
}

impl Failure {
    /// The exit status.
    pub(crate) const STATUS: u8 = 2;

    /// The exit status where the reader of the output left: as if SIGPIPE had ended the program.
    pub(crate) const NO_READER: u8 = 141;

    /// What was wrong with the input.
    pub(crate) fn input(problem: impl fmt::Display) -> Self {
        Self::Input(problem.to_string())
    }

    /// All failures of several results in one; `Ok` if there are none.
    pub(crate) fn any(results: impl IntoIterator<Item = Result<(), Self>>) -> Result<(), Self> {
        let mut failures: Vec<_> = results.into_iter().filter_map(Result::err).collect();
        match failures.pop() {
            None => Ok(()),
            // Kept as it is: the reader of an output may have left.
            Some(failure) if failures.is_empty() => Err(failure),
            Some(last) => {
                let problems = failures.iter().chain([&last]).map(ToString::to_string);
                Err(Self::Input(problems.collect::<Vec<_>>().join("; ")))
            }
        }
    }

    /// `path` could not be read or written.
    pub(crate) fn file(path: &std::path::Path, error: impl fmt::Display) -> Self {
        Self::Input(format!("{}: {error}", path.display()))
    }

    /// `true` if the reader of the output closed the pipe, as `head` does, which is no error.
    pub(crate) fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(problem) => f.write_str(problem),
            Self::Output(error) => write!(f, "the output cannot be written: {error}"),
        }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl From<csv::Error> for Failure {
    /// An error of a table that the command writes.
    fn from(error: csv::Error) -> Self {
        Self::Output(error.into())
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::Output(error.into())
    }
}
