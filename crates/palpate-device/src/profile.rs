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
/// let device = DeviceProfile::unlimited("example")
///     .with_max_force(2.5)
///     .with_continuous_force(0.8)
///     .with_max_force_rate(1500.0)
///     .with_max_stiffness(1000.0)
///     .with_max_damping(5.0)
///     .with_workspace_radius(0.08)
///     .with_mass(0.05)
///     .with_least_damping(0.2)
///     .with_friction(0.1)
///     .with_encoder_step(30e-6)
///     .with_max_speed(5.0)
///     .with_max_acceleration(500.0);
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
    /// The names of its numbers, of which [`assumed`](Self::assumed) has those that its source does
    /// not tell.
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
        Self { name: name.into(), ..Self::of_source("", "", &[], None) }
    }

    /// An ideal device with the source of its numbers, the names of those that are assumed, and
    /// rotational properties. In a constant, setters then replace the ideal numbers.
    ///
    /// ```
    /// use palpate_device::DeviceProfile;
    ///
    /// const STYLUS: DeviceProfile =
    ///     DeviceProfile::of_source("stylus", "its data sheet", &["mass"], None)
    ///         .with_max_force(3.0)
    ///         .with_mass(0.05);
    /// assert_eq!((STYLUS.max_force, STYLUS.mass), (3.0, 0.05));
    /// ```
    #[must_use]
    pub const fn of_source(
        name: &'static str,
        source: &'static str,
        assumed: &'static [&'static str],
        turning: Option<TurningProfile>,
    ) -> Self {
        Self {
            name: Cow::Borrowed(name),
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
            turning,
            gripper: None,
            buttons: Cow::Borrowed(&[]),
            source: Cow::Borrowed(source),
            assumed: Cow::Borrowed(assumed),
        }
    }

    /// The same profile with another name.
    #[must_use]
    pub fn with_name(self, name: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The same profile with another force limit [N].
    #[must_use]
    pub const fn with_max_force(mut self, max_force: f64) -> Self {
        self.max_force = max_force;
        self
    }

    /// The same profile with another continuous limit [N].
    #[must_use]
    pub const fn with_continuous_force(mut self, continuous_force: f64) -> Self {
        self.continuous_force = continuous_force;
        self
    }

    /// The same profile with another slew limit [N/s].
    #[must_use]
    pub const fn with_max_force_rate(mut self, max_force_rate: f64) -> Self {
        self.max_force_rate = max_force_rate;
        self
    }

    /// The same profile with another largest stiffness [N/m].
    #[must_use]
    pub const fn with_max_stiffness(mut self, max_stiffness: f64) -> Self {
        self.max_stiffness = max_stiffness;
        self
    }

    /// The same profile with another largest damping [N·s/m].
    #[must_use]
    pub const fn with_max_damping(mut self, max_damping: f64) -> Self {
        self.max_damping = max_damping;
        self
    }

    /// The same profile with another radius of its workspace [m].
    #[must_use]
    pub const fn with_workspace_radius(mut self, workspace_radius: f64) -> Self {
        self.workspace_radius = workspace_radius;
        self
    }

    /// The same profile with another apparent mass [kg].
    #[must_use]
    pub const fn with_mass(mut self, mass: f64) -> Self {
        self.mass = mass;
        self
    }

    /// The same profile with another least physical damping [N·s/m].
    #[must_use]
    pub const fn with_least_damping(mut self, least_damping: f64) -> Self {
        self.least_damping = least_damping;
        self
    }

    /// The same profile with another Coulomb friction [N].
    #[must_use]
    pub const fn with_friction(mut self, friction: f64) -> Self {
        self.friction = friction;
        self
    }

    /// The same profile with another resolution of the encoders [m].
    #[must_use]
    pub const fn with_encoder_step(mut self, encoder_step: f64) -> Self {
        self.encoder_step = encoder_step;
        self
    }

    /// The same profile with another largest speed of the hand [m/s].
    #[must_use]
    pub const fn with_max_speed(mut self, max_speed: f64) -> Self {
        self.max_speed = max_speed;
        self
    }

    /// The same profile with another largest acceleration of the hand [m/s²].
    #[must_use]
    pub const fn with_max_acceleration(mut self, max_acceleration: f64) -> Self {
        self.max_acceleration = max_acceleration;
        self
    }

    /// The same profile with rotational properties.
    #[must_use]
    pub fn with_turning(self, turning: TurningProfile) -> Self {
        Self { turning: Some(turning), ..self }
    }

    /// The same profile with a gripper.
    #[must_use]
    pub const fn with_gripper(mut self, gripper: GripperProfile) -> Self {
        self.gripper = Some(gripper);
        self
    }

    /// The same profile with buttons of these names.
    #[must_use]
    pub fn with_buttons<N>(self, buttons: impl IntoIterator<Item = N>) -> Self
    where
        N: Into<Cow<'static, str>>,
    {
        Self { buttons: buttons.into_iter().map(Into::into).collect(), ..self }
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
