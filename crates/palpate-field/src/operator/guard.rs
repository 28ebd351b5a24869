// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The guard: a field raised to the distance to its own box.

use crate::bounds::{Aabb, Bounds};
use crate::error::ShapeError;
use crate::field::{Remap, Remapped, SharedField};
use crate::promise::{Promise, Rounding};
use crate::scalar::Scalar;
use crate::vector::Vector;

/// `max(f, distance to the box)`.
#[derive(Debug)]
pub(crate) struct Guard<const D: usize> {
    centre: Vector<f64, D>,
    half_extents: Vector<f64, D>,
}

impl<const D: usize> Guard<D> {
    fn new(aabb: &Aabb<D>) -> Self {
        Self { centre: aabb.centre(), half_extents: aabb.half_extents() }
    }
}

impl<const D: usize> Remap<D> for Guard<D> {
    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, D>, child: S) -> S {
        let q = (p - Vector::of(&self.centre.0)).abs() - Vector::of(&self.half_extents.0);
        child.max(S::orthant(q.0))
    }
}

/// The same field with values of at least the distance to its box.
///
/// A field that is only a bound may be small far from its shape; an operator
/// that moves the surface outwards would find a surface there. Inside the
/// box nothing changes: the distance to it is negative there, and deeper than
/// the shape's own, which lies in it.
pub(crate) fn guarded<const D: usize>(
    child: SharedField<D>,
) -> Result<SharedField<D>, ShapeError> {
    let promise = child.promise();
    let (Some(bounds), false) = (promise.bounds, promise.above_bounds) else {
        return Ok(child);
    };
    let size = bounds.radius_about_origin();
    let promise = Promise {
        // The ball may be tighter than the box; the guard knows the box alone.
        bounds: Some(Bounds::of_box(bounds.aabb)),
        above_bounds: true,
        rounding: promise.rounding.or(&Rounding::of_operations(8.0, size)),
        ..*promise
    };
    Remapped::shared(Guard::new(&bounds.aabb), child, promise)
}
