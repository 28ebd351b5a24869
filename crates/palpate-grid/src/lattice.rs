// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the nodes of a grid lie.

use palpate_field::{Aabb, LARGEST_LENGTH, Point, Quantity, ShapeError, Unit, Vector};

use crate::error::GridError;

/// Nodes at `origin + cell·i`, with `counts` of them along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice<const D: usize> {
    /// The first node [m].
    pub origin: Point<D>,
    /// The distance of neighbours along each axis [m].
    pub cell: f64,
    /// How many nodes there are along each axis.
    pub counts: [usize; D],
}

impl<const D: usize> Lattice<D> {
    /// The nodes of a box that is grown to whole cells about its centre.
    #[must_use]
    pub fn over(region: &Aabb<D>, cell: f64) -> Self {
        let counts =
            std::array::from_fn(|i| ((region.max[i] - region.min[i]) / cell).ceil() as usize);
        let counts = counts.map(|cells: usize| cells.saturating_add(1));
        let size = Vector(std::array::from_fn(|i| (counts[i] - 1) as f64 * cell));
        Self { origin: region.centre() - size * 0.5, cell, counts }
    }

    /// A node's place [m].
    #[must_use]
    #[inline]
    pub fn node(&self, index: [usize; D]) -> Point<D> {
        self.at(Vector(index.map(|i| i as f64)))
    }

    /// The place of an index that need not be whole [m].
    #[inline]
    pub(crate) fn at(&self, index: Vector<f64, D>) -> Point<D> {
        self.origin + index * self.cell
    }

    /// The first sample of the cell that a point lies in, and where in the cell it lies, from 0 to 1 along each axis.
    #[inline(always)]
    pub(crate) fn locate<const K: usize>(&self, p: Point<D>) -> ([usize; D], [f64; D]) {
        let inverse = 1.0 / self.cell;
        let (mut first, mut local) = ([0; D], [0.0; D]);
        for i in 0..D {
            let along = (p[i] - self.origin[i]) * inverse - (0.5 * K as f64 - 1.0);
            first[i] = (along as usize).min(self.counts[i] - K);
            local[i] = along - first[i] as f64;
        }
        (first, local)
    }

    /// How many nodes there are, if a number can say it.
    #[must_use]
    pub fn nodes(&self) -> Option<usize> {
        self.counts.iter().try_fold(1_usize, |product, count| product.checked_mul(*count))
    }

    /// Whether there are at most so many nodes.
    pub(crate) fn has_at_most(&self, limit: usize) -> bool {
        self.nodes().is_some_and(|nodes| nodes <= limit)
    }

    /// Refuses nodes that are farther from the origin than [`LARGEST_LENGTH`] along an axis.
    pub(crate) fn check(&self) -> Result<(), GridError> {
        let region = self.region();
        let beyond = [region.min, region.max]
            .into_iter()
            .flat_map(|corner| corner.0)
            .find(|x| x.is_nan() || x.abs() > LARGEST_LENGTH);
        beyond.map_or(Ok(()), |value| {
            Err(GridError::Number(ShapeError::Number {
                parameter: "a coordinate of a node".into(),
                rule: "at most 1e15 m in size".into(),
                value: Quantity(value, Unit::Metre),
            }))
        })
    }

    /// The box between the first and the last node [m].
    #[must_use]
    pub fn region(&self) -> Aabb<D> {
        Aabb { min: self.origin, max: self.node(self.counts.map(|count| count - 1)) }
    }
}

/// The index along each axis of the `number`th of as many as the product of `counts`, the first axis first.
#[inline]
pub(crate) fn unravelled<const D: usize>(number: usize, counts: [usize; D]) -> [usize; D] {
    let mut rest = number;
    counts.map(|count| {
        let index = rest % count;
        rest /= count;
        index
    })
}

/// The number of an index among as many as the product of `counts`, the first axis first.
#[inline]
pub(crate) fn raveled<const D: usize>(index: [usize; D], counts: [usize; D]) -> usize {
    (0..D).rev().fold(0, |number, i| number * counts[i] + index[i])
}

/// Every index with coordinates from `first` to one less than `end`, the first axis first.
pub(crate) fn indices<const D: usize>(
    first: [usize; D],
    end: [usize; D],
) -> impl Iterator<Item = [usize; D]> {
    let counts: [usize; D] = std::array::from_fn(|i| end[i].saturating_sub(first[i]));
    (0..counts.iter().product()).map(move |number| {
        let index = unravelled(number, counts);
        std::array::from_fn(|i| first[i] + index[i])
    })
}
