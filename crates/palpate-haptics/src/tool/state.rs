// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The input and the result of a tool's tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{LARGEST_LENGTH, Pose, Vector};
use palpate_query::Contact;

use super::closest::FREEDOMS;
use super::shell::FIRST_LEVEL;
use crate::error::HapticsError;
use palpate_device::NumberError;

/// The requested virtual coupling of a tool, its limits, and the budget of a tick.
///
/// In a servo, the rate is the servo's; of two force limits the smaller holds, and of two rise
/// times the longer.
///
/// ```
/// use palpate_haptics::ToolOptions;
///
/// let options = ToolOptions {
///     stiffness: 400.0,
///     angular_stiffness: Some(2.0),
///     ..ToolOptions::default()
/// };
/// assert_eq!((options.stiffness, options.angular_stiffness), (400.0, Some(2.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOptions {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The coupling's stiffness [N/m].
    pub stiffness: f64,
    /// The coupling's angular stiffness [N·m/rad]; `None` means `K ρ² / 2` with the tool's
    /// reach `ρ`.
    pub angular_stiffness: Option<f64>,
    /// The coupling's damping [N·s/m].
    pub damping: f64,
    /// The coupling's angular damping [N·m·s/rad].
    pub angular_damping: f64,
    /// The largest force on the hand [N]; infinite for no limit. `None` means the servo's limit,
    /// and 3.3 N for a tool without a servo.
    pub max_force: Option<f64>,
    /// The largest torque on the hand [N·m]; infinite for no limit.
    pub max_torque: f64,
    /// The most evaluations of the bodies in a tick; at least 32.
    pub budget: u32,
    /// The time over which the force rises from zero after bodies covered the tool [s].
    pub rise_time: f64,
}

/// The force limit of a tool without a servo [N]: that of a desktop stylus.
const MAX_FORCE: f64 = 3.3;

/// What a hand moves beside itself: the handle of a device, with a light tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle {
    /// The mass [kg].
    pub mass: f64,
    /// The moment of inertia about the tool's origin [kg·m²].
    pub inertia: f64,
}

impl ToolOptions {
    /// These options with the damping ratio `ratio` (ζ) for a `handle`: `2 ζ √(K m)` and
    /// `2 ζ √(κ I)`, with the stiffnesses `K` and `κ` of a tool with this `reach` [m]. A ratio
    /// of 1 is critical damping.
    ///
    /// ```
    /// use palpate_haptics::{Handle, Shell, ToolOptions};
    ///
    /// # fn main() -> Result<(), palpate_haptics::HapticsError> {
    /// let shell = Shell::ball(0.5)?;
    /// let handle = Handle { mass: 0.01, inertia: 0.02 };
    /// let options = ToolOptions { stiffness: 400.0, ..ToolOptions::default() };
    /// let critical = options.with_damping_ratio(1.0, handle, shell.reach());
    /// assert_eq!(critical.damping, 4.0); // 2 √(400 · 0.01)
    /// assert_eq!(critical.angular_damping, 2.0); // 2 √(50 · 0.02), of K ρ² / 2 = 50 N·m/rad
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_damping_ratio(self, ratio: f64, handle: Handle, reach: f64) -> Self {
        let Handle { mass, inertia } = handle;
        let damping = 2.0 * ratio * (self.stiffness * mass).sqrt();
        let angular_damping =
            2.0 * ratio * (self.angular_stiffness_with(reach) * inertia).sqrt();
        Self { damping, angular_damping, ..self }
    }

    /// The angular stiffness of a tool with this `reach` [m] [N·m/rad].
    pub(super) fn angular_stiffness_with(&self, reach: f64) -> f64 {
        self.angular_stiffness.unwrap_or(0.5 * self.stiffness * reach * reach)
    }

    /// The force limit of a tool without a servo [N].
    pub(crate) fn force_limit(&self) -> f64 {
        self.max_force.unwrap_or(MAX_FORCE)
    }

    /// Checks all options except the stiffnesses.
    pub(super) fn check(&self) -> Result<(), HapticsError> {
        NumberError::check_rate(self.rate)?;
        NumberError::check_positive("rise_time", self.rise_time, "s")?;
        NumberError::check_not_negative("damping", self.damping, "N·s/m")?;
        NumberError::check_not_negative("angular_damping", self.angular_damping, "N·m·s/rad")?;
        for (parameter, value, unit) in
            [("max_force", self.force_limit(), "N"), ("max_torque", self.max_torque, "N·m")]
        {
            if value.is_nan() || value <= 0.0 {
                return Err(HapticsError::Number(NumberError::new(
                    parameter, "positive", value, unit,
                )));
            }
        }
        if (self.budget as usize) < 2 * FIRST_LEVEL {
            let (parameter, rule, unit) = ("budget", "at least 32", "evaluations");
            let value = f64::from(self.budget);
            return Err(HapticsError::Number(NumberError::new(parameter, rule, value, unit)));
        }
        Ok(())
    }
}

