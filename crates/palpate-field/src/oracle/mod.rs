// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What tests and documents need of a primitive besides its formula; no part of the interface.
//!
//! A shape is defined by a test whether it contains a point, and by a parametrised boundary,
//! without any formula of the library. The distance to the boundary is found by sampling: coarse
//! where the boundary is far, down to a spacing where it may be nearest.

pub mod kernels;
mod patch;
mod planar;
mod power;
mod spatial;

pub use patch::Patch;

pub(crate) use planar::*;
pub(crate) use power::*;
pub(crate) use spatial::*;

use crate::error::ShapeError;
use crate::kernel::NamedKernel;
use crate::vector::Point;

/// What stands beside the declaration of a primitive, for tests and documents.
pub trait Evidence<const D: usize>: NamedKernel<D> {
    /// An example about 0.1 m wide: what scene files hold under the name.
    const SAMPLE: &'static str;
    /// Its rows in the guide's table of shapes.
    const GUIDE: &'static [Row] = &[];

    /// The shape by its definition.
    fn definition(&self) -> Definition<D>;

    /// Constructions that are refused, for their messages.
    fn refused() -> Vec<Result<Self, ShapeError>> {
        Vec::new()
    }
}

/// A row of the guide's table of shapes.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The name in the well-known lists.
    pub listed_as: &'static str,
    /// The arguments that give the shape.
    pub arguments: &'static str,
    /// The promise in words.
    pub promise: &'static str,
}

impl Row {
    pub(crate) const fn new(
        listed_as: &'static str,
        arguments: &'static str,
        promise: &'static str,
    ) -> Self {
        Self { listed_as, arguments, promise }
    }
}

/// A shape by its definition.
pub struct Definition<const D: usize> {
    pub(crate) contains: Box<dyn Fn(Point<D>) -> bool>,
    pub(crate) boundary: Vec<Patch<D>>,
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

impl<const D: usize> Definition<D> {
    pub(crate) fn new(
        boundary: Vec<Patch<D>>,
        contains: impl Fn(Point<D>) -> bool + 'static,
    ) -> Self {
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
