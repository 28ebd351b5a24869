// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The coupling of a tool.
//!
//! Rigid motions as displacement and rotation vector.
//!
//! A rotation vector lies along the axis with the angle as length [rad]; in the plane along z.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::NumberError;
use palpate_field::{Pose, Rotation, Shape, ShapeError, SpaceShape, Vector};
use palpate_safety::Impedance;

use super::state::ToolOptions;
use super::{Shell, Tool};
use crate::error::{HapticsError, ServoOptions};

/// The rendered spring and damper between hand and tool: as requested in the
/// [options](ToolOptions), or softer if the device of a [`Servo`](crate::Servo) requires it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// The stiffness [N/m].
    pub stiffness: f64,
    /// The damping [N·s/m].
    pub damping: f64,
    /// The angular stiffness [N·m/rad].
    pub angular_stiffness: f64,
    /// The angular damping [N·m·s/rad].
    pub angular_damping: f64,
    /// The factor on the lever arms of the bodies' dampers, in [0, 1]. The factor applies both
    /// to the sensed velocity and to the applied torque, which keeps the dampers dissipative.
    pub arms: f64,
    /// The longest lever arm of a body's damper: the tool's reach [m].
    longest_arm: f64,
}

impl Coupling {
    /// The coupling that `options` request, for a tool with this `reach` [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if a stiffness is not positive.
    pub(super) fn new(options: &ToolOptions, reach: f64) -> Result<Self, HapticsError> {
        let stiffness = NumberError::check_positive("stiffness", options.stiffness, "N/m")?;
        let angular_stiffness = NumberError::check_positive(
            "angular_stiffness",
            options.angular_stiffness_with(reach),
            "N·m/rad",
        )?;
        let ToolOptions { damping, angular_damping, .. } = *options;
        Ok(Self {
            stiffness,
            damping,
            angular_stiffness,
            angular_damping,
            arms: 1.0,
            longest_arm: reach,
        })
    }

    /// The length of a radian that makes the coupling equally stiff in translation and rotation
    /// [m].
    pub(crate) fn unit(&self) -> f64 {
        (self.angular_stiffness / self.stiffness).sqrt()
    }

    /// The translational stiffness and damping that the hand feels of a body with the impedance
    /// `body`.
    pub(crate) fn on(&self, body: Impedance) -> Result<Impedance, HapticsError> {
        let stiffness = self.stiffness.min(body.stiffness());
        Ok(Impedance::new(stiffness, self.damping + body.damping())?)
    }

    /// What the bodies' layers bear.
    pub(crate) fn borne(&self, layers: &[Impedance]) -> Borne {
        let nothing = Borne { part: 0.0, damping: 0.0 };
        layers.iter().fold(nothing, |Borne { part, damping }, layer| {
            let borne = (layer.stiffness() / self.stiffness).min(1.0);
            Borne { part: part.max(borne), damping: damping.max(layer.damping()) }
        })
    }

    /// The angular stiffness and damping that the hand feels, if bodies bear so much on the longest
    /// lever arm.
    pub(crate) fn turning_on(
        &self,
        Borne { part, damping }: Borne,
    ) -> Result<Impedance, HapticsError> {
        let damping = self.angular_damping + self.damping_on_arms(damping);
        Ok(Impedance::new(self.angular_stiffness * part, damping)?)
    }

    /// The angular damping of a `damping` [N·s/m] on the longest lever arm [N·m·s/rad].
    pub(crate) fn damping_on_arms(&self, damping: f64) -> f64 {
        let arm = self.arms * self.longest_arm;
        damping * arm * arm
    }

    /// This coupling with these shares of its stiffness and of its damping, along and about axes.
    #[must_use]
    pub(crate) fn softened(self, stiffness: f64, damping: f64) -> Self {
        Self {
            stiffness: self.stiffness * stiffness,
            damping: self.damping * damping,
            ..self.softened_about_axes(stiffness, damping)
        }
    }

    /// This coupling with these shares of its angular stiffness and of its angular damping.
    #[must_use]
    pub(crate) fn softened_about_axes(self, stiffness: f64, damping: f64) -> Self {
        Self {
            angular_stiffness: self.angular_stiffness * stiffness,
            angular_damping: self.angular_damping * damping,
            ..self
        }
    }
}

/// What bodies bear of a coupling.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Borne {
    /// The largest part of the coupling that a layer bears.
    pub(crate) part: f64,
    /// The largest damping of a layer [N·s/m].
    pub(crate) damping: f64,
}

