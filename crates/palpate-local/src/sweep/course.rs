// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A field as points see it that move.

use palpate_field::{Point, Vector};
use palpate_query::{Motion, Moving, QueryError};

/// A field, and how the frame of an element moves past it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<'a, const D: usize> {
    pub(super) field: Moving<'a, D>,
    pub(super) motion: Motion<D>,
}

/// A field at a point of an element and a time, and how it changes with both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope<const D: usize> {
    /// [m].
    pub(super) value: f64,
    /// By the point, in the element's coordinates.
    pub(super) gradient: Vector<f64, D>,
    /// By the time, of which the motion takes one unit [m].
    pub(super) rate: f64,
}

impl<'a, const D: usize> Course<'a, D> {
    /// Refuses poses that are not finite or too far away.
    pub(super) fn new(field: Moving<'a, D>, motion: Motion<D>) -> Result<Self, QueryError> {
        field.motion.check(0)?;
        motion.check(1)?;
        Ok(Self { field, motion })
    }

    /// In world coordinates, a point of the element's.
    pub(super) fn place(&self, p: Point<D>, time: f64) -> Point<D> {
        self.motion.pose(time).transform_point(p)
    }

    /// The field at a point of the element.
    pub(super) fn value(&self, p: Point<D>, time: f64) -> f64 {
        let body_from_world = self.field.motion.pose(time).inverse();
        self.field.shape.distance(body_from_world.transform_point(self.place(p, time)))
    }

    pub(super) fn slope(&self, p: Point<D>, time: f64) -> Slope<D> {
        let (world_from_body, world_from_element) =
            (self.field.motion.pose(time), self.motion.pose(time));
        let there = world_from_body.inverse().transform_point(self.place(p, time));
        let (value, gradient) = self.field.shape.distance_gradient(there);
        let in_world = world_from_body.transform_vector(gradient);
        let velocity = world_from_element.transform_vector(self.motion.velocity(p))
            - world_from_body.transform_vector(self.field.motion.velocity(there));
        Slope {
            value,
            gradient: world_from_element.inverse().transform_vector(in_world),
            rate: in_world.dot(velocity),
        }
    }

    /// A bound of how fast the field sees a point of the element move from `time` on [m].
    ///
    /// Both move on screws, on which each point of a body keeps its speed. What turns with the field
    /// past the point is as fast as the field's origin, and its turn times the distance from there,
    /// which grows at most by both their ways.
    pub(super) fn fastest(&self, p: Point<D>, time: f64) -> f64 {
        let own = self.motion.velocity(p).norm();
        let origin = self.field.motion.velocity(Vector::ZERO).norm();
        let turn = self.field.motion.angle();
        let apart = self.place(p, time) - self.field.motion.pose(time).translation;
        own + origin + turn * (apart.norm() + (own + origin) * (1.0 - time))
    }
}
