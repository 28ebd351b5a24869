// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes that move.

use palpate_field::{Aabb, Point, Shape, Vector};

use super::motion::Motion;
use crate::placed::Placed;

/// A shape on its way from pose to pose, over the time from 0 to 1. A shape at rest converts to one
/// that stays.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape};
/// use palpate_query::Moving;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ball = Shape::<3>::ball(0.1)?;
/// let there = Pose::translation([1.0, 0.0, 0.0]);
/// let moving = Moving::new(&ball, Screw::new(Pose::identity(), there, 0)?);
/// assert_eq!(moving.at(0.5).world_from_body.translation[0], 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a, const D: usize> {
    /// The shape.
    pub shape: &'a Shape<D>,
    /// From the shape's coordinates to the world's, over the time.
    pub motion: Motion<D>,
}

impl<'a, const D: usize> Moving<'a, D> {
    /// `shape` on its way.
    #[must_use]
    pub fn new(shape: &'a Shape<D>, motion: impl Into<Motion<D>>) -> Self {
        Self { shape, motion: motion.into() }
    }

    /// The shape at a time, from 0 to 1.
    #[must_use]
    pub fn at(&self, time: f64) -> Placed<'a, D> {
        Placed::new(self.shape, self.motion.pose(time))
    }

    /// The velocity of a point of the world that the body carries at a time [m].
    pub(super) fn velocity(&self, time: f64, p: Point<D>) -> Vector<f64, D> {
        let pose = self.motion.pose(time);
        pose.transform_vector(self.motion.velocity(pose.inverse().transform_point(p)))
    }
}

/// The corners of a box.
pub(crate) fn corners<const D: usize>(aabb: &Aabb<D>) -> impl Iterator<Item = Point<D>> {
    let Aabb { min, max } = *aabb;
    (0..1_usize << D).map(move |corner| {
        Vector(std::array::from_fn(|k| if corner >> k & 1 == 0 { min[k] } else { max[k] }))
    })
}

impl<'a, const D: usize> From<Placed<'a, D>> for Moving<'a, D> {
    fn from(rest: Placed<'a, D>) -> Self {
        Self::new(rest.shape, rest.world_from_body)
    }
}

impl<'a, const D: usize> From<&'a Shape<D>> for Moving<'a, D> {
    fn from(shape: &'a Shape<D>) -> Self {
        Placed::from(shape).into()
    }
}
