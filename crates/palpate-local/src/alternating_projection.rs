// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches between two bodies.

use palpate_field::{Point, Vector};
use palpate_query::{DistanceBound, Element, Placed, QueryError, minimax_step};

use crate::Descent;
use crate::descent::Step;

/// Both values at a point, with their gradients.
type Slopes<const D: usize> = [(f64, Vector<f64, D>); 2];

/// The larger of both values.
fn larger<const D: usize>([(a, _), (b, _)]: Slopes<D>) -> f64 {
    a.max(b)
}

/// Two bodies that a search asks together.
struct Pair<'a, const D: usize> {
    bodies: [DistanceBound<'a, D>; 2],
    /// Where the search goes on from.
    here: Slopes<D>,
}

impl<'a, const D: usize> Pair<'a, D> {
    /// The bodies, and a search from `start` with the larger of both values there. Refuses a start or a
    /// tolerance that cannot be computed with.
    fn begin(
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        start: Point<D>,
        tolerance: f64,
    ) -> Result<(Self, Descent<D>), QueryError> {
        QueryError::check_point("start", start)?;
        QueryError::check_length(tolerance)?;
        let bodies = DistanceBound::of_both(a, b)?;
        let here = bodies.each_ref().map(|body| body.distance_gradient(start));
        Ok((Self { bodies, here }, Descent::from_start(start, larger(here), 4)))
    }

    /// Both values and gradients at a point, counted.
    fn slopes(&self, p: Point<D>, descent: &mut Descent<D>) -> Slopes<D> {
        descent.evaluations += 4;
        self.bodies.each_ref().map(|body| body.distance_gradient(p))
    }
}

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
        let (pair, mut descent) = Pair::begin(a, b, start, tolerance)?;
        let visit = |descent: &mut Descent<D>, p| {
            let value = larger(pair.slopes(p, descent));
            descent.visit(p, value);
        };
        let [a, b] = &pair.bodies;
        let mut p = project(a, start, tolerance, &mut descent);
        visit(&mut descent, p);
        Ok(descent.run(self.steps, |descent| {
            let is_out = descent.value > 0.0;
            if !is_out {
                return Step::None;
            }
            let there = onto(b, p, PAST * tolerance, descent);
            visit(descent, there);
            let back = project(a, there, tolerance, descent);
            visit(descent, back);
            let is_still = (back - p).norm() < tolerance;
            p = back;
            if is_still { Step::Last } else { Step::Next }
        }))
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

/// What steps are multiplied by after one that leads down, and after one that does not.
const GROW: f64 = 1.5;
const SHRINK: f64 = 0.25;

/// Goes where the larger of both tangent planes, plus a parabola, is least: along the
/// gradient of the farther body, and between both where they are equally far.
///
/// One gradient at a time, as in the memoir's loop, leads to and fro across the ridge on
/// which both values are equal, and on that ridge the minimum lies. Ends inside both
/// bodies at their widest overlap, not at the first point in both.
///
/// An upper bound, without a proof: it finds the overlap next to its start, or none. As
/// [`AlternatingProjection`](crate::AlternatingProjection)'s example, of two dents in
/// which balls lie it finds the one it starts in:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_local::MinimaxProximal;
/// use palpate_query::{Limits, PairWorkspace, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = |x: f64, y: f64| Shape::from_kernel(Ball::new(0.5)?).translated(Vector([x, y]));
/// let below = Shape::union([ball(-2.0, 0.0)?, ball(2.0, 0.0)?])?;
/// let above = Shape::union([ball(-2.0, 1.1)?, ball(2.0, 0.9)?])?;
/// let found = MinimaxProximal::default().descend(&below, &above, Vector([-1.8, 0.4]), 1e-9)?;
/// assert!((found.value - 0.05).abs() < 1e-8);
/// let limits = Limits::new(1e-4);
/// let proven = separation(&below, &above, &limits, &mut PairWorkspace::new())?;
/// assert!((proven.upper + 0.1).abs() < 1e-4);
/// let short = MinimaxProximal { steps: 1, ..MinimaxProximal::default() };
/// assert_eq!(short.descend(&below, &above, Vector([-1.8, 0.4]), 1e-9)?.steps, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MinimaxProximal {
    /// Steps at most; 40.
    pub steps: u32,
}

impl Default for MinimaxProximal {
    fn default() -> Self {
        Self { steps: 40 }
    }
}

