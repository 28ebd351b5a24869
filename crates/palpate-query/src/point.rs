// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A field at a point, with what its value promises; whether a shape has any point.

use palpate_field::{Point, Pose, Quality, Shape, Vector};

use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::pair::{PairWorkspace, overlap};
use crate::sampler::{Placed, normal};

/// The value of a field at a point, with what it promises there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AtPoint<const D: usize> {
    /// The point [m].
    pub point: Point<D>,
    /// The value of the field [m]. `quality` says whether it is the distance.
    pub distance: f64,
    /// The gradient of the field.
    pub gradient: Vector<f64, D>,
    /// The gradient's unit vector; `None` where it is shorter than 1e-6.
    pub normal: Option<Vector<f64, D>>,
    /// Where the promise is exact the nearest point of the surface, else a zero of the field
    /// nearby. `None` if none was found [m].
    pub surface: Option<Point<D>>,
    /// `true` if the value is negative.
    pub is_inside: bool,
    /// The radius of a ball that is sure to hold no surface, rounding included [m].
    pub safe_radius: f64,
    /// What the distance promises on this side of the surface.
    pub quality: Quality,
    /// The largest rounding of the value [m].
    pub rounding: f64,
}

impl<const D: usize> AtPoint<D> {
    /// The answer at a point where the distance [m] and the gradient are known, as
    /// [`Shape::block_gradients`] gives them for many.
    #[must_use]
    pub fn of_slope(
        shape: &Shape<D>,
        point: Point<D>,
        distance: f64,
        gradient: Vector<f64, D>,
    ) -> Self {
        let promise = shape.promise();
        let rounding = promise.rounding.within(point.norm());
        let is_inside = distance < 0.0;
        Self {
            point,
            distance,
            gradient,
            normal: normal(gradient),
            surface: shape.surface_point(point),
            is_inside,
            safe_radius: (promise.safe_radius(point, distance) - rounding).max(0.0),
            quality: if is_inside { promise.inside } else { promise.outside },
            rounding,
        }
    }
}

/// Evaluates a field at `p` [m] with its gradient, and finds the surface next to it.
///
/// ```
/// use palpate_field::{Quality, Shape, Vector, kernel::Ball};
/// use palpate_query::evaluate_point;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// let answer = evaluate_point(&ball, Vector([0.0, 2.0]))?;
/// assert_eq!((answer.distance, answer.is_inside), (1.5, false));
/// assert_eq!(answer.normal, Some(Vector([0.0, 1.0])));
/// assert_eq!(answer.surface, Some(Vector([0.0, 0.5])));
/// assert_eq!(answer.quality, Quality::Exact);
/// assert!(1.5 - 1e-14 < answer.safe_radius && answer.safe_radius < 1.5);
/// assert!(evaluate_point(&ball, Vector([0.0, f64::NAN])).is_err());
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If a coordinate is not finite or beyond 1e15 m.
pub fn evaluate_point<const D: usize>(
    shape: &Shape<D>,
    p: impl Into<Point<D>>,
) -> Result<AtPoint<D>, QueryError> {
    let p = p.into();
    QueryError::check_point("point", p)?;
    let (distance, gradient) = shape.distance_gradient(p);
    Ok(AtPoint::of_slope(shape, p, distance, gradient))
}

/// The box around a shape is grown by this share of its size, so that its own surface decides nothing.
const GROWN: f64 = 1e-3;

/// Whether a shape has any point, in [`Certified::is_hit`]: whether its field is zero or less
/// anywhere. The first shape of a difference may be gone with all that is cut away.
///
/// The question is whether the shape [overlaps](overlap) the box around it, which holds all of
/// its points.
///
/// ```
/// use palpate_field::Shape;
/// use palpate_query::{Limits, PairWorkspace, any_point};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut workspace = PairWorkspace::new();
/// let (large, small) = (Shape::sphere(0.03)?, Shape::sphere(0.02)?);
/// let mut has_points = |shape: &Shape<3>| {
///     any_point(shape, &Limits::new(1e-9), &mut workspace).map(|answer| answer.is_hit())
/// };
/// assert_eq!(has_points(&(&large - &small))?, Some(true));
/// assert_eq!(has_points(&(&small - &large))?, Some(false));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If the shape is not bounded, or the tolerance is NaN or out of range.
#[inline(never)]
pub fn any_point<const D: usize>(
    shape: &Shape<D>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Point<D>>, QueryError> {
    let Some(bounds) = shape.promise().bounds else { return Err(QueryError::Unbounded) };
    let size = bounds.aabb.half_extents().norm();
    // Far from the origin, rounding may leave the box itself without a volume.
    let rounding = shape.promise().rounding.within(bounds.aabb.radius_about_origin());
    let aabb = bounds.aabb.grown((GROWN * size).max(rounding));
    let around = Shape::cuboid(aabb.half_extents() * 2.0);
    let around = around.map_err(|_| QueryError::Length { value: size })?;
    let around = Placed::new(&around, Pose::translation(aabb.centre()));
    Ok(overlap(shape, around, limits, workspace)?.map(|nearest| nearest.point))
}

#[cfg(test)]
mod tests {
    use palpate_field::kernel::{Ball, Cuboid};

    use super::*;

    #[test]
    fn a_union_is_a_bound_inside_and_exact_outside() -> Result<(), Box<dyn std::error::Error>> {
        let a = Shape::from_kernel(Ball::new(0.3)?);
        let b = a.clone().translated(Vector([0.4, 0.0, 0.0]))?;
        let both = Shape::union([a, b])?;
        let inside = evaluate_point(&both, Vector([0.2, 0.0, 0.0]))?;
        assert_eq!((inside.is_inside, inside.quality), (true, Quality::Bound));
        assert!((inside.distance + 0.1).abs() < 1e-15);
        assert!(0.1 - 1e-14 < inside.safe_radius && inside.safe_radius < 0.1);
        let outside = evaluate_point(&both, Vector([0.0, 0.7, 0.0]))?;
        assert_eq!((outside.is_inside, outside.quality), (false, Quality::Exact));
        assert!((outside.distance - 0.4).abs() < 1e-15);
        Ok(())
    }

    /// The same as the shape says, and as its parts say of each other.
    #[test]
    fn the_surface_is_no_nearer_than_the_safe_radius() -> Result<(), Box<dyn std::error::Error>>
    {
        let stretched = Shape::from_kernel(Cuboid::new(Vector([0.3, 0.5]))?)
            .stretched([1.0, 3.0])?
            .translated(Vector([0.1, -0.2]))?;
        for i in 0..200 {
            let (x, y) = (f64::from(i % 20) * 0.1 - 1.0, f64::from(i / 20) * 0.3 - 1.4);
            let answer = evaluate_point(&stretched, Vector([x, y]))?;
            assert_eq!(answer.distance, stretched.distance(answer.point));
            assert_eq!(answer.safe_radius, stretched.safe_radius(answer.point));
            if let Some(surface) = answer.surface {
                assert!((surface - answer.point).norm() >= answer.safe_radius);
                assert!(stretched.distance(surface).abs() <= 2.0 * answer.rounding);
            }
        }
        Ok(())
    }
}