impl Default for ToolOptions {
    /// 1 kHz; 500 N/m and 1 N·s/m, which damps 0.5 g critically; the servo's force limit and
    /// 0.2 N·m; 16 384 evaluations; rise in 0.1 s.
    fn default() -> Self {
        Self {
            rate: 1000.0,
            stiffness: 500.0,
            angular_stiffness: None,
            damping: 1.0,
            angular_damping: 0.0,
            max_force: None,
            max_torque: 0.2,
            budget: 16_384,
            rise_time: 0.1,
        }
    }
}

/// The state of the device that holds a tool, as read in a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// The goal of the tool, the device's pose: `world_from_tool`.
    pub pose: Pose<3>,
    /// The velocity of the origin [m/s].
    pub velocity: Vector<f64, 3>,
    /// The angular velocity [rad/s]; in the plane only z is used.
    pub angular_velocity: Vector<f64, 3>,
}

impl ToolState {
    /// A device at rest.
    #[must_use]
    pub fn at_rest(pose: Pose<3>) -> Self {
        Self { pose, velocity: Vector::ZERO, angular_velocity: Vector::ZERO }
    }

    /// `true` if all numbers are finite and poses at most 1e15 m away.
    pub(super) fn is_usable(&self) -> bool {
        // Written so that NaN fails.
        self.pose.is_finite()
            && self.pose.translation.0.iter().all(|x| x.abs() <= LARGEST_LENGTH)
            && self.velocity.is_finite()
            && self.angular_velocity.is_finite()
    }
}

/// A tool after a tick. World coordinates.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolTouch {
    /// The device's pose: the goal of the tool.
    pub device: Pose<3>,
    /// The tool's pose; equal to the device's pose in free space.
    pub pose: Pose<3>,
    /// The velocity of the tool's origin in this tick [m/s].
    pub velocity: Vector<f64, 3>,
    /// The force on the hand [N], always finite.
    pub force: Vector<f64, 3>,
    /// The torque on the hand about the tool's origin [N·m], always finite; in the plane only z
    /// is used.
    pub torque: Vector<f64, 3>,
    /// `true` if bodies keep the tool from the device's pose.
    pub contact: bool,
    /// The index of the body that pushes hardest; `None` without contact.
    pub body: Option<u32>,
    /// The outward unit normal of that body at the contact; zero without contact.
    pub normal: Vector<f64, 3>,
    /// The contacts that push, at most six: from the tool (a) to a body (b).
    pub contacts: Vec<Contact<3>>,
    /// `true` if the tool slips; `false` if it sticks, or if there is no friction.
    pub is_slipping: bool,
    /// `true` if the tool is inside bodies and did not get out in this tick; it then gives no
    /// force.
    pub is_covered: bool,
    /// The number of points of the shell.
    pub points: u32,
    /// The number of points that are proven outside at the tool's pose: evaluated in this tick,
    /// or so far away in an earlier tick that the tool cannot have reached the bodies since.
    pub points_known: u32,
    /// The largest distance of the tool's surface from shell balls that are proven outside [m].
    /// With fields of Lipschitz constant 1, no part of the tool is deeper than this. See
    /// [`Shell`].
    ///
    /// [`Shell`]: crate::Shell
    pub resolution: f64,
    /// `true` if the budget did not allow all levels of the shell.
    pub is_degraded: bool,
    /// Evaluations of the bodies in this tick.
    pub evaluations: u32,
}

impl ToolTouch {
    pub(super) fn new(points: usize) -> Self {
        Self {
            device: Pose::identity(),
            pose: Pose::identity(),
            velocity: Vector::ZERO,
            force: Vector::ZERO,
            torque: Vector::ZERO,
            contact: false,
            body: None,
            normal: Vector::ZERO,
            contacts: Vec::with_capacity(FREEDOMS),
            is_slipping: false,
            is_covered: false,
            points: points as u32,
            points_known: 0,
            resolution: f64::INFINITY,
            is_degraded: false,
            evaluations: 0,
        }
    }

    /// Resets the touch: no contact, no force, no evaluated points.
    pub(super) fn lose(&mut self) {
        (self.force, self.torque, self.velocity) = (Vector::ZERO, Vector::ZERO, Vector::ZERO);
        (self.contact, self.body, self.evaluations) = (false, None, 0);
        (self.normal, self.is_slipping) = (Vector::ZERO, false);
        self.contacts.clear();
    }
}
