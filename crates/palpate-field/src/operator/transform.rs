// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scales.

use crate::bounds::BoundingBall;
use crate::error::{LARGEST_LENGTH, ShapeError, Unit};
use crate::field::{SharedField, Warp, Warped};
use crate::promise::{Promise, Rounding};
use crate::scalar::{Float, Scalar};
use crate::vector::{Vector, array};

/// `s·f(p / s)`.
#[derive(Debug)]
pub(crate) struct UniformScale {
    factor: f64,
    inverse: f64,
}

impl<const D: usize> Warp<D, D> for UniformScale {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        p.scale(self.inverse)
    }

    #[inline(always)]
    fn value<S: Scalar>(&self, _p: Vector<S, D>, child: S) -> S {
        child.scale(self.factor)
    }

    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        _p: Vector<T, D>,
        child: T,
        child_gradient: Vector<T, D>,
    ) -> (T, Vector<T, D>) {
        // The factors s and 1/s cancel.
        (child.scale(self.factor), child_gradient)
    }
}

/// `min sᵢ · f(pᵢ / sᵢ)`.
#[derive(Debug)]
pub(crate) struct AxisScale<const D: usize> {
    inverse: [f64; D],
    smallest: f64,
}

impl<const D: usize> Warp<D, D> for AxisScale<D> {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        Vector(array!(i < D => p.0[i].scale(self.inverse[i])))
    }

    #[inline(always)]
    fn value<S: Scalar>(&self, _p: Vector<S, D>, child: S) -> S {
        child.scale(self.smallest)
    }
}

/// The farthest that a scaled shape may be from the origin [m]: a shape of the largest length, at
/// the largest coordinates.
const FARTHEST: f64 = 10.0 * LARGEST_LENGTH;

fn check_factor(factor: f64) -> Result<f64, ShapeError> {
    if (1.0 / LARGEST_LENGTH..=LARGEST_LENGTH).contains(&factor) {
        Ok(factor)
    } else {
        Err(ShapeError::number("scale", "positive, from 1e-15 to 1e15", factor, Unit::One))
    }
}

/// How far what a promise bounds is from the origin, after it is scaled [m]. Beyond all lengths that
/// questions accept, a shape could not be asked about.
fn size_of<const D: usize>(of: &Promise<D>, factor: f64) -> Result<f64, ShapeError> {
    let size = of.bounds.map_or(0.0, |bounds| bounds.radius_about_origin()) * factor;
    if size <= FARTHEST {
        return Ok(size);
    }
    let rule = "such that the shape stays within 1e16 m of the origin";
    Err(ShapeError::number("scale", rule, factor, Unit::One))
}

/// The `child` scaled by `factor` about the origin.
pub(crate) fn scaled<const D: usize>(
    child: SharedField<D>,
    factor: f64,
) -> Result<SharedField<D>, ShapeError> {
    let factor = check_factor(factor)?;
    let of = child.promise();
    let size = size_of(of, factor)?;
    let own = Rounding::of_operations(2.0 * of.lipschitz.max(1.0), size);
    let promise = Promise {
        bounds: of.bounds.map(|b| b.scaled([factor; D])),
        region: of.region.map(|ball| BoundingBall {
            centre: ball.centre * factor,
            radius: ball.radius * factor,
        }),
        reach: of.reach * factor,
        deviation: of.deviation.map(|deviation| deviation.times(factor)),
        rounding: of.rounding.at(1.0 / factor, 0.0).times(factor).plus(&own),
        ..*of
    };
    let map = UniformScale { factor, inverse: 1.0 / factor };
    in_range(Warped::shared(map, child, promise)?, factor)
}

/// The `child` scaled by `factors[i]` along axis `i`.
pub(crate) fn stretched<const D: usize>(
    child: SharedField<D>,
    factors: [f64; D],
) -> Result<SharedField<D>, ShapeError> {
    for factor in factors {
        check_factor(factor)?;
    }
    let smallest = factors.iter().fold(f64::INFINITY, |m, f| m.min(*f));
    let of = child.promise();
    let largest = factors.iter().fold(0.0_f64, |m, f| m.max(*f));
    let size = size_of(of, largest)?;
    let own = Rounding::of_operations(2.0 * of.lipschitz.max(1.0), size);
    let promise = Promise {
        bounds: of.bounds.map(|b| b.scaled(factors)),
        above_bounds: false,
        // In stretched space the region is an ellipsoid; a ball within it.
        region: of.region.map(|ball| BoundingBall {
            centre: Vector(array!(i < D => ball.centre[i] * factors[i])),
            radius: ball.radius * smallest,
        }),
        reach: of.reach * smallest,
        deviation: of.deviation.map(|deviation| deviation.times(smallest)),
        rounding: of.rounding.at(1.0 / smallest, 0.0).times(smallest).plus(&own),
        ..of.bound()
    };
    let map = AxisScale { inverse: factors.map(|f| 1.0 / f), smallest };
    in_range(Warped::shared(map, child, promise)?, smallest)
}

/// The `field`, if scales within scales leave its distances in the range of
/// numbers, which a look at the farthest point shows.
fn in_range<const D: usize>(
    field: SharedField<D>,
    factor: f64,
) -> Result<SharedField<D>, ShapeError> {
    let (x, y, z) = Vector::<f64, D>::constant(LARGEST_LENGTH).coordinates();
    let farthest: f64 = field.distance(x, y, z);
    if farthest.is_finite() {
        return Ok(field);
    }
    let rule = "such that it and the scales within it stay in the range of numbers";
    Err(ShapeError::number("scale", rule, factor, Unit::One))
}