impl MinimaxProximal {
    /// The search for the least of `max(g_a, g_b)` from `start` [m], until steps are
    /// smaller than `tolerance` [m].
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
        let (mut pair, descent) = Pair::begin(a, b, start, tolerance)?;
        let mut size = descent.value.abs().max(tolerance);
        Ok(descent.run(self.steps, |descent| {
            let is_long = size >= tolerance && size > 0.0;
            if !is_long {
                return Step::None;
            }
            let [(a, slope_a), (b, slope_b)] = pair.here;
            let next = descent.best - minimax_step([a, b], [slope_a, slope_b], size);
            let there = pair.slopes(next, descent);
            let value = larger(there);
            if value < descent.value {
                descent.visit(next, value);
                pair.here = there;
                size *= GROW;
            } else {
                size *= SHRINK;
            }
            Step::Next
        }))
    }
}

/// The share of the promised descent that a step must keep (Armijo 1966).
const KEPT: f64 = 0.1;

/// Goes down the gradient of `A + B + |max(A, B)|` of the values A, B of both fields, with steps that
/// are halved until they lead down by a tenth of what the gradient promises.
///
/// Where the bodies overlap, the sum is `min(A, B)`: how deep the surface of one body lies in the other,
/// whose least value is on the surface of the overlap and not where both are deepest. So a last
/// step leads down the larger of both values. The answer, as published, is that value at the last point,
/// which need not be the lowest on the way.
///
/// Factors of a gradient, whose length is up to 3, begin at 1 m and end at 0.1 mm: whatever the size of the
/// bodies, the first steps that are tried are metres long, and places are known to a tenth of a millimetre.
///
/// `MuJoCo` starts 40 descents at the points of [`halton_starts`](crate::halton_starts) and keeps those
/// that end in both bodies.
///
/// An upper bound, without a proof, as [`MinimaxProximal`](crate::MinimaxProximal):
///
/// ```
/// use palpate_field::{Pose, Shape, Vector};
/// use palpate_local::{SumDescent, halton_starts};
/// use palpate_query::Placed;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::ball(0.5)?;
/// let there = Placed::new(&ball, Pose::translation([0.9, 0.0, 0.0]));
/// let descents = halton_starts(&ball, there, 40)
///     .into_iter()
///     .map(|start| SumDescent::default().descend(&ball, there, start, 0.0));
/// let values = descents.map(|found| found.map(|found| found.value));
/// let least = values.collect::<Result<Vec<_>, _>>()?.into_iter().fold(f64::INFINITY, f64::min);
/// // A point in both, but not the deepest: in the middle both are 0.05 m deep.
/// assert!(least < 0.0 && least > -0.049);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumDescent {
    /// Steps at most; 10, as `MuJoCo`'s `sdf_iterations`.
    pub steps: u32,
    /// The first factor of a gradient that is tried; 1.
    pub largest: f64,
    /// Factors are halved until they are at most this; 1e-4.
    pub smallest: f64,
}

impl Default for SumDescent {
    fn default() -> Self {
        Self { steps: 10, largest: 1.0, smallest: 1e-4 }
    }
}

impl SumDescent {
    /// How many starts `MuJoCo` tries, its `sdf_initpoints`.
    pub const STARTS: u32 = 40;

    /// The descent from `start` [m], until a step is shorter than `tolerance` [m] or leads up.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, a pose is not finite, or the tolerance is
    /// negative.
    pub fn descend<'a, const D: usize>(
        &self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        start: Point<D>,
        tolerance: f64,
    ) -> Result<Descent<D>, QueryError> {
        let (mut pair, descent) = Pair::begin(a, b, start, tolerance)?;
        let sum = |[(a, _), (b, _)]: Slopes<D>| a + b + a.max(b).abs();
        let mut descent = descent.run(self.steps, |descent| {
            let [(a, slope_a), (b, slope_b)] = pair.here;
            let (greater, its_slope) = if a > b { (a, slope_a) } else { (b, slope_b) };
            let gradient = slope_a + slope_b + its_slope * greater.signum();
            let before = sum(pair.here);
            let length = self.step(&mut pair, sum, gradient, descent);
            let is_last = sum(pair.here) >= before || length <= tolerance;
            if is_last { Step::Last } else { Step::Next }
        });
        let [(a, slope_a), (b, slope_b)] = pair.here;
        let gradient = if a > b { slope_a } else { slope_b };
        let _ = self.step(&mut pair, larger, gradient, &mut descent);
        descent.steps += 1;
        Ok(descent)
    }

    /// Goes down the gradient of a goal, by a step that is halved until it leads down, and at last may
    /// lead up; the length of the step [m].
    fn step<const D: usize>(
        &self,
        pair: &mut Pair<'_, D>,
        goal: impl Fn(Slopes<D>) -> f64,
        gradient: Vector<f64, D>,
        descent: &mut Descent<D>,
    ) -> f64 {
        let (before, squared) = (goal(pair.here), gradient.dot(gradient));
        let mut factor = self.largest;
        loop {
            let next = descent.best - gradient * factor;
            let there = pair.slopes(next, descent);
            let leads_down = goal(there) - before <= -KEPT * factor * squared;
            if leads_down || factor <= self.smallest {
                pair.here = there;
                descent.path.push(next);
                (descent.best, descent.value) = (next, larger(there));
                return factor * squared.sqrt();
            }
            factor *= 0.5;
        }
    }
}

