// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far a body reaches in a direction, from its exact field seen from far away.
//!
//! # Derivation
//!
//! From a point p where an exact field is f > 0 and its gradient n, the nearest point of the body
//! is `q = p − f·n`. The ball of radius f about p is free, so every point x of the body has
//!
//! ```text
//! n·(x − q) ≤ |x − q|²/(2f),   and n·(x − q) ≤ 0 if the body is convex.
//! ```
//!
//! With a unit vector u, `u·(x − q) ≤ n·(x − q) + |u − n|·|x − q|`. The point `p = q + R·u` makes
//! n nearly u where R is large. The nearest point from there is the next q: these are the steps of
//! the proximal point method. For a convex body the error shrinks with the factor r/R in each
//! step, where r is its radius. It vanishes after a few steps at an edge or a corner.
//!
//! Rounding by ε lets a point of the body pass for the nearest one that is farther by ε. It lies up
//! to `√(2fε)` beside the nearest one, since no point of a convex body is before the plane through
//! that. So the gradient may be off by `√(2ε/f)`, which is far more than its own rounding.

use palpate_field::{Point, Vector};

use super::super::distance_bound::DistanceBound;
use super::convexity::is_convex;
use crate::sampler::unit;

/// From how far a convex body is seen, in its radii. From nearer the steps gain less. From farther
/// the rounding of the field grows.
const FAR: f64 = 1024.0;

/// From how far a body that is not convex is seen, in its radii. Seen from there, its reach is known but
/// for a share 1/(2·far) of the radius. At this distance that share is as large as the rounding.
const VERY_FAR: f64 = 8_388_608.0;

/// Steps to the farthest point at most.
const STEPS: usize = 12;

/// How much of the rounding of a field at a far point may be in a nearest point and in a normal.
const ROUNDINGS: f64 = 8.0;

/// Balls within a body that are smaller than this share of its box are points.
const SMALL: f64 = 1.0 / 1024.0;

/// Halvings of the logarithm of a ball's radius.
const HALVINGS: u32 = 6;

/// A ball counts as touching the surface if the field at its centre says so up to this share.
const TOUCHES: f64 = 1e-6;

/// How far a body reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach<const D: usize> {
    /// A point of the body, or within its slack of one.
    pub(super) point: Point<D>,
    /// No point of the body lies farther out than this beyond `point` [m].
    pub(super) excess: f64,
}

/// A ball within a body; a point where the radius is zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct InnerBall<const D: usize> {
    pub(super) centre: Point<D>,
    pub(super) radius: f64,
}

/// A bounded body whose field is exact outside, as asked how far it reaches.
#[derive(Clone, Debug)]
pub(super) struct Support<'a, const D: usize> {
    body: DistanceBound<'a, D>,
    /// A ball around the body, in its own coordinates.
    centre: Point<D>,
    radius: f64,
    /// Half of the smallest side of its box [m]. No ball within it is larger.
    thickest: f64,
    is_convex: bool,
    /// A gradient counts twice.
    pub(super) evaluations: u32,
}

impl<'a, const D: usize> Support<'a, D> {
    /// `None` if the body has no bounds, or a field that is no distance outside.
    pub(super) fn of(body: DistanceBound<'a, D>) -> Option<Self> {
        let promise = body.shape.promise();
        let bounds = promise.bounds?;
        if !body.is_exact_outside() || !body.is_known_everywhere() {
            return None;
        }
        let half = bounds.aabb.half_extents();
        Some(Self {
            body,
            centre: bounds.ball.centre,
            radius: bounds
                .ball
                .radius
                .min(half.norm() + (bounds.aabb.centre() - bounds.ball.centre).norm()),
            thickest: half.0.into_iter().fold(f64::INFINITY, f64::min),
            is_convex: is_convex(body.shape),
            evaluations: 0,
        })
    }

    /// `true` if the body is proven to be convex.
    pub(super) fn is_convex(&self) -> bool {
        self.is_convex
    }

    /// The middle of the body, in the frame.
    pub(super) fn middle(&self) -> Point<D> {
        self.body.in_frame(self.centre)
    }

    /// How far from the body it is looked at [m].
    fn far(&self) -> f64 {
        (if self.is_convex { FAR } else { VERY_FAR }) * self.radius
    }

    /// The rounding of points and of their excesses [m].
    pub(super) fn slack(&self) -> f64 {
        let reach = self.middle().norm() + 2.0 * self.radius + self.far();
        ROUNDINGS * self.body.slack(reach)
    }

    /// By how much a gradient may miss a normal of a convex body at a point where the field is `f`.
    fn blur(&self, p: Point<D>, f: f64) -> f64 {
        (2.0 * self.body.shape.promise().rounding.within(p.norm()) / f).sqrt()
    }

    /// The least excess that rounding allows [m].
    pub(super) fn finest(&self) -> f64 {
        let far = self.far();
        let p = self.centre + Vector::unit(0) * far;
        2.0 * self.radius * self.blur(p, far)
    }

    /// How far the body reaches along the unit vector `u`, with an excess of at most `fine` where
    /// that is possible. The search begins at `from`; both in the frame.
    pub(super) fn along(&mut self, u: Vector<f64, D>, from: Point<D>, fine: f64) -> Reach<D> {
        let along = self.body.turn().map_or(u, |turn| turn.rotate(u));
        let (far, mut from) = (self.far(), self.body.local(from));
        let mut best = Reach { point: from, excess: f64::INFINITY };
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let p = from + along * far;
            let (f, slope) = self.body.shape.distance_gradient(p);
            self.evaluations += 2;
            let Some(normal) = slope.normalized() else { break };
            let q = p - normal * f;
            let widest = (q - self.centre).norm() + self.radius;
            let aside = along - normal;
            let blur = self.blur(p, f);
            let behind = if self.is_convex { blur * widest } else { 0.5 * widest * widest / f };
            let excess = aside.norm() * widest + behind;
            // Written so that NaN is not better.
            if excess < best.excess {
                best = Reach { point: q, excess };
            }
            if best.excess <= fine || aside.norm() <= blur {
                break;
            }
            // On a face that leans by little, steps are short: the farthest point is at its border.
            let is_slow = excess > 0.5 * last;
            from = if is_slow { q + unit(aside) * (2.0 * self.radius) } else { q };
            last = if is_slow { f64::INFINITY } else { excess };
        }
        Reach { point: self.body.in_frame(best.point), ..best }
    }

    /// A large ball within the body that touches its surface next to `point` from within, with
    /// `u` as the normal there.
    pub(super) fn ball_behind(&mut self, point: Point<D>, u: Vector<f64, D>) -> InnerBall<D> {
        let mut best = InnerBall { centre: point, radius: 0.0 };
        let mut touches = |support: &mut Self, radius: f64| {
            let ball = support.ball_at(point - u * radius);
            let is_touching = ball.radius >= (1.0 - TOUCHES) * radius;
            if is_touching {
                best = ball;
            }
            is_touching
        };
        let (mut small, mut large) = (SMALL * self.thickest, self.thickest);
        if !touches(self, large) && touches(self, small) {
            for _ in 0..HALVINGS {
                let middle = (small * large).sqrt();
                if touches(self, middle) {
                    small = middle;
                } else {
                    large = middle;
                }
            }
        }
        best
    }

    /// The ball about a point that the field proves to lie within the body.
    fn ball_at(&mut self, centre: Point<D>) -> InnerBall<D> {
        self.evaluations += 1;
        let local = self.body.local(centre);
        let value = self.body.value(local, self.body.shape.distance(local));
        InnerBall { centre, radius: -value }
    }
}
