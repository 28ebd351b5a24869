// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Smooth union: the crease between shapes filled.

use std::marker::PhantomData;

use super::boolean::{combined, promise_of_union};
use crate::error::{ShapeError, Unit, positive};
use crate::field::Combine;
use crate::promise::{Promise, Rounding};
use crate::scalar::{Blend, Cubic, Quadratic, Scalar};
use crate::shape::Shape;

/// Which profile fills the crease of a smooth union.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smooth {
    /// [`Quadratic`]: reach 4 times the width.
    Quadratic,
    /// [`Cubic`]: reach 6 times the width, rounder at the ends of the fill.
    Cubic,
}

#[derive(Clone, Debug)]
pub(crate) struct SmoothMin<B> {
    reach: f64,
    profile: PhantomData<B>,
}

impl<B: Blend + std::fmt::Debug> Combine for SmoothMin<B> {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.smooth_min::<B>(b, self.reach)
    }
}

/// A bound on both sides; the surface moves outwards by at most the width.
fn promise<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
    width: f64,
    reach: f64,
) -> Promise<D> {
    let union = promise_of_union(a, b);
    let blend = Rounding::of_operations(6.0, reach);
    Promise {
        bounds: union.bounds.map(|bounds| bounds.grown(width)),
        reach: union.reach.max(reach),
        rounding: union.rounding.plus(&blend),
        ..union.bound()
    }
}

impl<const D: usize> Shape<D> {
    /// The union of `shapes` with the creases between them filled.
    ///
    /// `width` is the fill where two distances are equal [m]: the surface moves
    /// outwards by at most that. The fill begins where two distances differ by
    /// less than the reach, [`Blend::REACH_OVER_WIDTH`] times the width. More
    /// than two shapes are folded in their order.
    ///
    /// A bound on both sides, with Lipschitz constant 1 for exact shapes and
    /// bounds. Shapes whose values may fall below the distance to their box are
    /// guarded by it first, so that the bounds hold.
    ///
    /// # Errors
    ///
    /// If the width is not positive, there are no shapes, or they are nested too
    /// deeply.
    pub fn smooth_union(
        shapes: impl IntoIterator<Item = Self>,
        profile: Smooth,
        width: f64,
    ) -> Result<Self, ShapeError> {
        match profile {
            Smooth::Quadratic => Self::blended::<Quadratic>(shapes, width),
            Smooth::Cubic => Self::blended::<Cubic>(shapes, width),
        }
    }

    fn blended<B: Blend + std::fmt::Debug>(
        shapes: impl IntoIterator<Item = Self>,
        width: f64,
    ) -> Result<Self, ShapeError> {
        let width = positive("width", width, Unit::Metre)?;
        let reach = width * B::REACH_OVER_WIDTH;
        let children = shapes.into_iter().map(Self::guarded).collect::<Result<_, _>>()?;
        let operation = SmoothMin::<B> { reach, profile: PhantomData };
        combined(operation, "smooth_union", children, |a, b| promise(a, b, width, reach))
    }
}