/// A change of a pose: the origin moves, then the pose rotates about it. World axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twist {
    /// The displacement of the origin [m].
    pub(crate) linear: Vector<f64, 3>,
    /// The rotation vector [rad]; in the plane only z is used.
    pub(crate) angular: Vector<f64, 3>,
}

impl Twist {
    pub(crate) const NONE: Self = Self { linear: Vector::ZERO, angular: Vector::ZERO };

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

/// A tool after a tick, for traces and snapshots. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HeldTool {
    /// The pose of the tool: `world_from_tool`.
    pub pose: Pose<3>,
    /// The rotation vector of the device relative to the tool [rad]; in the plane only z is
    /// used.
    pub turn: Vector<f64, 3>,
    /// The wanted torque on the hand about the tool's origin [N·m]; in the plane only z is
    /// used.
    pub torque: Vector<f64, 3>,
    /// The torque that the device gives to the hand [N·m]; `None` for a device without
    /// rotation.
    pub given: Option<Vector<f64, 3>>,
    /// The number of contacts that push.
    pub contacts: u32,
    /// How far the tool's surface may be from shell balls that are proven outside [m].
    pub resolution: f64,
    /// `true` if the budget did not allow all levels of the shell.
    pub is_degraded: bool,
    /// `true` if bodies cover the tool; it then gives no force.
    pub is_covered: bool,
}

impl Tool {
    /// The tool after the last tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn held(&self) -> HeldTool {
        let touch = self.touch();
        HeldTool {
            pose: touch.pose,
            turn: Twist::between(&touch.device, &touch.pose).angular,
            torque: touch.torque,
            given: None,
            contacts: touch.contacts.len() as u32,
            resolution: touch.resolution,
            is_degraded: touch.is_degraded,
            is_covered: touch.is_covered,
        }
    }

    /// This tool with a servo's rate, the smaller of both force limits and the longer of both
    /// rise times.
    pub(crate) fn of_servo(mut self, servo: &ServoOptions) -> Self {
        self.options.rate = servo.rate;
        self.options.rise_time = self.options.rise_time.max(servo.rise_time);
        let own = self.options.max_force.unwrap_or(f64::INFINITY);
        self.options.max_force = Some(own.min(servo.max_force));
        self
    }

    /// Lowers the force limit [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        self.options.max_force = Some(self.options.force_limit().min(max_force));
    }
}

impl Shell {
    /// The configuration-space obstacle of this shell turned by `rotation`: a field `g` of the
    /// tool's origin. The tool touches the shape where `g` is at most the
    /// [radius](crate::ShellPoint::radius) of its points.
    ///
    /// Lozano-Pérez, "Spatial planning: a configuration space approach" (1983). With the centres
    /// `c` of the first `points` of the shell, one at least, and the field `f` of `shape`,
    ///
    /// ```text
    /// g(x) = min f(x + R c)
    /// ```
    ///
    /// A `Tour` of `palpate-sim` over the obstacle, with the points' radius as probe radius, is a
    /// tour of the tool over `shape`, as deep as that of a probe.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Shape`] if the shape is nested too deeply.
    ///
    /// ```
    /// use palpate_field::{Rotation, Shape, Vector, kernel::Ball};
    /// use palpate_haptics::Shell;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
    /// let rod = Shell::capsule([Vector::ZERO, Vector([0.0, 0.1, 0.0])], 0.01, 11)?;
    /// let obstacle = rod.obstacle(&Rotation::identity(), &ball.into(), 11)?;
    /// // The upper end of the rod is 0.02 m below the lower end of the ball.
    /// assert!((obstacle.shape().distance(Vector([0.0, -0.17, 0.0])) - 0.02).abs() < 1e-15);
    /// assert!((obstacle.shape().distance(Vector([0.0, 0.07, 0.0])) - 0.02).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    pub fn obstacle(
        &self,
        rotation: &Rotation<3>,
        shape: &SpaceShape,
        points: usize,
    ) -> Result<SpaceShape, HapticsError> {
        let points = self.points().iter().take(points.max(1));
        let ways = points.map(|point| -rotation.rotate(point.centre));
        Ok(match shape.flat() {
            Some(flat) => at_all(flat, ways.map(Vector::truncated))?.into(),
            None => at_all(shape.shape(), ways)?.into(),
        })
    }
}

/// A shape at all of these places at once.
fn at_all<const D: usize>(
    shape: &Shape<D>,
    places: impl Iterator<Item = Vector<f64, D>>,
) -> Result<Shape<D>, ShapeError> {
    let moved = places.map(|place| shape.clone().translated(place));
    Shape::union(moved.collect::<Result<Vec<_>, _>>()?)
}

#[cfg(test)]
mod twist_tests {
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
