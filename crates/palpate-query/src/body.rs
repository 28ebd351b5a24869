// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A field as searches between bodies see it: never steeper than one, and never more
//! than the distance.

use palpate_field::{Aabb, BoundingBall, Point, Shape, Vector};

/// Roundings of places and of distances to boxes, relative to the largest coordinate.
const GEOMETRY_ROUNDINGS: f64 = 16.0;

/// `g = max(f/L, distance to the box)`: a lower bound of the distance to the shape, with
/// Lipschitz constant 1. It is at most u within u of the box alone, which is what bounds
/// a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<'a, const D: usize> {
    pub(crate) shape: &'a Shape<D>,
    /// `1/L`.
    pub(crate) scale: f64,
    pub(crate) aabb: Option<Aabb<D>>,
    region: Option<BoundingBall<D>>,
}

impl<'a, const D: usize> Body<'a, D> {
    pub(crate) fn new(shape: &'a Shape<D>) -> Self {
        let promise = shape.promise();
        Self {
            shape,
            scale: 1.0 / promise.lipschitz.max(1.0),
            aabb: promise.bounds.map(|bounds| bounds.aabb),
            region: promise.region,
        }
    }

    /// What `g` may be off by within `reach` of the origin [m].
    pub(crate) fn slack(&self, reach: f64) -> f64 {
        let geometry = GEOMETRY_ROUNDINGS * f64::EPSILON * reach;
        self.shape.promise().rounding.within(reach) * self.scale + geometry
    }

    /// `true` if the field is as steep as promised in a ball.
    pub(crate) fn is_known(&self, centre: Point<D>, radius: f64) -> bool {
        let inside =
            |region: BoundingBall<D>| (centre - region.centre).norm() + radius <= region.radius;
        self.region.is_none_or(inside)
    }

    /// `g` where the field is `f`.
    pub(crate) fn value(&self, p: Point<D>, f: f64) -> f64 {
        let (outside, _) = self.outside_box(p);
        let inner = if self.is_known(p, 0.0) { f * self.scale } else { outside };
        inner.max(outside)
    }

    /// `g` and its gradient.
    pub(crate) fn slope(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let (f, gradient) = self.shape.distance_gradient(p);
        let (outside, away) = self.outside_box(p);
        let inner = if self.is_known(p, 0.0) { f * self.scale } else { outside };
        if inner >= outside { (inner, gradient * self.scale) } else { (outside, away) }
    }

    /// The distance to the box and its gradient; minus infinity without a box.
    fn outside_box(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let Some(aabb) = &self.aabb else { return (f64::NEG_INFINITY, Vector::ZERO) };
        let mut away = Vector::ZERO;
        for k in 0..D {
            away[k] = (p[k] - aabb.max[k]).max(0.0) - (aabb.min[k] - p[k]).max(0.0);
        }
        let distance = away.norm();
        if distance > 0.0 {
            (distance, away * (1.0 / distance))
        } else {
            (f64::NEG_INFINITY, away)
        }
    }
}
