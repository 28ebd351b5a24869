// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A field as searches between bodies see it: never steeper than one, and never more
//! than the distance.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BoundingBall, Point, Pose, Shape, Vector};

use super::cell::reach;
use crate::error::QueryError;
use crate::larger::larger;
use crate::placed::{Placed, check_pose};

/// Roundings of places and of distances to boxes, relative to the largest coordinate.
const GEOMETRY_ROUNDINGS: f64 = 16.0;

/// Roundings of a rotated side of a box.
const TURN_ROUNDINGS: f64 = 4.0;

/// `g = max(f/L, distance to the box)`: a lower bound of the distance to the shape, with
/// Lipschitz constant 1. It is at most u within u of the box alone, which is what bounds
/// a search. Where a field's steepness is not known, `g` has the right sign, and says
/// nothing of its surroundings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<'a, const D: usize> {
    pub(crate) shape: &'a Shape<D>,
    /// `1/L`.
    scale: f64,
    /// Of the shape, in its own coordinates.
    aabb: Option<Aabb<D>>,
    region: Option<BoundingBall<D>>,
    /// From the frame of the search to the shape's; `None` where they are the same.
    body_from_frame: Option<Pose<D>>,
}

impl<'a, const D: usize> Body<'a, D> {
    /// The shape where `body_from_frame` says.
    pub(crate) fn new(shape: &'a Shape<D>, body_from_frame: Pose<D>) -> Self {
        let promise = shape.promise();
        let is_moved = body_from_frame != Pose::identity();
        Self {
            shape,
            scale: 1.0 / promise.lipschitz.max(1.0),
            aabb: promise.bounds.map(|bounds| bounds.aabb),
            region: promise.region,
            body_from_frame: is_moved.then_some(body_from_frame),
        }
    }

    /// The shape's box, in its own coordinates.
    pub(crate) fn own_box(&self) -> Option<Aabb<D>> {
        self.aabb
    }

    /// The shape in the frame of the world.
    pub(crate) fn in_world(placed: Placed<'a, D>) -> Result<Self, QueryError> {
        check_pose(&placed.world_from_body)?;
        Ok(Self::new(placed.shape, placed.world_from_body.inverse()))
    }

    /// A box of the frame that holds the shape.
    pub(crate) fn aabb(&self) -> Option<Aabb<D>> {
        let aabb = self.aabb?;
        Some(match &self.body_from_frame {
            None => aabb,
            Some(pose) => {
                let placed = aabb.placed(&pose.inverse());
                placed.grown(self.geometry(reach(&placed)))
            }
        })
    }

    /// What `g` may be off by within `reach` of the frame's origin [m].
    pub(crate) fn slack(&self, reach: f64) -> f64 {
        let away = self.body_from_frame.map_or(0.0, |pose| pose.translation.norm());
        let rounding = self.shape.promise().rounding.within(reach + away);
        rounding * self.scale + self.geometry(reach)
    }

    /// Roundings of places within `reach` of the frame's origin [m].
    fn geometry(&self, reach: f64) -> f64 {
        let away = self.body_from_frame.map_or(0.0, |pose| pose.translation.norm());
        GEOMETRY_ROUNDINGS * f64::EPSILON * (reach + 2.0 * away)
    }

    /// A point in the shape's coordinates.
    #[inline]
    pub(crate) fn local(&self, p: Point<D>) -> Point<D> {
        match &self.body_from_frame {
            None => p,
            Some(pose) => pose.transform_point(p),
        }
    }

    /// A point of the frame, from one in the shape's coordinates.
    pub(crate) fn in_frame(&self, local: Point<D>) -> Point<D> {
        match &self.body_from_frame {
            None => local,
            Some(pose) => pose.inverse().transform_point(local),
        }
    }

    /// The coordinates of a box of the frame about a point in the shape's coordinates.
    #[inline]
    pub(crate) fn cell(&self, local: Point<D>, half: Vector<f64, D>) -> Vector<Model, D> {
        let mut cell = Vector(Model::cell(local.0, half.0));
        if let Some(pose) = &self.body_from_frame {
            let rows = pose.rotation.matrix();
            for i in 0..D {
                let mut size = 0.0;
                for k in 0..D {
                    let side = rows[i][k] * half[k];
                    cell[i].gradient[k] = side;
                    size += side.abs();
                }
                let rounding = TURN_ROUNDINGS * f64::EPSILON * size;
                (cell[i].lower, cell[i].upper) = (rounding, rounding);
            }
        }
        cell
    }

    /// `true` if the field is as steep as promised everywhere.
    pub(crate) fn is_known_everywhere(&self) -> bool {
        self.region.is_none()
    }

    /// `true` if the field is as steep as promised in a ball, in the shape's coordinates.
    #[inline]
    pub(crate) fn is_known(&self, local: Point<D>, radius: f64) -> bool {
        let inside =
            |region: BoundingBall<D>| (local - region.centre).norm() + radius <= region.radius;
        self.region.is_none_or(inside)
    }

    /// `g` at a point in the shape's coordinates where the field is `f`.
    #[inline]
    pub(crate) fn value(&self, local: Point<D>, f: f64) -> f64 {
        let (outside, _) = self.outside_box(local);
        larger(f * self.scale, outside)
    }

    /// What `g` is at least within `radius` of a point in the shape's coordinates where
    /// it is `value`: minus infinity where only the field itself would know.
    #[inline]
    pub(crate) fn floor(&self, local: Point<D>, value: f64, radius: f64) -> f64 {
        let known =
            if self.is_known(local, radius) { value } else { self.outside_box(local).0 };
        known - radius
    }

    /// A model of `f/L` from one of `f`.
    #[inline]
    pub(crate) fn scaled(&self, model: Model) -> Model {
        let scale = self.scale;
        Model {
            value: model.value * scale,
            gradient: model.gradient.map(|side| side * scale),
            lower: model.lower * scale,
            upper: model.upper * scale,
        }
    }

    /// `g` and its gradient, at a point of the frame and in it.
    #[inline]
    pub(crate) fn slope(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let local = self.local(p);
        let (f, gradient) = self.shape.distance_gradient(local);
        self.slope_of(local, f, gradient)
    }

    /// `g` and its gradient in the frame, at a point in the shape's coordinates where the
    /// field is `f` and has a gradient.
    #[inline]
    pub(crate) fn slope_of(
        &self,
        local: Point<D>,
        f: f64,
        gradient: Vector<f64, D>,
    ) -> (f64, Vector<f64, D>) {
        let (outside, away) = self.outside_box(local);
        let inner = f * self.scale;
        let (value, slope) =
            if inner >= outside { (inner, gradient * self.scale) } else { (outside, away) };
        match &self.body_from_frame {
            None => (value, slope),
            Some(pose) => (value, pose.rotation.inverse().rotate(slope)),
        }
    }

    /// The distance to the box and its gradient; minus infinity inside, or without one.
    #[inline]
    fn outside_box(&self, local: Point<D>) -> (f64, Vector<f64, D>) {
        let Some(aabb) = &self.aabb else { return (f64::NEG_INFINITY, Vector::ZERO) };
        let mut away = Vector::ZERO;
        for k in 0..D {
            away[k] = larger(local[k] - aabb.max[k], 0.0) - larger(aabb.min[k] - local[k], 0.0);
        }
        let squared = away.dot(away);
        // Most points are inside, and need no root.
        if squared > 0.0 {
            let distance = squared.sqrt();
            (distance, away * (1.0 / distance))
        } else {
            (f64::NEG_INFINITY, away)
        }
    }
}
