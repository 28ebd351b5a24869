// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sums of two fields: displacement and morphing.

use super::boolean::{combined, joined, promise_of_union};
use crate::error::{ShapeError, Unit, positive};
use crate::field::Combine;
use crate::promise::{Promise, Quality, Rounding};
use crate::scalar::Scalar;
use crate::shape::Shape;

/// `a − clamp(b, −h, h)`.
#[derive(Clone, Debug)]
pub(crate) struct Displacement {
    height: f64,
}

impl Combine for Displacement {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a - b.clamp(-self.height, self.height)
    }
}

/// `(1 − t)·a + t·b`.
#[derive(Clone, Debug)]
pub(crate) struct Morph {
    weights: [f64; 2],
}

impl Combine for Morph {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        S::weighted_sum([a, b], &self.weights)
    }
}

/// As steep as both together; the surface moves by at most the height.
fn promise_of_displacement<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
    height: f64,
) -> Promise<D> {
    let size = a.bounds.map_or(0.0, |bounds| bounds.radius_about_origin()) + height;
    Promise {
        outside: Quality::Lipschitz,
        inside: Quality::Lipschitz,
        lipschitz: (a.lipschitz + b.lipschitz) * (1.0 + f64::EPSILON),
        bounds: a.bounds.map(|bounds| bounds.grown(height)),
        has_interior: true,
        rounding: a.rounding.plus(&b.rounding).plus(&Rounding::of_operations(2.0, size)),
        ..joined(a, b)
    }
}

fn promise_of_morph<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
    weights: [f64; 2],
) -> Promise<D> {
    let union = promise_of_union(a, b);
    let size = union.bounds.map_or(0.0, |bounds| bounds.radius_about_origin());
    let quality = a.outside.and(a.inside).and(b.outside).and(b.inside).bounded();
    Promise {
        outside: quality,
        inside: quality,
        lipschitz: (weights[0] * a.lipschitz + weights[1] * b.lipschitz)
            * (1.0 + 4.0 * f64::EPSILON),
        rounding: a.rounding.or(&b.rounding).plus(&Rounding::of_operations(4.0, size)),
        ..union
    }
}

impl<const D: usize> Shape<D> {
    /// The shape with its surface moved by another field, outwards where that is
    /// positive, by at most `height` [m]: `f − clamp(g, −h, h)`.
    ///
    /// Distances are no bounds, but at most as steep as both fields together.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::{Ball, HalfSpace}};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    /// let hollow = Shape::from_kernel(Ball::new(0.1)?);
    /// let dented = floor.displaced(hollow, 0.02)?;
    /// assert_eq!(dented.distance(Vector([0.0, 0.0])), 0.02);
    /// assert_eq!(dented.distance(Vector([0.5, 0.0])), -0.02);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the height is not positive, or shapes are nested too deeply.
    pub fn displaced(self, by: Self, height: f64) -> Result<Self, ShapeError> {
        let height = positive("height", height, Unit::Metre)?;
        let rule = |a: &Promise<D>, b: &Promise<D>| promise_of_displacement(a, b, height);
        combined(Displacement { height }, "displace", vec![self.guarded()?, by], rule)
    }

    /// A shape on the way from this one (`progress` 0) to another (1): the weighted
    /// mean of both fields.
    ///
    /// A bound on both sides.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::Ball};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let small = Shape::from_kernel(Ball::new(0.1)?);
    /// let large = Shape::from_kernel(Ball::new(0.3)?);
    /// let between = small.morphed(large, 0.5)?;
    /// assert!((between.distance(Vector([0.5, 0.0])) - 0.3).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the progress is not from 0 to 1, or shapes are nested too deeply.
    pub fn morphed(self, into: Self, progress: f64) -> Result<Self, ShapeError> {
        if !(0.0..=1.0).contains(&progress) {
            return Err(ShapeError::number("morph", "from 0 to 1", progress, Unit::One));
        }
        let weights = [1.0 - progress, progress];
        let rule = |a: &Promise<D>, b: &Promise<D>| promise_of_morph(a, b, weights);
        combined(Morph { weights }, "morph", vec![self, into], rule)
    }
}
