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
    /// The names of the numbers of a profile. [`assumed`](Self::assumed) lists those that the source
    /// does not state.
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
    /// let turning = TurningProfile { max_torque: 0.2, ..TurningProfile::unlimited() };
    /// let device = DeviceProfile {
    ///     turning: Some(turning),
    ///     ..DeviceProfile::unlimited("six degrees of freedom")
    /// };
    /// assert!(device.turning.is_some_and(|turning| turning.max_stiffness == f64::INFINITY));
    /// ```
    #[must_use]
    pub const fn unlimited() -> Self {
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
            source: Cow::Borrowed(""),
            assumed: Cow::Borrowed(&[]),
        }
    }
}
