// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What goes into a tick of a tool, and what comes out of it.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{LARGEST_LENGTH, Pose, Vector};
use palpate_query::Contact;

use super::closest::FREEDOMS;
use super::shell::FIRST_LEVEL;
use crate::error::HapticsError;
use palpate_safety::{NumberError, not_negative, positive};

/// How a tool hangs on the hand, and what a tick may cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOptions {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The coupling's stiffness [N/m].
    pub stiffness: f64,
    /// The coupling's angular stiffness [N·m/rad]; `K ρ² / 2` with the tool's reach `ρ` if
    /// none.
    pub angular_stiffness: Option<f64>,
    /// The coupling's damping [N·s/m].
    pub damping: f64,
    /// The coupling's angular damping [N·m·s/rad].
    pub angular_damping: f64,
    /// The largest force on the hand [N]; infinite for none.
    pub max_force: f64,
    /// The largest torque on the hand [N·m]; infinite for none.
    pub max_torque: f64,
    /// The most evaluations of the bodies a tick; at least 32.
    pub budget: u32,
    /// The time over which the force rises from nothing to all of it, where bodies covered the
    /// tool [s].
    pub rise_time: f64,
}

impl ToolOptions {
    /// The same with a damping of `ratio` on what the hand holds, of `mass` [kg] and moment of
    /// inertia `inertia` [kg·m²]: `2 ζ √(K m)` and `2 ζ √(κ I)`. A ratio of 1 is critical.
    ///
    /// Without an angular stiffness there is no angular damping.
    ///
    /// ```
    /// use palpate_haptics::ToolOptions;
    ///
    /// let options = ToolOptions { stiffness: 400.0, ..ToolOptions::default() };
    /// let critical = options.with_damping_ratio(1.0, 0.01, 0.0);
    /// assert_eq!(critical.damping, 4.0); // 2 √(400 · 0.01)
    /// ```
    #[must_use]
    pub fn with_damping_ratio(self, ratio: f64, mass: f64, inertia: f64) -> Self {
        let angular = self.angular_stiffness.unwrap_or(0.0);
        let damping = 2.0 * ratio * (self.stiffness * mass).sqrt();
        let angular_damping = 2.0 * ratio * (angular * inertia).sqrt();
        Self { damping, angular_damping, ..self }
    }

    /// Checks all but the stiffnesses.
    pub(super) fn check(&self) -> Result<(), HapticsError> {
        positive("rate", self.rate, "Hz")?;
        positive("rise_time", self.rise_time, "s")?;
        not_negative("damping", self.damping, "N·s/m")?;
        not_negative("angular_damping", self.angular_damping, "N·m·s/rad")?;
        for (parameter, value, unit) in
            [("max_force", self.max_force, "N"), ("max_torque", self.max_torque, "N·m")]
        {
            if value.is_nan() || value <= 0.0 {
                return Err(HapticsError::Number(NumberError {
                    parameter,
                    rule: "positive",
                    value,
                    unit,
                }));
            }
        }
        if (self.budget as usize) < 2 * FIRST_LEVEL {
            let (parameter, rule, unit) = ("budget", "at least 32", "evaluations");
            let value = f64::from(self.budget);
            return Err(HapticsError::Number(NumberError { parameter, rule, value, unit }));
        }
        Ok(())
    }
}

impl Default for ToolOptions {
    /// 1 kHz; 500 N/m, and critical damping of 0.5 g on it, 1 N·s/m; 3.3 N and 0.2 N·m; 16 384
    /// evaluations; 0.1 s.
    fn default() -> Self {
        Self {
            rate: 1000.0,
            stiffness: 500.0,
            angular_stiffness: None,
            damping: 1.0,
            angular_damping: 0.0,
            max_force: 3.3,
            max_torque: 0.2,
            budget: 16_384,
            rise_time: 0.1,
        }
    }
}

/// The device that holds a tool, as read in a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState<const D: usize> {
    /// Where the device would have the tool: `world_from_tool`.
    pub pose: Pose<D>,
    /// How fast its origin moves [m/s].
    pub velocity: Vector<f64, D>,
    /// How fast it turns [rad/s]; in the plane about z alone.
    pub angular_velocity: Vector<f64, 3>,
}

impl<const D: usize> ToolState<D> {
    /// A device at rest.
    #[must_use]
    pub fn at_rest(pose: Pose<D>) -> Self {
        Self { pose, velocity: Vector::ZERO, angular_velocity: Vector::ZERO }
    }

    /// `true` if all numbers can be computed with.
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
pub struct ToolTouch<const D: usize> {
    /// Where the device would have the tool.
    pub device: Pose<D>,
    /// Where the tool is; the device's pose itself in free space.
    pub pose: Pose<D>,
    /// How fast the tool's origin moved in this tick [m/s].
    pub velocity: Vector<f64, D>,
    /// The force on the hand [N], always finite.
    pub force: Vector<f64, D>,
    /// The torque on the hand about the tool's origin [N·m], always finite; in the plane about
    /// z alone.
    pub torque: Vector<f64, 3>,
    /// `true` if bodies keep the tool from the device's pose.
    pub contact: bool,
    /// The body that pushes hardest, by its number; none without contact.
    pub body: Option<u32>,
    /// The unit normal of that body where it pushes, pointing out; zero without contact.
    pub normal: Vector<f64, D>,
    /// The contacts that push, at most six: from the tool (a) to a body (b).
    pub contacts: Vec<Contact<D>>,
    /// `true` if the tool moves along the bodies against friction; `false` if friction holds it,
    /// or there is none.
    pub is_slipping: bool,
    /// `true` if the tool is in the bodies and did not get out in this tick: it touches
    /// nothing.
    pub is_covered: bool,
    /// Points of the shell.
    pub points: u32,
    /// How many of them are known to be outside where the tool is: looked at in this tick, or
    /// so far away in an earlier one that the tool has not come there since.
    pub points_known: u32,
    /// How far the tool's surface may be from balls that are known to be outside [m]: where
    /// fields have a Lipschitz constant of 1, nothing of the tool is deeper. See [`Shell`].
    ///
    /// [`Shell`]: crate::Shell
    pub resolution: f64,
    /// `true` if the budget did not allow all levels of the shell.
    pub is_degraded: bool,
    /// Evaluations of the bodies in this tick.
    pub evaluations: u32,
}

impl<const D: usize> ToolTouch<D> {
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

    /// Nothing is felt, and nothing was looked at.
    pub(super) fn lose(&mut self) {
        (self.force, self.torque, self.velocity) = (Vector::ZERO, Vector::ZERO, Vector::ZERO);
        (self.contact, self.body, self.evaluations) = (false, None, 0);
        (self.normal, self.is_slipping) = (Vector::ZERO, false);
        self.contacts.clear();
    }
}
