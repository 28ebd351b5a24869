// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid motions over the time from 0 to 1.

use palpate_field::{Point, Pose, Screw, Vector};

use crate::error::QueryError;
use crate::placed::check_pose;

/// A rigid motion over the time from 0 to 1: a screw, or rest at a pose. Both convert to it.
///
/// ```
/// use palpate_field::{Pose, Screw};
/// use palpate_query::Motion;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let there = Pose::<3>::translation([1.0, 0.0, 0.0]);
/// let motion = Motion::from(Screw::new(Pose::identity(), there, 0)?);
/// assert_eq!(motion.pose(0.5).translation[0], 0.5);
/// assert_eq!(Motion::from(there).pose(0.5), there);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Motion<const D: usize> {
    /// `None` at rest.
    screw: Option<Screw<D>>,
    first: Pose<D>,
    /// The velocity of the body's origin, and what each coordinate of a point adds, both in the
    /// body's coordinates: velocities are affine in the point.
    velocity: Vector<f64, D>,
    slopes: [Vector<f64, D>; D],
}

impl<const D: usize> Motion<D> {
    /// The pose at a time, from 0 to 1: the first at 0 and below, the last at 1 and above.
    #[must_use]
    pub fn pose(&self, time: f64) -> Pose<D> {
        self.screw.map_or(self.first, |screw| screw.pose(time))
    }

    /// The velocity of a point of the body, both in the body's coordinates, where the whole motion
    /// takes the unit of time, so that it is in [m]: as [`Screw::velocity`].
    #[must_use]
    #[inline]
    pub fn velocity(&self, p: Point<D>) -> Vector<f64, D> {
        let mut velocity = self.velocity;
        for (slope, x) in self.slopes.iter().zip(p.0) {
            velocity += *slope * x;
        }
        velocity
    }

    /// How far the body turns [rad].
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.screw.map_or(0.0, |screw| screw.angle().abs())
    }

    /// A bound of the distance of the body's origin from the world's during the motion [m].
    pub(super) fn reach(&self) -> f64 {
        self.first.translation.norm() + self.velocity.norm()
    }

    /// Refuses poses that are not finite or too far away, of the body with this index.
    ///
    /// # Errors
    ///
    /// If the first or the last pose is such a pose.
    #[doc(hidden)]
    pub fn check(&self, index: usize) -> Result<(), QueryError> {
        [0.0, 1.0].into_iter().try_for_each(|time| check_pose(index, &self.pose(time)))
    }
}

impl<const D: usize> From<Screw<D>> for Motion<D> {
    fn from(screw: Screw<D>) -> Self {
        let first = *screw.from();
        if first == *screw.to() && screw.angle() == 0.0 {
            return first.into();
        }
        let velocity = screw.velocity(Vector::ZERO);
        let slopes = std::array::from_fn(|k| screw.velocity(Vector::unit(k)) - velocity);
        Self { screw: Some(screw), first, velocity, slopes }
    }
}

impl<const D: usize> From<Pose<D>> for Motion<D> {
    fn from(first: Pose<D>) -> Self {
        Self { screw: None, first, velocity: Vector::ZERO, slopes: [Vector::ZERO; D] }
    }
}
