// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The penetration of two bodies: how far one must move to leave the other.

use palpate_field::{Node, Shape, Vector};

use super::{BodyPair, Nearest, PairWorkspace};
use crate::certified::{Certified, Limits, Stop};
use crate::error::QueryError;
use crate::sampler::{Placed, arbitrary};

use directions::{DirectionTree, Found};
use overlap_ball::{OverlapBall, deepest_common};
use support::Support;
use translations::{Room, TranslationTree};
use way_out::WayOut;

mod convexity;
mod directions;
mod least_first;
mod overlap_ball;
mod support;
mod translations;
mod way_out;

/// The share of the budget that the search for a short translation may take. The rest is for the
/// proof that no shorter one separates the bodies.
const SHARE_OF_WAY_OUT: f64 = 0.4;

/// With fewer evaluations left a search is not worth its start.
const LEAST: u32 = 500;

/// How a body leaves another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Penetration<const D: usize> {
    /// The direction in which the second body leaves the first one by a translation as long as the
    /// upper bound: a unit vector in world coordinates. `None` if no translation is needed, or none
    /// was found.
    pub direction: Option<Vector<f64, D>>,
}

/// The penetration of two bodies [m], between bounds: the length of the shortest translation of
/// the second body after which the interiors of both have no point in common. It is zero for
/// bodies that are apart or only touch, and for a body without an interior.
///
/// Physics engines call it penetration depth. It is not minus the [`separation`](super::separation)
/// of bodies that overlap, which is the diameter of the largest ball in both: a needle through a
/// ball has a small such ball and a long way out.
///
/// - **Upper bound.** After a translation of this length along [`Penetration::direction`] the
///   bodies are proven not to overlap: a plane lies between them, or their separation is proven
///   not to be negative. It is infinite if no such translation was found.
/// - **Lower bound.** No shorter translation separates the bodies.
///
/// How close the bounds come depends on the bodies:
///
/// - Of two bounded **convex** bodies with fields that are exact outside, the penetration is the least over unit
///   vectors u of `h_a(u) + h_b(−u)`, where `h` says how far a body reaches. A search over
///   directions ends with bounds that are no farther apart than the tolerance, or than about a
///   millionth of the bodies' size, which is what rounding allows.
/// - Of a **half-space** and a bounded body that is exact outside, it is how far the body reaches
///   behind the plane.
/// - Of **other** bodies, a search over directions finds a short translation, and a search over
///   translations rules out shorter ones. The bounds are often farther apart than the tolerance when the
///   budget ends; [`Certified::stop`] says so.
///
/// A body counts as convex where the [promise](palpate_field::Promise::convex) of its field says
/// so, and so does a polygon or the solid of a small mesh of which no vertex lies before a face. The
/// budget holds for the whole question.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
/// use palpate_query::{Limits, PairWorkspace, penetration};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let long = Shape::from_kernel(Cuboid::new(Vector([4.0, 1.0, 1.0]))?);
/// let cube = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?)
///     .translated(Vector([0.3, 0.6, 0.0]))?;
/// let way = penetration(&long, &cube, &Limits::new(1e-4), &mut PairWorkspace::new())?;
/// assert!(way.lower <= 0.4 && 0.4 <= way.upper && way.upper - way.lower <= 1e-4);
/// let direction = way.best.direction.expect("both are bounded");
/// assert!((direction - Vector([0.0, 1.0, 0.0])).norm() < 1e-3);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
pub fn penetration<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Penetration<D>>, QueryError> {
    penetration_of([a.into(), b.into()], limits, workspace)
}

