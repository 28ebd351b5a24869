// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors, and answers as a sentence each.

use std::fmt::{self, Display, Formatter};

use palpate_field::{LARGEST_LENGTH, Point};

use crate::certified::{Certified, Stop};
use crate::contacts::ElementContacts;
use crate::manifold::Manifold;
use crate::mesh::{MeshContacts, MeshHits};
use crate::pair::{Nearest, Penetration};
use crate::point::AtPoint;
use crate::ray::RayHit;

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

impl Display for Stop {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::SignKnown => "sign_known",
            Self::BudgetSpent => "budget_spent",
            Self::MemoryFull => "memory_full",
            Self::RoundingReached => "rounding_reached",
            Self::Unresolved => "unresolved",
        })
    }
}

impl<T> Display for Certified<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { lower, upper, stop, evaluations, .. } = self;
        write!(f, "{lower} to {upper} m, {stop} after {evaluations} evaluations")
    }
}

impl<const D: usize> Display for Nearest<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "nearest at {:?} m", self.point.0)?;
        match self.normal {
            Some(normal) => write!(f, " along {:?}", normal.0),
            None => f.write_str(", without a normal"),
        }
    }
}

impl<const D: usize> Display for RayHit<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "hit at {:?} m", self.point.0)
    }
}

impl<const D: usize> Display for Penetration<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.direction {
            Some(direction) => write!(f, "out along {:?}", direction.0),
            None => f.write_str("no way out"),
        }
    }
}

impl<const D: usize> Display for Manifold<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [contacts, groups] = [self.contacts.len(), self.groups.len()];
        write!(f, "{contacts} contacts in {groups} groups, separation {}", self.separation)
    }
}

impl<const D: usize> Display for ElementContacts<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} contacts, least value {}", self.contacts.len(), self.least)
    }
}

impl Display for MeshHits {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [hits, undecided] = [self.hits.len(), self.undecided.len()];
        let evaluations = self.evaluations;
        let touch = if hits == 1 { "element touches" } else { "elements touch" };
        write!(f, "{hits} {touch}, {undecided} undecided, {evaluations} evaluations")
    }
}

impl<const D: usize> Display for MeshContacts<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [contacts, hits] = [self.contacts.len(), self.hits.len()];
        let (undecided, evaluations) = (self.undecided.len(), self.evaluations);
        write!(f, "{contacts} contacts on {hits} elements, {undecided} undecided, ")?;
        write!(f, "{evaluations} evaluations")
    }
}

impl<const D: usize> Display for AtPoint<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} m at {:?} m", self.distance, self.point.0)
    }
}

#[cfg(test)]
mod display_tests {
    use palpate_field::Vector;

    use super::*;

    #[test]
    fn answers_are_sentences() {
        let nearest = Nearest { point: Vector([0.5, 1.0]), normal: Some(Vector([0.0, 1.0])) };
        assert_eq!(nearest.to_string(), "nearest at [0.5, 1.0] m along [0.0, 1.0]");
        let answer = Certified {
            best: nearest,
            lower: 0.25,
            upper: 0.5,
            stop: Stop::Converged,
            evaluations: 12,
        };
        assert_eq!(answer.to_string(), "0.25 to 0.5 m, converged after 12 evaluations");
        let none = MeshHits { hits: vec![3], ..MeshHits::default() };
        assert_eq!(none.to_string(), "1 element touches, 0 undecided, 0 evaluations");
    }
}
