// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The way of a search, and the loop that all methods share.

use std::fmt;

use palpate_field::{Point, Shape, Vector};
use palpate_query::Element;

use crate::Weights;

/// What a local search found, and how it came there.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Descent<const D: usize> {
    /// The best point on the way, or the last where the method returns that [m].
    pub best: Point<D>,
    /// The value there: nothing says that it is the least [m].
    pub value: f64,
    /// Steps that were taken.
    pub steps: u32,
    /// How often fields were asked; a gradient counts twice.
    pub evaluations: u32,
    /// The points at which the search was, from its start on [m].
    pub path: Vec<Point<D>>,
}

/// What a step of a search was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// None: the search ends where it is, and nothing is counted.
    None,
    /// The last one.
    Last,
    /// One that others follow.
    Next,
}

impl<const D: usize> Descent<D> {
    /// A search that starts at a point with this value, for which the fields were asked
    /// so often.
    pub(crate) fn from_start(start: Point<D>, value: f64, evaluations: u32) -> Self {
        Self { best: start, value, steps: 0, evaluations, path: vec![start] }
    }

    /// A search that starts at this point of an element.
    pub(crate) fn from_weights<const N: usize>(
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: &Weights<N>,
    ) -> Self {
        let start = element.at(start.of_vertices());
        Self::from_start(start, shape.distance(start), 1)
    }

    /// Takes steps until one was the last, or `most` were counted.
    pub(crate) fn run(mut self, most: u32, mut step: impl FnMut(&mut Self) -> Step) -> Self {
        while self.steps < most {
            let taken = step(&mut self);
            self.steps += u32::from(taken != Step::None);
            if taken != Step::Next {
                break;
            }
        }
        self
    }

    /// The value and the gradient at a point, counted.
    pub(crate) fn ask_slope(&mut self, shape: &Shape<D>, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.evaluations += 2;
        shape.distance_gradient(p)
    }

    /// The search is at `p`.
    pub(crate) fn visit(&mut self, p: Point<D>, value: f64) {
        self.path.push(p);
        if value < self.value {
            (self.best, self.value) = (p, value);
        }
    }
}

impl<const D: usize> fmt::Display for Descent<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { best, value, steps, evaluations, .. } = self;
        write!(f, "{value} m at {:?} m, {steps} steps, {evaluations} evaluations", best.0)
    }
}
