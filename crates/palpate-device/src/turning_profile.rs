// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The rotational limits and properties of a device.

use std::borrow::Cow;

/// The rotational counterpart of a [`DeviceProfile`](crate::DeviceProfile), with angles for lengths and torques for
/// forces. Each number holds for the worst axis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TurningProfile {
    /// Largest torque [N·m]; zero for a device that senses its orientation but gives no torque.
    pub max_torque: f64,
    /// Largest torque that the device can give without time limit [N·m].
    pub continuous_torque: f64,
    /// Fastest change of torque [N·m/s].
    pub max_torque_rate: f64,
    /// Largest angular stiffness it renders at 1 kHz [N·m/rad].
    pub max_stiffness: f64,
    /// Largest angular damping it renders at 1 kHz [N·m·s/rad].
    pub max_damping: f64,
    /// Apparent moment of inertia in the hand [kg·m²].
    pub inertia: f64,
    /// The least physical angular damping of the device that can be relied on [N·m·s/rad].
    pub least_damping: f64,
    /// Coulomb friction of the device [N·m].
    pub friction: f64,
    /// Resolution of the encoders [rad].
    pub encoder_step: f64,
    /// The largest angular speed of a hand that holds the device [rad/s]: what would be faster is a
    /// fault.
    pub max_speed: f64,
    /// The largest angular acceleration of a hand that holds the device [rad/s²].
    pub max_acceleration: f64,
    /// The source of the numbers.
    pub source: Cow<'static, str>,
    /// Names of the fields whose numbers are assumed and not from the source.
    pub assumed: Cow<'static, [&'static str]>,
}

impl TurningProfile {
    /// The names of its numbers, of which [`assumed`](Self::assumed) has those that its source does
    /// not tell.
    pub const NUMBERS: &'static [&'static str] = &[
        "max_torque",
        "continuous_torque",
        "max_torque_rate",
        "max_stiffness",
        "max_damping",
        "inertia",
        "least_damping",
        "friction",
        "encoder_step",
        "max_speed",
        "max_acceleration",
    ];

    /// A device that gives any torque, without inertia, friction or steps.
    ///
    /// ```
    /// use palpate_device::{DeviceProfile, TurningProfile};
    ///
    /// let turning = TurningProfile::unlimited().with_max_torque(0.2);
    /// let device = DeviceProfile::unlimited("six degrees of freedom").with_turning(turning);
    /// assert!(device.turning.is_some_and(|turning| turning.max_stiffness == f64::INFINITY));
    /// ```
    #[must_use]
    pub const fn unlimited() -> Self {
        Self::of_source("", &[])
    }

    /// An ideal device with the source of its numbers and the names of those that are assumed. In
    /// a constant, setters then replace the ideal numbers.
    #[must_use]
    pub const fn of_source(source: &'static str, assumed: &'static [&'static str]) -> Self {
        Self {
            max_torque: f64::INFINITY,
            continuous_torque: f64::INFINITY,
            max_torque_rate: f64::INFINITY,
            max_stiffness: f64::INFINITY,
            max_damping: f64::INFINITY,
            inertia: 0.0,
            least_damping: f64::INFINITY,
            friction: f64::INFINITY,
            encoder_step: 0.0,
            max_speed: f64::INFINITY,
            max_acceleration: f64::INFINITY,
            source: Cow::Borrowed(source),
            assumed: Cow::Borrowed(assumed),
        }
    }

    /// The same profile with another torque limit [N·m].
    #[must_use]
    pub const fn with_max_torque(mut self, max_torque: f64) -> Self {
        self.max_torque = max_torque;
        self
    }

    /// The same profile with another continuous limit [N·m].
    #[must_use]
    pub const fn with_continuous_torque(mut self, continuous_torque: f64) -> Self {
        self.continuous_torque = continuous_torque;
        self
    }

    /// The same profile with another slew limit [N·m/s].
    #[must_use]
    pub const fn with_max_torque_rate(mut self, max_torque_rate: f64) -> Self {
        self.max_torque_rate = max_torque_rate;
        self
    }

    /// The same profile with another largest angular stiffness [N·m/rad].
    #[must_use]
    pub const fn with_max_stiffness(mut self, max_stiffness: f64) -> Self {
        self.max_stiffness = max_stiffness;
        self
    }

    /// The same profile with another largest angular damping [N·m·s/rad].
    #[must_use]
    pub const fn with_max_damping(mut self, max_damping: f64) -> Self {
        self.max_damping = max_damping;
        self
    }

    /// The same profile with another apparent moment of inertia [kg·m²].
    #[must_use]
    pub const fn with_inertia(mut self, inertia: f64) -> Self {
        self.inertia = inertia;
        self
    }

    /// The same profile with another least physical angular damping [N·m·s/rad].
    #[must_use]
    pub const fn with_least_damping(mut self, least_damping: f64) -> Self {
        self.least_damping = least_damping;
        self
    }

    /// The same profile with another Coulomb friction [N·m].
    #[must_use]
    pub const fn with_friction(mut self, friction: f64) -> Self {
        self.friction = friction;
        self
    }

    /// The same profile with another resolution of the encoders [rad].
    #[must_use]
    pub const fn with_encoder_step(mut self, encoder_step: f64) -> Self {
        self.encoder_step = encoder_step;
        self
    }

    /// The same profile with another largest angular speed of the hand [rad/s].
    #[must_use]
    pub const fn with_max_speed(mut self, max_speed: f64) -> Self {
        self.max_speed = max_speed;
        self
    }

    /// The same profile with another largest angular acceleration of the hand [rad/s²].
    #[must_use]
    pub const fn with_max_acceleration(mut self, max_acceleration: f64) -> Self {
        self.max_acceleration = max_acceleration;
        self
    }

    /// The same profile with another source of the numbers.
    #[must_use]
    pub fn with_source(self, source: impl Into<Cow<'static, str>>) -> Self {
        Self { source: source.into(), ..self }
    }

    /// The same profile with other names of fields that are assumed.
    #[must_use]
    pub fn with_assumed(self, assumed: impl Into<Cow<'static, [&'static str]>>) -> Self {
        Self { assumed: assumed.into(), ..self }
    }
}
