// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Small rigid motions, and what leads from one pose to another.
//!
//! Rotations are vectors along their axis, as long as their angle [rad]; in the plane along z.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Rotation, Vector};

/// Below this angle [rad], sin θ / θ is one to the last bit.
const TINY: f64 = 1e-9;

/// How a pose changes: its origin moves, then it turns about it. World axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twist<const D: usize> {
    /// How far the origin goes [m].
    pub(super) linear: Vector<f64, D>,
    /// How far it turns [rad]; in the plane about z alone.
    pub(super) angular: Vector<f64, 3>,
}

impl<const D: usize> Twist<D> {
    /// What leads from one pose to another.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn between(from: &Pose<D>, to: &Pose<D>) -> Self {
        let linear = to.translation - from.translation;
        if from.rotation == to.rotation {
            return Self { linear, angular: Vector::ZERO };
        }
        Self { linear, angular: angle(to.rotation * from.rotation.inverse()) }
    }

    /// A part of the motion.
    pub(super) fn part(&self, part: f64) -> Self {
        Self { linear: self.linear * part, angular: self.angular * part }
    }

    /// The part of the motion that turns by an angle [rad] at most.
    pub(super) fn part_up_to(&self, most: f64) -> f64 {
        let angle = self.angular.norm();
        if angle > most { most / angle } else { 1.0 }
    }

    /// A pose after the motion.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn moved(&self, pose: &Pose<D>) -> Pose<D> {
        let turned = turn(self.angular) * pose.rotation;
        // Made orthonormal again, so that rounding never adds up.
        let rotation = Rotation::from_matrix(*turned.matrix()).unwrap_or(pose.rotation);
        Pose::new(rotation, pose.translation + self.linear)
    }

    /// How far a point `arm` from the origin may go [m].
    #[inline]
    pub(super) fn way(&self, arm: f64) -> f64 {
        self.linear.norm() + self.angular.norm() * arm
    }

    /// How a point `arm` from the origin goes, to first order [m].
    pub(super) fn of_point(&self, arm: Vector<f64, D>) -> Vector<f64, D> {
        self.linear + in_place(cross(self.angular, in_space(arm)))
    }

    /// As one vector, with angles as lengths: one radian is `unit` [m].
    pub(super) fn stacked(&self, unit: f64) -> [f64; 6] {
        let ([x, y, z], [a, b, c]) = (in_space(self.linear).0, (self.angular * unit).0);
        [x, y, z, a, b, c]
    }

    /// Undoes [`stacked`](Self::stacked).
    pub(super) fn unstacked([x, y, z, a, b, c]: [f64; 6], unit: f64) -> Self {
        let angular = Vector([a, b, c]) * (1.0 / unit);
        Self { linear: in_place(Vector([x, y, z])), angular }
    }
}

/// A vector of the plane or of space, in space.
pub(super) fn in_space<const D: usize>(v: Vector<f64, D>) -> Vector<f64, 3> {
    Vector(std::array::from_fn(|k| v.0.get(k).copied().unwrap_or(0.0)))
}

/// The first coordinates of a vector of space.
pub(super) fn in_place<const D: usize>(v: Vector<f64, 3>) -> Vector<f64, D> {
    Vector(std::array::from_fn(|k| v.0.get(k).copied().unwrap_or(0.0)))
}

/// a × b.
pub(super) fn cross(a: Vector<f64, 3>, b: Vector<f64, 3>) -> Vector<f64, 3> {
    let ([ax, ay, az], [bx, by, bz]) = (a.0, b.0);
    Vector([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
}

/// The rotation by a vector: `R = I + (sin θ / θ) W + (2 sin²(θ/2) / θ²) W²` with `W v = w × v`
/// and `θ = ‖w‖` (Rodrigues 1840).
fn turn<const D: usize>(w: Vector<f64, 3>) -> Rotation<D> {
    let angle = w.norm();
    let (first, second) = if angle > TINY {
        let half = libm::sin(0.5 * angle);
        (libm::sin(angle) / angle, 2.0 * half * half / (angle * angle))
    } else {
        (1.0, 0.5)
    };
    let column = |axis: usize| {
        let e = Vector::<f64, 3>::unit(axis);
        let turned = cross(w, e);
        e + turned * first + cross(w, turned) * second
    };
    let (x, y, z) = (column(0), column(1), column(2));
    let rows: [[f64; D]; D] = std::array::from_fn(|i| {
        let row = [x, y, z].map(|column| column.0.get(i).copied().unwrap_or(0.0));
        std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
    });
    Rotation::from_matrix(rows).unwrap_or_else(|_| Rotation::identity())
}

/// The vector of a rotation, at most π long: `2 atan2(‖q‖, w) q / ‖q‖` of its quaternion.
fn angle<const D: usize>(rotation: Rotation<D>) -> Vector<f64, 3> {
    let rows = std::array::from_fn(|i| {
        let unit = Vector::<f64, 3>::unit(i).0;
        std::array::from_fn(|k| {
            let inside = rotation.matrix().get(i).and_then(|row| row.get(k));
            inside.or(unit.get(k)).copied().unwrap_or(0.0)
        })
    });
    let Ok(rotation) = Rotation::<3>::from_matrix(rows) else { return Vector::ZERO };
    let [x, y, z, w] = rotation.quaternion();
    let axis = Vector([x, y, z]);
    let sine = axis.norm();
    if sine > 0.0 { axis * (2.0 * libm::atan2(sine, w) / sine) } else { Vector::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let to = Pose::rotation(Rotation::from_angle(0.25).unwrap());
        let twist = Twist::<2>::between(&Pose::identity(), &to);
        assert!((twist.angular - Vector([0.0, 0.0, 0.25])).norm() < 1e-15);
        let moved = twist.moved(&Pose::identity());
        assert!((moved.rotation.angle() - 0.25).abs() < 1e-15);
    }

    #[test]
    fn stacking_is_undone() {
        let twist = Twist { linear: Vector([1.0, -2.0]), angular: Vector([0.0, 0.0, 0.5]) };
        assert_eq!(twist.stacked(4.0), [1.0, -2.0, 0.0, 0.0, 0.0, 2.0]);
        assert_eq!(Twist::unstacked(twist.stacked(4.0), 4.0), twist);
    }
}
