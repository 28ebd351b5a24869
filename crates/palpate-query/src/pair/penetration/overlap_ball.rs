// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Translations that are proven not to separate two bodies.

use palpate_field::{Point, Vector};

use super::super::body_pair::BodyPair;
use super::super::distance_bound::minimax_step;
use super::support::InnerBall;
use crate::sampler::{larger, unit};

/// Steps towards the deepest common point under a translation.
const STEPS: u32 = 16;

/// Translations of the second body that are nearer than `radius` to `centre`. Under each of them a
/// ball within the first body and one within the second overlap, so the bodies do.
#[derive(Clone, Copy, Debug)]
pub(super) struct OverlapBall<const D: usize> {
    pub(super) centre: Vector<f64, D>,
    /// The sum of both radii [m].
    pub(super) radius: f64,
}

impl<const D: usize> OverlapBall<D> {
    /// The overlap ball that follows from a ball within each body.
    pub(super) fn of([a, b]: [InnerBall<D>; 2]) -> Self {
        Self { centre: a.centre - b.centre, radius: a.radius + b.radius }
    }

    /// The ball between this one and another, at a share of the way. Of convex bodies it holds
    /// translations under which they overlap too: such translations make a convex set.
    pub(super) fn between(&self, other: &Self, share: f64) -> Self {
        let mean = 1.0 - share;
        Self {
            centre: self.centre * mean + other.centre * share,
            radius: self.radius * mean + other.radius * share,
        }
    }
}

/// `g` of both with gradients at a point after a translation.
fn slopes<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    t: Vector<f64, D>,
) -> [(f64, Vector<f64, D>); 2] {
    pair.evaluations += 4;
    let [a, b] = &pair.bodies;
    [a.distance_gradient(p), b.distance_gradient(p - t)]
}

/// A ball within each body, the second one before a translation by `t`, about a common point after
/// it at which both depths have a large sum: from `start` on, until the sum is `enough`. `None` if
/// no common point was found.
pub(super) fn deepest_common<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    start: Point<D>,
    t: Vector<f64, D>,
    enough: f64,
) -> Option<[InnerBall<D>; 2]> {
    let mut p = start;
    let mut here = slopes(pair, p, t);
    let mut step = here[0].0.abs().max(here[1].0.abs());
    // The sum of the slopes where the last step led, if it gained nothing.
    let mut beyond: Option<Vector<f64, D>> = None;
    for _ in 0..STEPS {
        let [(a, slope_a), (b, slope_b)] = here;
        let sum = slope_a + slope_b;
        let is_common = larger(a, b) < 0.0;
        if is_common && -(a + b) > enough {
            break;
        }
        let step_out = if is_common {
            // Across a ridge of depths both slopes cancel, and along it they agree.
            unit(beyond.map_or(sum, |beyond| shortest_between(sum, beyond))) * step
        } else {
            minimax_step([a, b], [slope_a, slope_b], step)
        };
        let next = p - step_out;
        let there = slopes(pair, next, t);
        if score(&there) > score(&here) {
            (p, here, beyond) = (next, there, None);
            step *= 1.5;
        } else {
            beyond = is_common.then(|| there[0].1 + there[1].1);
            step *= 0.5;
        }
    }
    let [(a, _), (b, _)] = here;
    let ball = |body: usize, centre, value| {
        let body = &pair.bodies[body];
        InnerBall { centre, radius: body.filled(body.local(centre), value) }
    };
    (larger(a, b) < 0.0).then(|| [ball(0, p, a), ball(1, p - t, b)])
}

/// What a search for a deep common point makes large: the sum of both depths where both are
/// positive, else the smaller of both.
fn score<const D: usize>(slopes: &[(f64, Vector<f64, D>); 2]) -> f64 {
    let [(a, _), (b, _)] = *slopes;
    let larger = larger(a, b);
    if larger < 0.0 { -(a + b) } else { -larger }
}

/// The shortest mean of two vectors.
fn shortest_between<const D: usize>(a: Vector<f64, D>, b: Vector<f64, D>) -> Vector<f64, D> {
    let between = a - b;
    let squared = between.dot(between);
    if squared > 0.0 { a - between * (between.dot(a) / squared).clamp(0.0, 1.0) } else { a }
}
