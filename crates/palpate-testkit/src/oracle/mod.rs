// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances from definitions, without any formula of the library.
//!
//! A shape is defined by a test whether it contains a point, and by a parametrised boundary.
//! The distance to the boundary is found by sampling: coarse where the boundary is far, down to
//! a spacing where it may be nearest.

mod curves;
mod outlines;
mod patch;
mod planar;
mod power;
mod revolved;
mod slab;
mod spatial;
mod thread;
mod tube;

use palpate_field::Point;
use palpate_field::kernel::Argument;

pub use patch::Patch;

use crate::kernels::{Dimension, Space};

/// A shape by its definition.
pub struct Definition<const D: usize> {
    contains: Box<dyn Fn(Point<D>) -> bool>,
    boundary: Vec<Patch<D>>,
    /// What the library promises outside.
    pub outside: Outside,
    /// `true` if parts of the sampled boundary lie inside, where samples give no distance.
    pub overlaps_itself: bool,
}

/// What the library promises about the value outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// The value is the distance.
    Exact,
    /// The value is a lower bound of the distance.
    Bound,
}

impl<const D: usize> std::fmt::Debug for Definition<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Definition").field("patches", &self.boundary.len()).finish()
    }
}

/// Numbers between which a signed distance lies.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// The distance is at least this.
    pub lower: f64,
    /// The distance is at most this: that of a sample of the boundary.
    pub upper: f64,
    /// `true` if the point is inside.
    pub inside: bool,
}

/// Definitions of the catalogue's primitives.
pub trait Defined<const D: usize>: Dimension<D> {
    /// The definition of the primitive `name`; `None` if it has none here.
    fn definition(name: &str, arguments: &[Argument]) -> Option<Definition<D>>;
}

impl Defined<2> for Space {
    fn definition(name: &str, arguments: &[Argument]) -> Option<Definition<2>> {
        planar::definition(name, arguments)
    }
}

impl Defined<3> for Space {
    fn definition(name: &str, arguments: &[Argument]) -> Option<Definition<3>> {
        spatial::definition(name, arguments)
    }
}

impl<const D: usize> Definition<D> {
    fn new(boundary: Vec<Patch<D>>, contains: impl Fn(Point<D>) -> bool + 'static) -> Self {
        let contains = Box::new(contains);
        Self { contains, boundary, outside: Outside::Exact, overlaps_itself: false }
    }

    /// The side of `p` and its unsigned distance from the boundary, to within `spacing` [m]
    /// unless too much of the boundary is equally near.
    #[must_use]
    pub fn distance(&self, p: Point<D>, spacing: f64) -> Enclosure {
        let (lower, upper) = patch::distance(&self.boundary, p, spacing);
        Enclosure { lower, upper, inside: (self.contains)(p) }
    }
}

/// The `i`th argument as a number.
fn number(arguments: &[Argument], i: usize) -> f64 {
    match &arguments[i] {
        Argument::Number(x) => *x,
        Argument::Count(n) => f64::from(*n),
        other => panic!("argument {i} must be a number, got {other:?}"),
    }
}

/// The `i`th argument as a vector.
fn vector<const D: usize>(arguments: &[Argument], i: usize) -> Point<D> {
    match &arguments[i] {
        Argument::Vector(x) => point(x),
        other => panic!("argument {i} must be a vector, got {other:?}"),
    }
}

/// The `i`th argument as points.
fn points<const D: usize>(arguments: &[Argument], i: usize) -> Vec<Point<D>> {
    match &arguments[i] {
        Argument::Points(points) => points.iter().map(|p| point(p)).collect(),
        other => panic!("argument {i} must be points, got {other:?}"),
    }
}

fn point<const D: usize>(components: &[f64]) -> Point<D> {
    palpate_field::Vector(std::array::from_fn(|i| components[i]))
}
