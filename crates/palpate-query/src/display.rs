// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers as a sentence each.

use std::fmt::{Display, Formatter, Result};

use crate::certified::{Certified, Stop};
use crate::contacts::ElementContacts;
use crate::manifold::Manifold;
use crate::mesh::{MeshContacts, MeshHits};
use crate::pair::{Nearest, SeparatingTranslation};
use crate::point::AtPoint;
use crate::ray::RayHit;

impl Display for Stop {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::SignKnown => "sign_known",
            Self::BudgetSpent => "budget_spent",
            Self::MemoryFull => "memory_full",
            Self::RoundingReached => "rounding_reached",
        })
    }
}

impl<T> Display for Certified<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { lower, upper, stop, evaluations, .. } = self;
        write!(f, "{lower} to {upper} m, {stop} after {evaluations} evaluations")
    }
}

impl<const D: usize> Display for Nearest<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "nearest at {:?} m", self.point.0)?;
        match self.normal {
            Some(normal) => write!(f, " along {:?}", normal.0),
            None => f.write_str(", without a normal"),
        }
    }
}

impl<const D: usize> Display for RayHit<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "hit at {:?} m", self.point.0)
    }
}

impl<const D: usize> Display for SeparatingTranslation<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { direction, length, at_least, .. } = self;
        write!(f, "{length} m along {:?}, at least {at_least} m any way", direction.0)
    }
}

impl<const D: usize> Display for Manifold<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let [contacts, groups] = [self.contacts.len(), self.groups.len()];
        write!(f, "{contacts} contacts in {groups} groups, separation {}", self.separation)
    }
}

impl<const D: usize> Display for ElementContacts<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} contacts, least value {}", self.contacts.len(), self.least)
    }
}

impl Display for MeshHits {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let [hits, undecided] = [self.hits.len(), self.undecided.len()];
        let evaluations = self.evaluations;
        let touch = if hits == 1 { "element touches" } else { "elements touch" };
        write!(f, "{hits} {touch}, {undecided} undecided, {evaluations} evaluations")
    }
}

impl<const D: usize> Display for MeshContacts<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let [contacts, hits] = [self.contacts.len(), self.hits.len()];
        let (undecided, evaluations) = (self.undecided.len(), self.evaluations);
        write!(f, "{contacts} contacts on {hits} elements, {undecided} undecided, ")?;
        write!(f, "{evaluations} evaluations")
    }
}

impl<const D: usize> Display for AtPoint<D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} m at {:?} m", self.distance, self.point.0)
    }
}

#[cfg(test)]
mod tests {
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
