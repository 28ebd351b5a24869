// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The limits and properties of a device.

use std::borrow::Cow;

use crate::gripper_profile::GripperProfile;
use crate::turning_profile::TurningProfile;

/// The limits and properties of a device. Numbers are the maker's where they exist, and assumed
/// where they do not.
///
/// No safe default exists for an unknown device: start from [`unlimited`](Self::unlimited) and
/// set every number that its maker states or that you measured. A number that is left out
/// switches its rule off: without `max_force` any force passes, without `friction` and
/// `least_damping` any stiffness.
///
/// ```
/// use palpate_device::DeviceProfile;
///
/// let device = DeviceProfile {
///     max_force: 2.5,
///     continuous_force: 0.8,
///     max_force_rate: 1500.0,
///     max_stiffness: 1000.0,
///     max_damping: 5.0,
///     workspace_radius: 0.08,
///     mass: 0.05,
///     least_damping: 0.2,
///     friction: 0.1,
///     encoder_step: 30e-6,
///     max_speed: 5.0,
///     max_acceleration: 500.0,
///     ..DeviceProfile::unlimited("example")
/// };
/// assert_eq!((device.max_force, device.mass), (2.5, 0.05));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DeviceProfile {
    /// The device's name.
    pub name: Cow<'static, str>,
    /// Largest force [N].
    pub max_force: f64,
    /// Largest force that the device can give without time limit [N].
    pub continuous_force: f64,
    /// Fastest change of force [N/s].
    pub max_force_rate: f64,
    /// Largest stiffness it renders at 1 kHz [N/m].
    pub max_stiffness: f64,
    /// Largest damping it renders at 1 kHz [N·s/m].
    pub max_damping: f64,
    /// Radius of the ball it reaches [m].
    pub workspace_radius: f64,
    /// Apparent mass in the hand [kg].
    pub mass: f64,
    /// The least physical damping of the device that can be relied on, b of Colgate and
    /// Schenkel (1997) [N·s/m].
    pub least_damping: f64,
    /// Coulomb friction of the device, f_c of Abbott and Okamura (2005) [N].
    pub friction: f64,
    /// Resolution of the encoders at the handle [m].
    pub encoder_step: f64,
    /// The largest speed of a hand that holds the device [m/s]: what would be faster is a
    /// fault.
    pub max_speed: f64,
    /// The largest acceleration of a hand that holds the device [m/s²].
    pub max_acceleration: f64,
    /// The rotational properties; `None` for a device that does not sense orientation.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub turning: Option<TurningProfile>,
    /// The gripper; `None` for a device without one.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub gripper: Option<GripperProfile>,
    /// The names of the buttons, in the order of their indices; none if the device has no button
    /// or its names are not known.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "<[_]>::is_empty"))]
    pub buttons: Cow<'static, [Cow<'static, str>]>,
    /// The source of the numbers.
    pub source: Cow<'static, str>,
    /// Names of the fields whose numbers are assumed and not from the source.
    pub assumed: Cow<'static, [&'static str]>,
}

impl DeviceProfile {
    /// The names of the numbers of a profile. [`assumed`](Self::assumed) lists those that the source
    /// does not state.
    pub const NUMBERS: &'static [&'static str] = &[
        "max_force",
        "continuous_force",
        "max_force_rate",
        "max_stiffness",
        "max_damping",
        "workspace_radius",
        "mass",
        "least_damping",
        "friction",
        "encoder_step",
        "max_speed",
        "max_acceleration",
    ];

    /// An ideal device: no limits, no mass, no encoder steps, and damping and friction that pass
    /// every rule.
    ///
    /// ```
    /// let ideal = palpate_device::DeviceProfile::unlimited("ideal");
    /// assert_eq!((ideal.max_force, ideal.mass), (f64::INFINITY, 0.0));
    /// ```
    #[must_use]
    pub fn unlimited(name: impl Into<Cow<'static, str>>) -> Self {
        Self {
            name: name.into(),
            max_force: f64::INFINITY,
            continuous_force: f64::INFINITY,
            max_force_rate: f64::INFINITY,
            max_stiffness: f64::INFINITY,
            max_damping: f64::INFINITY,
            workspace_radius: f64::INFINITY,
            mass: 0.0,
            least_damping: f64::INFINITY,
            friction: f64::INFINITY,
            encoder_step: 0.0,
            max_speed: f64::INFINITY,
            max_acceleration: f64::INFINITY,
            turning: None,
            gripper: None,
            buttons: Cow::Borrowed(&[]),
            source: Cow::Borrowed(""),
            assumed: Cow::Borrowed(&[]),
        }
    }

    /// The same profile with buttons of these names.
    #[must_use]
    pub fn with_buttons<N>(self, buttons: impl IntoIterator<Item = N>) -> Self
    where
        N: Into<Cow<'static, str>>,
    {
        Self { buttons: buttons.into_iter().map(Into::into).collect(), ..self }
    }
}
