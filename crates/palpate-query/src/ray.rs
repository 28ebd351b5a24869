// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays and balls cast along lines.
//!
//! How far a ball is free along a straight line: conservative advancement, lifted.
//!
//! A value f at the centre of a ball of radius r proves a ball of radius f/L empty, and the centre
//! advances by f/L − r (Hart 1996, for r = 0). Along a near surface such steps are small and many.
//! There the search samples points lifted off the line along the gradient: the balls about them
//! that are proven empty are larger, and the moving ball leaves them later.

use palpate_field::{Point, Shape, Vector};

use crate::certified::{Certified, Limits, Stop};
use crate::error::QueryError;
use crate::sampler::{AT_ONCE, Sampler, Samples, normal, unit};

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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    FreeWay { lower, upper, stop }: FreeWay,
) -> Certified<Option<RayHit<D>>> {
    let best = (stop != Stop::SignKnown && upper.is_finite()).then(|| {
        let point = advance.ray.at(upper);
        let (_, gradient) = advance.sampler.slope(point);
        RayHit { point, normal: normal(gradient) }
    });
    Certified { best, lower, upper, stop, evaluations: advance.sampler.evaluations }
}

/// Heights of lifted points, as shares of the height that gave the longest step before.
const HEIGHTS: [f64; AT_ONCE - 1] = [8.0, 3.0, 1.5, 0.7, 0.3, 0.1, 0.03];

/// The first height, as a share of the line.
const FIRST_HEIGHT: f64 = 0.25;

/// A plain step at least this share of the line long is taken without lifting.
const LONG: f64 = 0.05;

/// So is a step after which the clearance falls to this share or less.
const NEARING: f64 = 0.4;

/// How far a line is free: before `lower` [m]; at `upper` the ball touches, which is infinite if no
/// such place was found, and the end of the line if all of it is free ([`Stop::SignKnown`]).
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeWay {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) stop: Stop,
}

/// What a search about a centre found of the gap between the ball and the surface [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// How often the field was evaluated for it.
    pub(crate) evaluations: u32,
}

impl Gap {
    /// Nothing is known.
    pub(crate) const UNKNOWN: Self =
        Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY, evaluations: 0 };
}

/// A ball that advances along a ray.
pub(crate) struct Advance<'a, const D: usize> {
    pub(crate) sampler: Sampler<'a, D>,
    pub(crate) ray: &'a Ray<D>,
    radius: f64,
    height: f64,
    /// The earliest place where the clearance was found to be at most the tolerance.
    witness: Option<f64>,
}

impl<'a, const D: usize> Advance<'a, D> {
    pub(crate) fn new(sampler: Sampler<'a, D>, ray: &'a Ray<D>, radius: f64) -> Self {
        Self { sampler, ray, radius, height: FIRST_HEIGHT * ray.length(), witness: None }
    }

    /// Advances to the first place where the clearance, the field at the centre less the radius,
    /// is at most the tolerance; for a ball, where the field is a bound, the gap that `gap_at` finds
    /// with the budget that is left.
    pub(crate) fn run(
        &mut self,
        limits: &Limits,
        mut gap_at: impl FnMut(Point<D>, u32) -> Gap,
    ) -> FreeWay {
        let (length, tolerance) = (self.ray.length(), limits.tolerance);
        let (mut free, mut previous, mut is_short) = (0.0, f64::INFINITY, false);
        loop {
            let p = self.ray.at(free);
            let (value, gradient) = self.sampler.slope(p);
            let mut step = self.sampler.free_radius(p, value) - self.radius;
            let mut touches = false;
            if self.is_told_by_values() {
                touches = value - self.radius <= tolerance;
            } else if step <= tolerance {
                let left = limits.budget.saturating_sub(self.sampler.evaluations);
                let gap = gap_at(p, left);
                self.sampler.evaluations += gap.evaluations;
                touches = gap.upper <= tolerance;
                step = step.max(gap.lower);
            }
            if touches {
                return FreeWay { lower: free, upper: free, stop: Stop::Converged };
            }
            let clear = if self.is_told_by_values() { value - self.radius } else { step };
            if self.sampler.evaluations >= limits.budget {
                let upper = self.witness.unwrap_or(f64::INFINITY);
                return FreeWay { lower: free, upper, stop: Stop::BudgetSpent };
            }
            let pays = step >= LONG * length || clear < NEARING * previous;
            let mut ahead = free + step.max(0.0);
            if is_short || !pays {
                is_short = true;
                ahead = ahead.max(self.lifted(free, clear, unit(gradient), limits));
            }
            previous = clear;
            if let Some(witness) = self.witness
                && witness - ahead <= tolerance
            {
                let lower = ahead.min(witness);
                return FreeWay { lower, upper: witness, stop: Stop::Converged };
            }
            if ahead >= length {
                return FreeWay { lower: length, upper: length, stop: Stop::SignKnown };
            }
            is_short &= ahead - free < LONG * length;
            if ahead <= free {
                // The surface is within rounding.
                let upper = self.witness.unwrap_or(f64::INFINITY);
                return FreeWay { lower: free, upper, stop: Stop::RoundingReached };
            }
            free = ahead;
        }
    }

    /// How far the ball is proven free by points lifted off the line at `free`; also looks for a
    /// witness where the tangent plane says that the surface is.
    fn lifted(
        &mut self,
        free: f64,
        clear: f64,
        direction: Vector<f64, D>,
        limits: &Limits,
    ) -> f64 {
        let p = self.ray.at(free);
        let heights = HEIGHTS.map(|share| share * self.height);
        let mut points = [p; AT_ONCE];
        for (point, height) in points.iter_mut().zip(heights) {
            *point += direction * height;
        }
        let along = self.ray.direction();
        let towards = -direction.dot(along);
        let latest = self.witness.unwrap_or(self.ray.length());
        let there = free + clear / towards.max(1e-3) + 0.5 * limits.tolerance;
        let there = if there < latest { there } else { 0.5 * (free + latest) };
        points[AT_ONCE - 1] = self.ray.at(there);
        let values = self.sampler.values(&points);
        if values[AT_ONCE - 1] - self.radius <= limits.tolerance && self.is_told_by_values() {
            self.witness = Some(there);
        }
        let mut ahead = free;
        // If no lifted point gives a longer step, all were far too high.
        self.height *= HEIGHTS[HEIGHTS.len() - 1];
        for ((point, value), height) in points.iter().zip(values).zip(heights) {
            let radius = self.sampler.free_radius(*point, value) - self.radius;
            // |o + t·d − point| < radius, from the origin p at t = 0.
            let offset = p - *point;
            let half = offset.dot(along);
            let rest = offset.dot(offset) - radius * radius;
            if radius > 0.0 && rest < 0.0 {
                let exit = free + ((half * half - rest).sqrt() - half) * (1.0 - 1e-12);
                if exit > ahead {
                    (ahead, self.height) = (exit, height);
                }
            }
        }
        self.height = self.height.min(self.ray.length());
        ahead
    }

    /// Whether a small value proves that the ball touches: for a point by definition, for a ball
    /// where the field is exact.
    fn is_told_by_values(&self) -> bool {
        self.radius == 0.0 || self.sampler.is_exact_outside()
    }
}
