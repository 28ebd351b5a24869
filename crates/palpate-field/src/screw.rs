// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Screw motions from pose to pose.

use std::f64::consts::{PI, TAU};

use crate::error::{ShapeError, Unit};
use crate::pose::{Pose, Rotation};
use crate::vector::{Point, Vector};

/// A rotation by less than this [rad] has no axis that two poses determine: the axis would be 10⁹
/// times as far away as the body moves.
const NO_ROTATION: f64 = 1e-9;

/// A rigid motion from a pose to another at constant speed: a rotation about an axis together with
/// a translation along it (Chasles 1830); in the plane a rotation about a centre.
///
/// The body turns the shorter way, by at most π; `turns` adds whole turns about the same axis.
/// Where the poses are turned alike, whole turns are about the direction of the translation, as a
/// nut moves on its bolt; without a translation, about the body's y axis, in the plane about its
/// origin.
///
/// # Derivation
///
/// Let θ be the angle, n the axis, `v = v∥ + v⊥` the translation, all seen from the first pose,
/// and `φ = s (θ + 2πk)` the angle at the share s of the motion, with k whole turns. The axis goes
/// through `c = (v⊥ + cot(θ/2) n × v⊥) / 2`, and a point at the origin moves by
///
/// ```text
/// s v∥ + (I − R(φ)) c = s v∥ + sin(φ/2) / sin(θ/2) · (cos((φ − θ)/2) v⊥ + sin((φ − θ)/2) n × v⊥)
/// ```
///
/// The right side loses no digits where θ is small; without whole turns it tends to `s v`.
///
/// # Examples
///
/// Half a turn about (1, 0) takes the origin to (2, 0), over (1, −1):
///
/// ```
/// use palpate_field::{Pose, Rotation, Screw, Vector};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let half_turn = Rotation::from_angle(std::f64::consts::PI)?;
/// let screw = Screw::new(Pose::identity(), Pose::new(half_turn, Vector([2.0, 0.0])), 0)?;
/// let middle = screw.pose(0.5).translation;
/// assert!((middle - Vector([1.0, -1.0])).norm() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw<const D: usize> {
    from: Pose<D>,
    to: Pose<D>,
    /// The unit axis, seen from the first pose; z in the plane.
    axis: Vector<f64, 3>,
    /// The angle of the shorter way, without whole turns [rad].
    short_angle: f64,
    /// The angle with whole turns [rad].
    angle: f64,
    /// The translation along the axis, seen from the first pose [m]; zero in the plane.
    along: Vector<f64, 3>,
    /// The translation across the axis [m].
    across: Vector<f64, 3>,
}

impl<const D: usize> Screw<D> {
    /// The motion between two poses, with whole `turns` added in its direction, against it if negative.
    ///
    /// # Errors
    ///
    /// If a pose is not finite; in the plane, if whole turns are to end at another place with the
    /// same rotation, which is no rotation about a centre.
    pub fn new(from: Pose<D>, to: Pose<D>, turns: i32) -> Result<Self, ShapeError> {
        for pose in [&from, &to] {
            pose.check()?;
        }
        let between = from.inverse() * to;
        let vector = Rotation::identity().turn_to(&between.rotation);
        let translation = in_space(between.translation);
        let (axis, angle) = match (vector.norm(), vector.normalized()) {
            (angle, Some(axis)) if angle >= NO_ROTATION => (axis, angle),
            _ if turns == 0 || D == 2 => (Vector([0.0, 0.0, 1.0]), 0.0),
            _ => (translation.normalized().unwrap_or(Vector([0.0, 1.0, 0.0])), 0.0),
        };
        let along = axis * translation.dot(axis);
        let across = translation - along;
        if D == 2 && turns != 0 && angle == 0.0 && across != Vector::ZERO {
            let rule = "0 for a translation in the plane";
            return Err(ShapeError::number("turns", rule, f64::from(turns), Unit::One));
        }
        let (short_angle, angle) = (angle, angle + TAU * f64::from(turns));
        Ok(Self { from, to, axis, short_angle, angle, along, across })
    }

    /// The first pose.
    #[must_use]
    pub fn from(&self) -> &Pose<D> {
        &self.from
    }

