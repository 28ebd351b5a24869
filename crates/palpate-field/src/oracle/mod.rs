// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of primitives, for tests.
//!
//! What tests and documents need of a primitive besides its formula; no part of the interface.
//!
//! A shape is defined by a test whether it contains a point, and by a parametrised boundary,
//! without any formula of the library. The distance to the boundary is found by sampling: coarse
//! where the boundary is far, down to a spacing where it may be nearest.

use crate::error::ShapeError;
use crate::kernel::NamedKernel;
use crate::vector::Point;

pub use patch::Patch;
pub(crate) use planar::*;
pub(crate) use spatial::*;

pub mod kernels;
mod patch;
mod planar;
mod spatial;

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

/// `(Σ|xᵢ|^e)^(1/e)`, computed as written.
pub(crate) fn norm<const D: usize>(x: Point<D>, exponent: f64) -> f64 {
    x.0.iter().map(|x| x.abs().powf(exponent)).sum::<f64>().powf(1.0 / exponent)
}

/// The point of the unit ball's surface in a direction of length one.
pub(crate) fn on_ball<const D: usize>(direction: Point<D>, exponent: f64) -> Point<D> {
    direction * (1.0 / norm(direction, exponent))
}

/// The largest ratio of the motion of the point on the ball to that of its direction.
///
/// With the norm `n` of the direction, the point moves `1/n` times as far across the direction.
/// Along it the ratio is `√(1 − n²)/n²`, because the gradient of the norm is at most one long
/// and its part along the direction is `n`. Together this is `1/n²`, which is largest where all
/// components are equal.
pub(crate) fn speed<const D: usize>(exponent: f64) -> f64 {
    (D as f64).powf(1.0 - 2.0 / exponent)
}

pub(crate) fn bound<const D: usize>(definition: Definition<D>) -> Definition<D> {
    Definition { outside: Outside::Bound, ..definition }
}
