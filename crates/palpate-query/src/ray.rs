// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first surface along a ray; none is skipped.

use palpate_field::{Point, Shape, Vector};

use crate::advance::{Advance, Gap, Way};
use crate::certified::{Certified, Limits, Stop};
use crate::error::QueryError;
use crate::sampler::{Sampler, Samples, normal};

/// A part of a straight line: from `origin` in a `direction` of length one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<const D: usize> {
    origin: Point<D>,
    direction: Vector<f64, D>,
    length: f64,
}

impl<const D: usize> Ray<D> {
    /// The ray from `origin` along `direction`, whose length does not matter, `length`
    /// long [m].
    ///
    /// # Errors
    ///
    /// If a number is not finite or beyond 1e15, the direction is zero, or the length
    /// is negative.
    pub fn new(
        origin: impl Into<Point<D>>,
        direction: impl Into<Vector<f64, D>>,
        length: f64,
    ) -> Result<Self, QueryError> {
        let (origin, direction) = (origin.into(), direction.into());
        for (what, numbers) in [("origin", origin), ("direction", direction)] {
            QueryError::check_point(what, numbers)?;
        }
        let largest = direction.0.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if largest == 0.0 {
            return Err(QueryError::NoDirection);
        }
        QueryError::check_length(length)?;
        // Divided by the largest first: squares may underflow, and its reciprocal may overflow.
        let direction = Vector(direction.0.map(|x| x / largest));
        Ok(Self { origin, direction: direction * (1.0 / direction.norm()), length })
    }

    /// How long the ray is [m].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The direction, of length one.
    #[must_use]
    pub fn direction(&self) -> Vector<f64, D> {
        self.direction
    }

    /// The point at a distance from the origin [m].
    #[must_use]
    pub fn at(&self, distance: f64) -> Point<D> {
        self.origin + self.direction * distance
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RayHit<const D: usize> {
    /// The point [m].
    pub point: Point<D>,
    /// The gradient's unit vector there; `None` where it is shorter than 1e-6.
    pub normal: Option<Vector<f64, D>>,
}

/// The first point of a ray at which the field is at most `limits.tolerance`.
///
/// The bounds are distances from the origin [m]: before `lower` the field is positive,
/// which is proven; at `upper` it is at most the tolerance. They are at most the
/// tolerance apart, if the search converged. A ray proven free has no hit, both bounds
/// at its end, and [`Stop::SignKnown`]. A ray that starts inside hits at 0.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, Ray, Stop, cast_ray};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(1.0)?);
/// let limits = Limits::new(1e-9);
/// let across = Ray::new(Vector([-3.0, 0.6]), Vector([1.0, 0.0]), 10.0)?;
/// let first = cast_ray(&ball, &across, &limits)?;
/// assert!(first.lower <= 2.2 && 2.2 - 1e-8 < first.upper && first.upper < 2.2 + 1e-8);
///
/// let past = Ray::new(Vector([-3.0, 1.000_001]), Vector([1.0, 0.0]), 10.0)?;
/// let free = cast_ray(&ball, &past, &limits)?;
/// assert_eq!((free.best, free.stop), (None, Stop::SignKnown));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If the tolerance is negative, NaN or too large.
#[inline(never)]
pub fn cast_ray<const D: usize>(
    shape: &Shape<D>,
    ray: &Ray<D>,
    limits: &Limits,
) -> Result<Certified<Option<RayHit<D>>>, QueryError> {
    limits.check()?;
    let mut samples = Samples::new();
    let sampler = Sampler::new(shape, &mut samples, ray.origin.norm(), 0.0);
    let mut advance = Advance::new(sampler, ray, 0.0);
    let way = advance.run(limits, |_, _| Gap::UNKNOWN);
    Ok(hit(&mut advance, way))
}

/// The answer of a ray that has advanced.
fn hit<const D: usize>(
    advance: &mut Advance<'_, D>,
    Way { lower, upper, stop }: Way,
) -> Certified<Option<RayHit<D>>> {
    let best = (stop != Stop::SignKnown && upper.is_finite()).then(|| {
        let point = advance.ray.at(upper);
        let (_, gradient) = advance.sampler.slope(point);
        RayHit { point, normal: normal(gradient) }
    });
    Certified { best, lower, upper, stop, evaluations: advance.sampler.evaluations }
}