/// The point of the element that is nearest to `p` [m].
///
/// Of a triangle, the foot of the perpendicular on its plane, whose weights v and w of the edges
/// e₁, e₂ from the first vertex solve `eᵢ·(v·e₁ + w·e₂) = eᵢ·(p − a)`; where a weight is
/// negative, or the triangle has no area, the nearest point of its edges.
pub(crate) fn nearest<const N: usize, const D: usize>(
    element: &Element<N, D>,
    p: Point<D>,
) -> Point<D> {
    let vertices = element.vertices();
    if N == 3
        && let Some(foot) = foot(vertices[0], [vertices[1], vertices[N - 1]], p)
    {
        return foot;
    }
    let mut nearest = vertices[0];
    for i in 0..N {
        let on_edge = on_segment(vertices[i], vertices[(i + 1) % N], p);
        if (on_edge - p).norm() < (nearest - p).norm() {
            nearest = on_edge;
        }
    }
    nearest
}

/// The foot of the perpendicular from `p`, if it lies in the triangle.
fn foot<const D: usize>(a: Point<D>, ends: [Point<D>; 2], p: Point<D>) -> Option<Point<D>> {
    let [first, second] = ends.map(|end| end - a);
    let (side, away) = (first.dot(second), p - a);
    let [squared, other] = [first.dot(first), second.dot(second)];
    let [along, across] = [first.dot(away), second.dot(away)];
    let area = squared * other - side * side;
    let v = (other * along - side * across) / area;
    let w = (squared * across - side * along) / area;
    // Written so that NaN, of a triangle without area, is refused.
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0).then(|| a + first * v + second * w)
}

fn on_segment<const D: usize>(a: Point<D>, b: Point<D>, p: Point<D>) -> Point<D> {
    let along: Vector<f64, D> = b - a;
    let squared = along.dot(along);
    let share = if squared > 0.0 { along.dot(p - a) / squared } else { 0.0 };
    a + along * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod nearest_tests {
    use super::*;

    #[test]
    fn points_come_to_the_face_an_edge_or_a_corner() -> Result<(), Box<dyn std::error::Error>> {
        // In the plane z = 2, with a right angle at its first corner.
        let corners =
            [Vector([1.0, 1.0, 2.0]), Vector([5.0, 1.0, 2.0]), Vector([1.0, 3.0, 2.0])];
        let triangle = Element::new(corners)?;
        for (p, expected) in [
            ([2.0, 1.5, -7.0], [2.0, 1.5, 2.0]), // above the face
            ([3.0, -1.0, 2.0], [3.0, 1.0, 2.0]), // beside an edge
            ([0.0, -9.0, 4.0], [1.0, 1.0, 2.0]), // past a corner
            ([4.0, 4.0, 2.0], [3.0, 2.0, 2.0]),  // beside the longest edge
        ] {
            assert!((nearest(&triangle, Vector(p)) - Vector(expected)).norm() < 1e-15, "{p:?}");
        }
        let line = Element::new([corners[0], corners[1], corners[1]])?;
        assert_eq!(nearest(&line, Vector([2.0, 9.0, 9.0])), Vector([2.0, 1.0, 2.0]));
        let segment = Element::new([Vector([0.0, 0.0]), Vector([4.0, 0.0])])?;
        assert_eq!(nearest(&segment, Vector([3.0, 2.0])), Vector([3.0, 0.0]));
        assert_eq!(nearest(&segment, Vector([-3.0, 2.0])), Vector([0.0, 0.0]));
        Ok(())
    }
}