    /// The last pose.
    #[must_use]
    pub fn to(&self) -> &Pose<D> {
        &self.to
    }

    /// The angle of the whole motion, whole turns included [rad].
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// The pose after a share of the motion: the first at 0 and below, the last at 1 and above.
    #[must_use]
    pub fn pose(&self, share: f64) -> Pose<D> {
        if share >= 1.0 {
            return self.to;
        }
        if share.is_nan() || share <= 0.0 {
            return self.from;
        }
        let phi = share * self.angle;
        // A motion without rotation has no centre to turn about.
        let (ratio, off) = if self.short_angle < NO_ROTATION {
            (share, 0.0)
        } else {
            let half = 0.5 * self.short_angle;
            (libm::sin(0.5 * phi) / libm::sin(half), 0.5 * phi - half)
        };
        let across =
            self.across * libm::cos(off) + self.axis.cross(self.across) * libm::sin(off);
        let translation: Point<D> = from_space(self.along * share + across * ratio);
        // `turned` takes vectors of any length; whole turns change nothing.
        let phi = phi - TAU * ((phi + PI) / TAU).floor();
        let rotation = Rotation::identity().turned(self.axis * phi);
        self.from * Pose::new(rotation, translation)
    }

    /// The part of the motion between two shares, of which the first may be the later; beyond 0 and 1
    /// the body rests.
    ///
    /// ```
    /// use palpate_field::{Pose, Screw};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let [from, to] = [0.0, 2.0].map(|x| Pose::<2>::translation([x, 0.0]));
    /// let back = Screw::new(from, to, 0)?.part(1.0, 0.5)?;
    /// assert_eq!([0.0, 0.5, 1.0].map(|share| back.pose(share).translation[0]), [2.0, 1.5, 1.0]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the part turns by half a turn or more, or a share is NaN: its ends would not say about which
    /// axis.
    pub fn part(&self, first: f64, last: f64) -> Result<Self, ShapeError> {
        let [first, last] = [first, last].map(|share| share.clamp(0.0, 1.0));
        let angle = (self.angle * (last - first)).abs();
        // Written so that NaN is refused.
        if angle < PI {
            Self::new(self.pose(first), self.pose(last), 0)
        } else {
            Err(ShapeError::number(
                "angle of a part",
                "less than half a turn",
                angle,
                Unit::Radian,
            ))
        }
    }

    /// The velocity of a point of the body over the whole motion as a unit of time, both in the
    /// body's coordinates [m]: it stays the same, and so does its size in the world.
    ///
    /// With the numbers of the derivation and `Θ = θ + 2πk`, it is `v∥ + Θ/2 (cot(θ/2) v⊥ − n × v⊥) +
    /// Θ n × p`: the derivative at the beginning, where the origin moves by the first two terms.
    ///
    /// ```
    /// use palpate_field::{Pose, Rotation, Screw, Vector};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let half_turn = Rotation::from_angle(std::f64::consts::PI)?;
    /// let screw = Screw::new(Pose::identity(), Pose::new(half_turn, Vector([2.0, 0.0])), 0)?;
    /// // The centre of rotation stays, and the origin goes half a circle of one metre round it.
    /// assert!(screw.velocity(Vector([1.0, 0.0])).norm() < 1e-15);
    /// assert!((screw.velocity(Vector([0.0, 0.0])).norm() - std::f64::consts::PI).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn velocity(&self, p: Point<D>) -> Vector<f64, D> {
        let half = 0.5 * self.short_angle;
        let across = if self.short_angle < NO_ROTATION {
            self.across
        } else {
            let tangent = libm::tan(half);
            (self.across * (1.0 / tangent) - self.axis.cross(self.across)) * (0.5 * self.angle)
        };
        let turning = self.axis.cross(in_space(p)) * self.angle;
        from_space(self.along + across + turning)
    }
}

fn in_space<const D: usize>(v: Vector<f64, D>) -> Vector<f64, 3> {
    Vector(std::array::from_fn(|k| v.0.get(k).copied().unwrap_or(0.0)))
}

fn from_space<const D: usize>(v: Vector<f64, 3>) -> Vector<f64, D> {
    Vector(std::array::from_fn(|k| v[k]))
}
