// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The way of a body as another that moves sees it.

use palpate_field::{Point, Pose, Vector};

use super::motion::Motion;

/// Roundings of a velocity and of a pose, relative to the numbers in them.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The way of a body through the coordinates of a field, both of which may move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<const D: usize> {
    pub(super) field: Motion<D>,
    pub(super) body: Motion<D>,
}

/// A body at a time, in the coordinates of a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<const D: usize> {
    time: f64,
    field_from_body: Pose<D>,
}

/// Bounds of the way of all points of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayBounds {
    /// The largest speed [m].
    pub(super) speed: f64,
    /// The largest acceleration [m].
    pub(super) acceleration: f64,
    /// How far from the origin of the field's coordinates the body may come [m].
    pub(super) far: f64,
    /// The rounding of places [m].
    pub(super) rounding: f64,
}

impl<const D: usize> Path<D> {
    #[inline]
    pub(super) fn at(&self, time: f64) -> Place<D> {
        let world_from_body = self.body.pose(time);
        Place { time, field_from_body: self.field.pose(time).inverse() * world_from_body }
    }

    /// The velocity in the field's coordinates of a point, `p` of the body, `q` in these [m].
    #[inline]
    pub(super) fn velocity(
        &self,
        place: &Place<D>,
        p: Point<D>,
        q: Point<D>,
    ) -> Vector<f64, D> {
        place.field_from_body.transform_vector(self.body.velocity(p)) - self.field.velocity(q)
    }

    /// Bounds for a body that is the convex hull of `points`.
    ///
    /// A point of the body goes at its constant speed v, and turns by ω; so its acceleration is at
    /// most ω v. The field's coordinates carry the point at a velocity of at most u at first, which
    /// turning by ψ changes by at most ψ v as the point moves on. They add the accelerations of a
    /// turning frame: ψ u, and 2 ψ times the velocity in it, which is at most u + v (Coriolis).
    pub(super) fn bounds(&self, points: &[Point<D>]) -> WayBounds {
        let start = self.at(0.0);
        let (mut speed, mut carried, mut reach) = (0.0_f64, 0.0_f64, 0.0_f64);
        for p in points {
            let q = start.point(*p);
            speed = speed.max(self.body.velocity(*p).norm());
            carried = carried.max(self.field.velocity(q).norm());
            reach = reach.max(p.norm()).max(q.norm());
        }
        let [turn, field_turn] = [self.body.angle(), self.field.angle()];
        let carried = carried + field_turn * speed;
        let both = speed + carried;
        let far = reach + both + self.body.reach() + self.field.reach();
        WayBounds {
            speed: both,
            acceleration: turn * speed + field_turn * (carried + 2.0 * both),
            far: reach + both,
            rounding: ROUNDINGS * far,
        }
    }
}

impl<const D: usize> Place<D> {
    /// A point of the body in the field's coordinates [m].
    #[inline]
    pub(super) fn point(&self, p: Point<D>) -> Point<D> {
        self.field_from_body.transform_point(p)
    }
}

/// Places that are kept: a power of two.
const PLACES: usize = 64;

/// Places of the last times, by time: parts of a search often have the same.
#[derive(Clone, Debug)]
pub(super) struct Places<const D: usize>([Option<Place<D>>; PLACES]);

impl<const D: usize> Places<D> {
    pub(super) fn new() -> Self {
        Self([None; PLACES])
    }

    /// Forgets all, for another path.
    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// The place at a time.
    #[inline]
    pub(super) fn at(&mut self, path: &Path<D>, time: f64) -> &Place<D> {
        // The upper bits of the product depend on all bits of the time (Knuth 1998, 6.4).
        let hash = time.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15)
            >> (64 - PLACES.trailing_zeros());
        let slot = &mut self.0[hash as usize];
        if slot.is_some_and(|place| place.time != time) {
            *slot = None;
        }
        slot.get_or_insert_with(|| path.at(time))
    }
}