#[inline(never)]
pub(crate) fn penetration_of<const D: usize>(
    placed: [Placed<'_, D>; 2],
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Penetration<D>>, QueryError> {
    limits.check()?;
    let [a, b] = placed;
    let pair = BodyPair::new(a, b)?;
    if pair.gap_of_boxes().is_some() || placed.iter().any(is_open) {
        return Ok(answer([0.0, 0.0], None, Stop::SignKnown, 0));
    }
    match of_supports(&pair, placed, limits, workspace) {
        Some(found) => Ok(found),
        None => of_any(&pair, placed, limits, workspace),
    }
}

/// Answers as [`penetration`], without the search over translations. For bodies that are neither convex nor
/// half-spaces, the upper bound is the translation of the search over directions, and the lower bound is the
/// diameter of the largest common ball.
pub(crate) fn way_out<const D: usize>(
    placed: [Placed<'_, D>; 2],
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Penetration<D>>, QueryError> {
    let [a, b] = placed;
    let pair = BodyPair::new(a, b)?;
    if placed.iter().any(is_open) {
        return Ok(answer([0.0, 0.0], None, Stop::SignKnown, 0));
    }
    if let Some(found) = of_supports(&pair, placed, limits, workspace) {
        return Ok(found);
    }
    let (way_out, here) = search_around(&pair, placed, limits, workspace)?;
    let (direction, upper) = match way_out.best {
        Some((direction, length)) => (Some(direction), length),
        None => (None, f64::INFINITY),
    };
    Ok(answer([-here.upper, upper], direction, Stop::BudgetSpent, way_out.evaluations))
}

/// Whether a body has no interior.
fn is_open<const D: usize>(body: &Placed<'_, D>) -> bool {
    !body.shape.promise().has_interior
}

/// The penetration of two convex bodies, or of a half-space and another body; `None` for others.
fn of_supports<const D: usize>(
    pair: &BodyPair<'_, D>,
    [a, b]: [Placed<'_, D>; 2],
    limits: &Limits,
    workspace: &PairWorkspace<D>,
) -> Option<Certified<Penetration<D>>> {
    let supports = pair.bodies.map(Support::of);
    match &supports {
        [Some(a), Some(b)] if a.is_convex() && b.is_convex() => {
            let bodies = [a.clone(), b.clone()];
            Some(of_convex(pair, bodies, limits, workspace.room()))
        }
        [_, Some(body)] if is_half_space(a.shape) => Some(of_half_space(pair, 0, body, limits)),
        [Some(body), _] if is_half_space(b.shape) => Some(of_half_space(pair, 1, body, limits)),
        _ => None,
    }
}

/// An answer from proven bounds and a direction in world coordinates.
fn answer<const D: usize>(
    [lower, upper]: [f64; 2],
    direction: Option<Vector<f64, D>>,
    stop: Stop,
    evaluations: u32,
) -> Certified<Penetration<D>> {
    // Also of a bound that is NaN.
    let lower = if lower > 0.0 { lower } else { 0.0 };
    let is_apart = upper <= 0.0;
    let (upper, direction) = if is_apart { (0.0, None) } else { (upper, direction) };
    Certified { best: Penetration { direction }, lower, upper, stop, evaluations }
}

/// The penetration of two convex bodies.
fn of_convex<'a, const D: usize>(
    pair: &BodyPair<'a, D>,
    bodies: [Support<'a, D>; 2],
    limits: &Limits,
    room: usize,
) -> Certified<Penetration<D>> {
    let slack = bodies[0].slack() + bodies[1].slack() + pair.slack(0.0);
    let start = (bodies[0].middle() + bodies[1].middle()) * 0.5;
    let mut both = *pair;
    let common = deepest_common(&mut both, start, Vector::ZERO, f64::INFINITY);
    let mut tree = DirectionTree::new(bodies, limits, room);
    if let Some(inner) = common {
        tree.know(OverlapBall::of(inner));
    }
    let Found { lower, upper, direction, stop } = tree.search();
    let bounds = [lower - slack, upper + slack];
    let is_wide = bounds[1] - bounds[0].max(0.0) > limits.tolerance;
    let stop = match stop {
        Stop::Converged if is_wide => Stop::RoundingReached,
        stop => stop,
    };
    let direction = pair.world_from_frame.transform_vector(direction);
    answer(bounds, Some(direction), stop, tree.evaluations() + both.evaluations)
}

/// `true` if a shape is a half-space, moved or scaled or grown.
fn is_half_space<const D: usize>(shape: &Shape<D>) -> bool {
    match shape.node() {
        Node::Primitive(primitive) => primitive.name() == "half_space",
        Node::Placed { of, .. } | Node::Scaled { of, .. } | Node::Offset { of, .. } => {
            is_half_space(of)
        }
        _ => false,
    }
}

/// The penetration of a half-space, the body with this index, and the other body: how deep the
/// lowest point of that one is.
fn of_half_space<'a, const D: usize>(
    pair: &BodyPair<'a, D>,
    index: usize,
    body: &Support<'a, D>,
    limits: &Limits,
) -> Certified<Penetration<D>> {
    let mut body = body.clone();
    let half_space = &pair.bodies[index];
    let middle = body.middle();
    let (_, normal) = half_space.distance_gradient(middle);
    let lowest = body.along(-normal, middle, 0.0);
    let (value, _) = half_space.distance_gradient(lowest.point);
    let slack = body.slack() + pair.slack(lowest.point.norm());
    let bounds = [-value - slack, lowest.excess - value + slack];
    let is_wide = bounds[1] - bounds[0].max(0.0) > limits.tolerance;
    let stop = if is_wide { Stop::RoundingReached } else { Stop::Converged };
    let out = if index == 0 { normal } else { -normal };
    let direction = pair.world_from_frame.transform_vector(out);
    answer(bounds, Some(direction), stop, body.evaluations + 4)
}

/// The penetration of any two bodies.
fn of_any<'a, const D: usize>(
    pair: &BodyPair<'a, D>,
    placed: [Placed<'a, D>; 2],
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Penetration<D>>, QueryError> {
    let cells = workspace.room();
    let (mut way_out, here) = search_around(pair, placed, limits, workspace)?;
    if here.lower >= 0.0 {
        return Ok(answer([0.0, 0.0], None, Stop::SignKnown, way_out.evaluations));
    }

    // How far from the world's origin the moved body is rounds its translation.
    let far = placed.map(|body| body.world_from_body.translation.norm());
    let rounding = |length: f64| 4.0 * f64::EPSILON * (far[0] + far[1] + length);
    let upper_of = |best: Option<(Vector<f64, D>, f64)>| {
        best.map_or(f64::INFINITY, |(_, length)| length + rounding(length))
    };
    let mut upper = upper_of(way_out.best);
    // Without an upper bound, translations up to the sizes of the bounded bodies are ruled out.
    let sizes = pair.boxes().iter().flatten().map(|aabb| 2.0 * aabb.half_extents().norm());
    let longest = if upper.is_finite() { upper } else { sizes.sum() };
    if way_out.evaluations >= limits.budget {
        let direction = way_out.best.map(|(direction, _)| direction);
        let bounds = [-here.upper, upper];
        return Ok(answer(bounds, direction, Stop::BudgetSpent, way_out.evaluations));
    }
    let deepest = pair.world_from_frame.inverse().transform_point(here.best.point);
    let mut tree = TranslationTree::new(*pair, longest, deepest);
    if upper.is_infinite() {
        tree.leave_out_beyond(longest);
    }
    let spent = |way_out: &WayOut<'_, '_, D>, tree: &TranslationTree<'_, D>| {
        way_out.evaluations.saturating_add(tree.evaluations())
    };
    let (mut lower, mut stop) = (0.0, Stop::BudgetSpent);
    let mut is_waiting = true;
    while is_waiting {
        let left = limits.budget.saturating_sub(spent(&way_out, &tree));
        let room = Room { tolerance: limits.tolerance, budget: left / 2, cells };
        let found = tree.search(upper, room);
        (lower, stop) = (found.lower, found.stop);
        let Some(candidate) = found.candidate else { break };
        let left = limits.budget.saturating_sub(spent(&way_out, &tree));
        way_out.budget = way_out.evaluations.saturating_add(left / 4);
        way_out.shortest = lower;
        way_out.attempt(pair.world_from_frame.transform_vector(candidate))?;
        let before = upper;
        upper = upper_of(way_out.best);
        // What rounding or memory ended goes on only towards a shorter translation.
        let goes_on = upper < before || matches!(stop, Stop::BudgetSpent | Stop::Unresolved);
        is_waiting = goes_on && left > LEAST;
        if stop == Stop::Unresolved {
            stop = Stop::BudgetSpent;
        }
    }
    let evaluations = way_out.evaluations.saturating_add(tree.evaluations());
    let lower = lower.max(-here.upper).min(upper);
    let stop = if upper - lower <= limits.tolerance { Stop::Converged } else { stop };
    let direction = way_out.best.map(|(direction, _)| direction);
    Ok(answer([lower, upper], direction, stop, evaluations))
}

/// Returns the finished search over directions, and the separation at the given poses. If its lower bound is not
/// negative, the search was not run.
fn search_around<'a, 'w, const D: usize>(
    pair: &BodyPair<'a, D>,
    placed: [Placed<'a, D>; 2],
    limits: &Limits,
    workspace: &'w mut PairWorkspace<D>,
) -> Result<(WayOut<'a, 'w, D>, Certified<Nearest<D>>), QueryError> {
    let mut way_out = WayOut::new(placed, limits, workspace);
    let here = way_out.at(Vector::ZERO, 0.0)?;
    if here.lower < 0.0 {
        if let Some((direction, length)) = beside_box(pair) {
            way_out.best = Some((pair.world_from_frame.transform_vector(direction), length));
        }
        way_out.shortest = (-here.upper).max(0.0);
        way_out.budget = (SHARE_OF_WAY_OUT * f64::from(limits.budget)) as u32;
        way_out.look_around(here.best.normal.unwrap_or_else(arbitrary))?;
    }
    Ok((way_out, here))
}

/// The shortest translation along an axis of the frame after which the boxes of both bodies are
/// apart: its direction and its length [m].
fn beside_box<const D: usize>(pair: &BodyPair<'_, D>) -> Option<(Vector<f64, D>, f64)> {
    let [Some(a), Some(b)] = pair.boxes() else { return None };
    let reach = a.radius_about_origin() + b.radius_about_origin();
    let slack = 2.0 * pair.slack(2.0 * reach);
    let ways = (0..D).flat_map(|k| {
        let axis = Vector::unit(k);
        [(axis, a.max[k] - b.min[k]), (-axis, b.max[k] - a.min[k])]
    });
    let shortest = ways.min_by(|x, y| x.1.total_cmp(&y.1));
    shortest.map(|(direction, length)| (direction, length + slack))
}
