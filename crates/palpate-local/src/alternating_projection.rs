// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Projections on two bodies in turns: memoir 3.3, after Liu et al. (2024).

use palpate_field::Point;
use palpate_query::{DistanceBound, Placed, QueryError};

use crate::{Descent, check_start};

/// Newton steps of a projection at most.
const PROJECTION: u32 = 16;

/// How far past the surface of the second body a step goes, in tolerances. A step that ends at
/// the surface never enters; one that goes past by less than a tolerance would look like the end of
/// the search.
const PAST: f64 = 4.0;

/// Moves a point onto the first body, along the gradient of the second, and back onto the
/// first, until it is in both or stays where it is.
///
/// The step along the gradient leads to the surface of an exact field, and four tolerances past
/// it: the constant step of the memoir goes to and fro, and one that ends at the surface never
/// enters. A projection on a bound takes several steps. A point is in both where both values are
/// at most zero, so bodies may just touch. Where they barely do, rounds become ever smaller, and
/// 64 may not be enough.
///
/// An upper bound, without a proof. A point in both is a witness that they overlap and
/// says nothing of how much; that none was found says nothing. Of two pairs of balls one
/// alone overlaps, and the start decides:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_local::AlternatingProjection;
/// use palpate_query::{Limits, PairWorkspace, overlap};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let two = |apart: f64| {
///     let ball = |x: f64| Shape::from_kernel(Ball::new(0.5)?).translated(Vector([x, 0.0]));
///     Shape::union([ball(-apart)?, ball(apart)?])
/// };
/// let a = two(2.0)?;
/// let b = two(2.0)?.translated(Vector([0.3, 1.0]))?;
/// let far = Shape::union([b, Shape::from_kernel(Ball::new(0.1)?).translated(Vector([2.4, 0.0]))?])?;
/// let method = AlternatingProjection::default();
/// let found = method.descend(&a, &far, Vector([-1.8, 0.4]), 1e-6)?;
/// let proven = overlap(&a, &far, &Limits::new(1e-4), &mut PairWorkspace::new())?;
/// assert!(found.value > 0.0 && proven.is_hit() == Some(true));
/// let once = AlternatingProjection { steps: 1, ..method };
/// let first = once.descend(&a, &far, Vector([-1.8, 0.4]), 1e-6)?;
/// assert_eq!(first.steps, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlternatingProjection {
    /// Steps along the gradient of the second body at most; 64.
    pub steps: u32,
}

impl Default for AlternatingProjection {
    fn default() -> Self {
        Self { steps: 64 }
    }
}

impl AlternatingProjection {
    /// The search for a point in both bodies from `start` [m], until a round moves the
    /// point by less than `tolerance` [m].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, a pose is not finite, or the
    /// tolerance is negative.
    pub fn descend<'a, const D: usize>(
        &self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        start: Point<D>,
        tolerance: f64,
    ) -> Result<Descent<D>, QueryError> {
        check_start(start, tolerance)?;
        let [a, b] = DistanceBound::of_both(a, b)?;
        let value = |p| a.distance_gradient(p).0.max(b.distance_gradient(p).0);
        let visit = |descent: &mut Descent<D>, p| {
            descent.evaluations += 4;
            descent.visit(p, value(p));
        };
        let mut descent = Descent::from_start(start, value(start), 4);
        let mut p = project(&a, start, tolerance, &mut descent);
        visit(&mut descent, p);
        while descent.value > 0.0 && descent.steps < self.steps {
            descent.steps += 1;
            let there = onto(&b, p, PAST * tolerance, &mut descent);
            visit(&mut descent, there);
            let back = project(&a, there, tolerance, &mut descent);
            visit(&mut descent, back);
            if (back - p).norm() < tolerance {
                break;
            }
            p = back;
        }
        Ok(descent)
    }
}

/// The point after a Newton step onto a body, and `past` its surface as far as the gradient
/// tells [m]; the same if it is in it, or its gradient vanishes.
fn onto<const D: usize>(
    body: &DistanceBound<'_, D>,
    p: Point<D>,
    past: f64,
    descent: &mut Descent<D>,
) -> Point<D> {
    let (value, gradient) = body.distance_gradient(p);
    descent.evaluations += 2;
    let squared = gradient.dot(gradient);
    let is_out = value > 0.0 && squared > 0.0;
    if is_out { p - gradient * (value / squared + past / squared.sqrt()) } else { p }
}

/// The point on the body that Newton steps lead to, up to a hundredth of the tolerance.
fn project<const D: usize>(
    body: &DistanceBound<'_, D>,
    p: Point<D>,
    tolerance: f64,
    descent: &mut Descent<D>,
) -> Point<D> {
    let mut here = p;
    for _ in 0..PROJECTION {
        let next = onto(body, here, 0.0, descent);
        let moved = (next - here).norm();
        here = next;
        if moved <= 0.01 * tolerance {
            break;
        }
    }
    here
}
