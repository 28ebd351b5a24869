// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of a ball that moves along a straight line.

use palpate_field::{Point, Shape};

use crate::advance::{Advance, Gap, Way};
use crate::ball::{BallWorkspace, contact_ball};
use crate::certified::{Certified, Limits, Stop};
use crate::contact::Contact;
use crate::error::QueryError;
use crate::ray::Ray;
use crate::sampler::{Sampler, Samples};

/// A gap is searched to this share of the tolerance in the end: then it is within the tolerance, or
/// a step of the rest is free.
const FINEST: f64 = 0.5;

/// A gap is first searched to so many times the last step that was free, and then always this much
/// finer: a coarse search is cheap, and a long step needs no more.
const COARSER: f64 = 8.0;

/// The first place of a ball of a `radius` [m] whose centre moves along `ray` at which the gap
/// between ball and shape, as [`contact_ball`] defines it, is at most `limits.tolerance`.
///
/// The bounds are distances of the centre from the ray's origin [m]: before `lower` the ball is
/// free, which is proven, rounding included; at `upper` it touches, by the contact, of which the
/// shape is body `a`. They are at most the tolerance apart, if the search converged. A ball that is
/// proven free has no contact, both bounds at the ray's end, and [`Stop::SignKnown`]. A ball that
/// touches at first does so at 0. A budget that is spent leaves `upper` infinite, or where the ball
/// is known to touch.
///
/// Where the field is exact outside, the ball advances by lifted samples, as [`cast_ray`] does;
/// where it is a bound, its values say that the ball is free, and a search about the centre that it
/// touches.
///
/// [`cast_ray`]: crate::cast_ray
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
/// use palpate_query::{BallWorkspace, Limits, Ray, cast_ball};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let plate = Shape::from_kernel(Cuboid::new(Vector([2.0, 0.001, 2.0]))?);
/// let down = Ray::new([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 5.0)?;
/// let limits = Limits::new(1e-6);
/// let touch = cast_ball(&plate, &down, 0.25, &limits, &mut BallWorkspace::new())?;
/// assert!(touch.lower <= 0.7495 && (touch.upper - 0.7495).abs() <= 1e-6);
/// let contact = touch.best.ok_or("it touches")?;
/// assert!((contact.normal - Vector([0.0, 1.0, 0.0])).norm() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If the radius or the tolerance is negative, NaN or too large.
#[inline(never)]
pub fn cast_ball<const D: usize>(
    shape: &Shape<D>,
    ray: &Ray<D>,
    radius: f64,
    limits: &Limits,
    workspace: &mut BallWorkspace<D>,
) -> Result<Certified<Option<Contact<D>>>, QueryError> {
    limits.check()?;
    QueryError::check_length(radius)?;
    let mut samples = Samples::new();
    let sampler = Sampler::new(shape, &mut samples, ray.at(0.0).norm(), 0.0);
    let mut advance = Advance::new(sampler, ray, radius);
    let finest = FINEST * limits.tolerance;
    let mut gaps = Gaps { shape, radius, coarse: ray.length(), finest, workspace };
    let way = advance.run(limits, |centre, budget| gaps.at(centre, budget));
    let Way { lower, upper, stop } = way;
    let mut evaluations = advance.sampler.evaluations;
    let best = if stop != Stop::SignKnown && upper.is_finite() {
        let near = limits.with_tolerance(finest);
        let found = contact_ball(shape, ray.at(upper), radius, &near, gaps.workspace)?;
        evaluations += found.evaluations;
        found.best
    } else {
        None
    };
    Ok(Certified { best, lower, upper, stop, evaluations })
}

/// The gaps of a ball at places of its way, where values do not tell them.
struct Gaps<'a, const D: usize> {
    shape: &'a Shape<D>,
    radius: f64,
    /// The tolerance to which a gap is searched first, and at last [m].
    coarse: f64,
    finest: f64,
    workspace: &'a mut BallWorkspace<D>,
}

impl<const D: usize> Gaps<'_, D> {
    /// The gap about a centre, to the first tolerance at which it is known to be positive, or to the
    /// finest.
    fn at(&mut self, centre: Point<D>, budget: u32) -> Gap {
        let (mut tolerance, mut gap) = (self.coarse.max(self.finest), Gap::UNKNOWN);
        loop {
            let left = budget.saturating_sub(gap.evaluations);
            let limits = Limits::new(tolerance).with_budget(left);
            let found = contact_ball(self.shape, centre, self.radius, &limits, self.workspace);
            // A point of a ray is in range.
            let Ok(found) = found else { return gap };
            gap = Gap {
                lower: gap.lower.max(found.lower),
                upper: gap.upper.min(found.upper),
                evaluations: gap.evaluations + found.evaluations,
            };
            let is_known = gap.lower >= self.finest || gap.upper <= self.finest;
            if is_known || tolerance <= self.finest || found.stop.is_early() {
                self.coarse = COARSER * gap.lower.max(0.0);
                return gap;
            }
            tolerance = (tolerance / COARSER).max(self.finest);
        }
    }
}
