// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors of questions.

use palpate_field::{LARGEST_LENGTH, Point};

/// Why a question cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// A coordinate is not a number, or too large to compute with.
    #[error("{what} must be finite and at most {LARGEST_LENGTH:e} m in size, got {value:?} m")]
    Coordinate {
        /// The name of the point or vector with the coordinate.
        what: &'static str,
        /// The coordinate.
        value: f64,
    },
    /// A direction without a length.
    #[error("a direction must not be zero")]
    NoDirection,
    /// A length that is negative, or too large to compute with.
    #[error("a length must be from 0 m to {LARGEST_LENGTH:e} m, got {value:?} m")]
    Length {
        /// The length.
        value: f64,
    },
    /// A setting that is negative, zero or too large to compute with.
    #[error("{what} must be positive and at most {LARGEST_LENGTH:e}, got {value:?}")]
    Setting {
        /// The name of the setting.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A pose with a number that is NaN or infinite.
    #[error("pose {index} must be finite")]
    Pose {
        /// Which of the poses, from 0: of two bodies, of a list of poses, or of the bodies
        /// of a world.
        index: usize,
    },
    /// An id of no body in the world.
    #[error("there is no body {body} in this world")]
    NoBody {
        /// Its index.
        body: usize,
    },
    /// Two unbounded bodies.
    #[error("one of two bodies must be bounded, and both have no bounds")]
    Unbounded,
    /// Not as many places for answers as questions.
    #[error("{questions} questions need as many places for answers, got {places}")]
    Places {
        /// How many poses or rays there are.
        questions: usize,
        /// How many places there are.
        places: usize,
    },
}

impl QueryError {
    /// Refuses coordinates that are not finite or beyond 1e15 m, of the parameter called `what`.
    ///
    /// # Errors
    ///
    /// [`QueryError::Coordinate`], with the first wrong coordinate.
    pub fn check_point<const D: usize>(what: &'static str, p: Point<D>) -> Result<(), Self> {
        let is_wrong = |value: &f64| value.is_nan() || value.abs() > LARGEST_LENGTH;
        match p.0.into_iter().find(is_wrong) {
            Some(value) => Err(Self::Coordinate { what, value }),
            None => Ok(()),
        }
    }

    /// Refuses lengths that are negative, NaN or beyond 1e15 m.
    ///
    /// # Errors
    ///
    /// [`QueryError::Length`].
    pub fn check_length(value: f64) -> Result<(), Self> {
        if (0.0..=LARGEST_LENGTH).contains(&value) {
            Ok(())
        } else {
            Err(Self::Length { value })
        }
    }
}
