// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid motions and scales.

use crate::error::{LARGEST_LENGTH, ShapeError, Unit};
use crate::field::{Placement, Warp, Warped};
use crate::pose::{Pose, Rotation};
use crate::promise::{Promise, Rounding};
use crate::scalar::{Float, Scalar};
use crate::shape::Shape;
use crate::vector::{Vector, array};

impl<const D: usize> Warp<D, D> for Placement<D> {
    const IS_MOTION: bool = true;

    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        self.to_body(p)
    }

    fn placed(&self, pose: &Pose<D>) -> Option<Self> {
        Some(Self::new(*pose * self.world_from_body))
    }

    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        _p: Vector<T, D>,
        child: T,
        child_gradient: Vector<T, D>,
    ) -> (T, Vector<T, D>) {
        (child, self.gradient_to_world(child_gradient))
    }
}

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

fn check_factor(factor: f64) -> Result<f64, ShapeError> {
    if (1.0 / LARGEST_LENGTH..=LARGEST_LENGTH).contains(&factor) {
        Ok(factor)
    } else {
        Err(ShapeError::number("scale", "positive, from 1e-15 to 1e15", factor, Unit::One))
    }
}

impl<const D: usize> Shape<D> {
    /// The shape moved by `world_from_body`. Every promise but symmetry is kept.
    ///
    /// Motions of a leaf, and motions of motions, become one; those of an operator
    /// go into its children where that costs no more.
    ///
    /// # Errors
    ///
    /// If a number is not finite, or shapes are nested too deeply.
    pub fn placed(self, world_from_body: &Pose<D>) -> Result<Self, ShapeError> {
        world_from_body.check()?;
        if world_from_body.is_identity() {
            return Ok(self);
        }
        self.taking_motion(world_from_body).or_else(|child| {
            let promise = child.promise().placed(world_from_body);
            let depth = child.depth() + 1;
            let map = Placement::new(*world_from_body);
            Self::from_operator(Warped { map, child, promise }, depth)
        })
    }

    /// The shape moved by `offset` [m].
    ///
    /// # Errors
    ///
    /// As [`placed`](Self::placed).
    pub fn translated(self, offset: Vector<f64, D>) -> Result<Self, ShapeError> {
        self.placed(&Pose::translation(offset))
    }

    /// The shape turned about the origin.
    ///
    /// # Errors
    ///
    /// As [`placed`](Self::placed).
    pub fn rotated(self, rotation: Rotation<D>) -> Result<Self, ShapeError> {
        self.placed(&Pose::rotation(rotation))
    }

    /// The shape scaled by `factor` about the origin: `s·f(p/s)`. Every promise
    /// is kept.
    ///
    /// # Errors
    ///
    /// If the factor is not positive, or shapes are nested too deeply.
    pub fn scaled(self, factor: f64) -> Result<Self, ShapeError> {
        let factor = check_factor(factor)?;
        let child = self.promise();
        let size = child.bounds.map_or(0.0, |b| b.radius_about_origin()) * factor;
        let own = Rounding::of_operations(2.0 * child.lipschitz.max(1.0), size);
        let promise = Promise {
            bounds: child.bounds.map(|b| b.scaled([factor; D])),
            region: child.region.map(|ball| crate::bounds::BoundingBall {
                centre: ball.centre * factor,
                radius: ball.radius * factor,
            }),
            reach: child.reach * factor,
            rounding: child.rounding.at(1.0 / factor, 0.0).times(factor).plus(&own),
            ..*child
        };
        let depth = self.depth() + 1;
        let map = UniformScale { factor, inverse: 1.0 / factor };
        let node = Warped { map, child: self, promise };
        Self::from_operator(node, depth)?.in_range(factor)
    }

    /// The shape scaled by `factors[i]` along axis `i`: `min sᵢ · f(pᵢ/sᵢ)`.
    ///
    /// A bound on both sides: no formula keeps distances under a stretch.
    ///
    /// # Errors
    ///
    /// If a factor is not positive, or shapes are nested too deeply.
    pub fn stretched(self, factors: [f64; D]) -> Result<Self, ShapeError> {
        for factor in factors {
            check_factor(factor)?;
        }
        let smallest = factors.iter().fold(f64::INFINITY, |m, f| m.min(*f));
        let child = self.promise();
        let largest = factors.iter().fold(0.0_f64, |m, f| m.max(*f));
        let size = child.bounds.map_or(0.0, |b| b.radius_about_origin()) * largest;
        let own = Rounding::of_operations(2.0 * child.lipschitz.max(1.0), size);
        let promise = Promise {
            bounds: child.bounds.map(|b| b.scaled(factors)),
            above_bounds: false,
            // In stretched space the region is an ellipsoid; a ball within it.
            region: child.region.map(|ball| crate::bounds::BoundingBall {
                centre: Vector(array!(i < D => ball.centre[i] * factors[i])),
                radius: ball.radius * smallest,
            }),
            reach: child.reach * smallest,
            rounding: child.rounding.at(1.0 / smallest, 0.0).times(smallest).plus(&own),
            ..child.bound()
        };
        let depth = self.depth() + 1;
        let map = AxisScale { inverse: factors.map(|f| 1.0 / f), smallest };
        let node = Warped { map, child: self, promise };
        Self::from_operator(node, depth)?.in_range(smallest)
    }

    /// The shape, if scales within scales leave its distances in the range of
    /// numbers, which a look at the farthest point shows.
    fn in_range(self, factor: f64) -> Result<Self, ShapeError> {
        let farthest = self.distance(Vector::constant(LARGEST_LENGTH));
        if farthest.is_finite() {
            return Ok(self);
        }
        let rule = "such that it and the scales within it stay in the range of numbers";
        Err(ShapeError::number("scale", rule, factor, Unit::One))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Ball;

    #[test]
    fn moves_of_a_leaf_become_one_node() -> Result<(), ShapeError> {
        let ball = Shape::<2>::from_kernel(Ball::new(1.0)?);
        let moved = ball.translated(Vector([1.0, 0.0]))?.rotated(Rotation::from_angle(1.0)?)?;
        assert_eq!(moved.depth(), 1);
        Ok(())
    }
}
