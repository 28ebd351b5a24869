// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid motions as displacement and rotation vector.
//!
//! A rotation vector lies along the axis with the angle as length [rad]; in the plane along z.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};

/// A change of a pose: the origin moves, then the pose rotates about it. World axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twist {
    /// The displacement of the origin [m].
    pub(super) linear: Vector<f64, 3>,
    /// The rotation vector [rad]; in the plane only z is used.
    pub(super) angular: Vector<f64, 3>,
}

impl Twist {
    /// The twist from one pose to another.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn between(from: &Pose<3>, to: &Pose<3>) -> Self {
        let linear = to.translation - from.translation;
        if from.rotation == to.rotation {
            return Self { linear, angular: Vector::ZERO };
        }
        Self { linear, angular: from.rotation.turn_to(&to.rotation) }
    }

    /// A part of the motion.
    pub(super) fn part(&self, part: f64) -> Self {
        Self { linear: self.linear * part, angular: self.angular * part }
    }

    /// The largest part, at most one, of the motion that rotates by at most the angle `most`
    /// [rad].
    pub(super) fn part_up_to(&self, most: f64) -> f64 {
        let angle = self.angular.norm();
        if angle > most { most / angle } else { 1.0 }
    }

    /// The pose after the motion.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn moved(&self, pose: &Pose<3>) -> Pose<3> {
        let rotation = pose.rotation.turned(self.angular);
        Pose::new(rotation, pose.translation + self.linear)
    }

    /// The largest displacement of a point at distance `arm` from the origin [m].
    #[inline]
    pub(super) fn way(&self, arm: f64) -> f64 {
        self.linear.norm() + self.angular.norm() * arm
    }

    /// The displacement of a point at `arm` from the origin, to first order [m].
    pub(super) fn of_point(&self, arm: Vector<f64, 3>) -> Vector<f64, 3> {
        self.linear + self.angular.cross(arm)
    }

    /// The motion as one vector, in which a radian counts as the length `unit` [m].
    pub(super) fn stacked(&self, unit: f64) -> [f64; 6] {
        let ([x, y, z], [a, b, c]) = (self.linear.0, (self.angular * unit).0);
        [x, y, z, a, b, c]
    }

    /// The squared length of the motion, in which a radian counts as the length `unit` [m²].
    pub(super) fn squared(&self, unit: f64) -> f64 {
        self.stacked(unit).iter().map(|x| x * x).sum()
    }

    /// The inverse of [`stacked`](Self::stacked).
    pub(super) fn unstacked([x, y, z, a, b, c]: [f64; 6], unit: f64) -> Self {
        let angular = Vector([a, b, c]) * (1.0 / unit);
        Self { linear: Vector([x, y, z]), angular }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_field::Rotation;

    #[test]
    fn a_twist_between_poses_leads_from_one_to_the_other() {
        let turn = |axis, angle| Rotation::from_axis_angle(Vector(axis), angle).unwrap();
        let from = Pose::new(turn([0.3, -1.0, 0.2], 1.1), Vector([1.0, 2.0, 3.0]));
        for angle in [0.0, 1e-12, 1e-7, 0.4, 3.0] {
            let to = Pose::new(turn([1.0, 0.4, -0.3], angle), Vector([0.0, -1.0, 4.0]));
            let there = Twist::between(&from, &to).moved(&from);
            let probe = Vector([0.3, -0.7, 0.2]);
            let error = there.transform_point(probe) - to.transform_point(probe);
            assert!(error.norm() < 1e-14, "{angle}: {error:?}");
        }
    }

    #[test]
    fn in_the_plane_a_twist_turns_about_z() {
        let to = Pose::rotation(Rotation::from_angle(0.25).unwrap().in_space());
        let twist = Twist::between(&Pose::identity(), &to);
        assert!((twist.angular - Vector([0.0, 0.0, 0.25])).norm() < 1e-15);
        let moved = twist.moved(&Pose::identity());
        assert!((moved.truncated::<2>().rotation.angle() - 0.25).abs() < 1e-15);
    }

    #[test]
    fn stacking_is_undone() {
        let twist =
            Twist { linear: Vector([1.0, -2.0, 0.0]), angular: Vector([0.0, 0.0, 0.5]) };
        assert_eq!(twist.stacked(4.0), [1.0, -2.0, 0.0, 0.0, 0.0, 2.0]);
        assert_eq!(Twist::unstacked(twist.stacked(4.0), 4.0), twist);
    }
}
