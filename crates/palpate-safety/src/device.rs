// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The interface between a haptic device and the servo.

use std::borrow::Cow;

use palpate_field::{Point, Rotation, Vector};

use crate::error::SafetyError;

/// One contact point of a device, as read in a tick, in device coordinates. They equal world
/// coordinates unless the servo's protection has a workspace map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<const D: usize> {
    /// The device point: where the hand holds the device [m].
    pub position: Point<D>,
    /// The velocity of the device point [m/s].
    pub velocity: Vector<f64, D>,
}

impl<const D: usize> PointState<D> {
    /// A point at rest at `position` [m].
    #[must_use]
    pub fn at_rest(position: impl Into<Point<D>>) -> Self {
        Self { position: position.into(), velocity: Vector::ZERO }
    }

    /// `true` if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

/// Orientation and angular velocity of a device, as read in a tick, in device coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnState<const D: usize> {
    /// The orientation of the handle in device coordinates.
    pub orientation: Rotation<D>,
    /// The angular velocity in device coordinates [rad/s], a vector along the axis; in the
    /// plane only z is used.
    pub angular_velocity: Vector<f64, 3>,
}

impl<const D: usize> TurnState<D> {
    /// A device at rest in an orientation.
    #[must_use]
    pub fn at_rest(orientation: Rotation<D>) -> Self {
        Self { orientation, angular_velocity: Vector::ZERO }
    }
}

/// The limits and properties of a device. Numbers are the maker's where they exist, and assumed
/// where they do not.
///
/// No safe default exists for an unknown device: start from [`unlimited`](Self::unlimited) and
/// set every number that its maker states or that you measured. A number that is left out
/// switches its rule off: without `max_force` any force passes, without `friction` and
/// `least_damping` any stiffness.
///
/// ```
/// use palpate_safety::DeviceProfile;
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
#[non_exhaustive]
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
    /// The source of the numbers.
    pub source: Cow<'static, str>,
    /// Names of the fields whose numbers are assumed and not from the source.
    pub assumed: Cow<'static, [&'static str]>,
}

impl DeviceProfile {
    /// An ideal device: no limits, no mass, no encoder steps, and damping and friction that pass
    /// every rule.
    ///
    /// ```
    /// let ideal = palpate_safety::DeviceProfile::unlimited("ideal");
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
    /// use palpate_safety::DeviceProfile;
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

impl DeviceProfile {
    /// Refuses a `device` with tighter limits than this one: a servo made for this profile
    /// could harm such a device or be unstable on it.
    ///
    /// # Errors
    ///
    /// [`SafetyError::OtherDevice`] with the limit that is tighter.
    pub fn check_bears(&self, device: &Self) -> Result<(), SafetyError> {
        at_most("max_force", self.max_force, device.max_force, "N")?;
        at_most("continuous_force", self.continuous_force, device.continuous_force, "N")?;
        at_most("max_force_rate", self.max_force_rate, device.max_force_rate, "N/s")?;
        at_most("max_stiffness", self.max_stiffness, device.max_stiffness, "N/m")?;
        at_most("max_damping", self.max_damping, device.max_damping, "N·s/m")?;
        at_most("least_damping", self.least_damping, device.least_damping, "N·s/m")?;
        at_most("friction", self.friction, device.friction, "N")?;
        at_least("encoder_step", self.encoder_step, device.encoder_step, "m")?;
        match (&self.turning, &device.turning) {
            // Without a torque there is no limit to check.
            (None, _) => Ok(()),
            (Some(turning), None) => at_most("max_torque", turning.max_torque, 0.0, "N·m"),
            (Some(turning), Some(device)) => turning.check_bears(device),
        }
    }
}

/// Refuses a limit of the servo's device that is larger than the running device's.
fn at_most(
    limit: &'static str,
    servo: f64,
    device: f64,
    unit: &'static str,
) -> Result<(), SafetyError> {
    // Written so that NaN is refused.
    if servo <= device {
        Ok(())
    } else {
        Err(SafetyError::OtherDevice { limit, servo, device, unit })
    }
}

/// Refuses a limit of the servo's device that is smaller than the running device's.
fn at_least(
    limit: &'static str,
    servo: f64,
    device: f64,
    unit: &'static str,
) -> Result<(), SafetyError> {
    if servo >= device {
        Ok(())
    } else {
        Err(SafetyError::OtherDevice { limit, servo, device, unit })
    }
}

/// The rotational counterpart of a [`DeviceProfile`], with angles for lengths and torques for
/// forces. Each number holds for the worst axis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
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
    /// The source of the numbers.
    pub source: Cow<'static, str>,
    /// Names of the fields whose numbers are assumed and not from the source.
    pub assumed: Cow<'static, [&'static str]>,
}

impl TurningProfile {
    /// A device that gives any torque, without inertia, friction or steps.
    ///
    /// ```
    /// use palpate_safety::{DeviceProfile, TurningProfile};
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

impl TurningProfile {
    /// As [`DeviceProfile::check_bears`], for the rotational limits.
    fn check_bears(&self, device: &Self) -> Result<(), SafetyError> {
        at_most("max_torque", self.max_torque, device.max_torque, "N·m")?;
        let (torque, of_device) = (self.continuous_torque, device.continuous_torque);
        at_most("continuous_torque", torque, of_device, "N·m")?;
        at_most("max_torque_rate", self.max_torque_rate, device.max_torque_rate, "N·m/s")?;
        at_most("angular_max_stiffness", self.max_stiffness, device.max_stiffness, "N·m/rad")?;
        at_most("angular_max_damping", self.max_damping, device.max_damping, "N·m·s/rad")?;
        let (damping, of_device) = (self.least_damping, device.least_damping);
        at_most("angular_least_damping", damping, of_device, "N·m·s/rad")?;
        at_most("angular_friction", self.friction, device.friction, "N·m")?;
        at_least("angular_encoder_step", self.encoder_step, device.encoder_step, "rad")
    }
}

/// Why a device no longer answers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the device was lost: {reason}")]
pub struct DeviceLost {
    /// The message of the transport.
    pub reason: String,
}

/// A haptic device with one contact point or more.
///
/// A stylus has one point, a glove one for each finger. States and forces are in device
/// coordinates; the servo's [`WorkspaceMap`](crate::WorkspaceMap) converts them to the world
/// and back.
///
/// A device with rotation, six degrees of freedom in space or three in the plane, also
/// implements [`read_turn`](Self::read_turn) and [`write_torque`](Self::write_torque); a rigid
/// tool then turns with the device's one contact point. Other devices keep the
/// provided implementations.
pub trait Device<const D: usize> {
    /// The number of contact points; it never changes.
    fn points(&self) -> usize;

    /// The limits and properties of the device.
    fn profile(&self) -> &DeviceProfile;

    /// Reads every contact point into `points`, which has one place for each, at `time` [s]
    /// since the servo started. The servo uses the velocities read here only if the device has no
    /// encoder steps; otherwise it estimates them from positions.
    ///
    /// Real-time: called in every tick, and must return well within one. A call that blocks makes
    /// ticks late, and the watchdog of the safety chain then releases the hand.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if the device can never be read again; the servo then stops. A reading
    /// that fails once should repeat the last state.
    fn read(&mut self, time: f64, points: &mut [PointState<D>]) -> Result<(), DeviceLost>;

    /// Writes one force on the hand for every contact point [N].
    ///
    /// Real-time: called in every tick, and once more with zero forces however the run ends: also
    /// after a [`DeviceLost`], and after a panic of the device.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write(&mut self, forces: &[Vector<f64, D>]) -> Result<(), DeviceLost>;

    /// Orientation and angular velocity at the time of the last [`read`](Self::read); always
    /// `None` for a device without rotation.
    ///
    /// Real-time: called in every tick.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn read_turn(&mut self) -> Result<Option<TurnState<D>>, DeviceLost> {
        Ok(None)
    }

    /// Writes the torque on the hand about the device point [N·m], a vector along its axis; in
    /// the plane only z is used.
    ///
    /// Real-time: called in every tick of a device with rotation, after [`write`](Self::write),
    /// and once more with zero torque however the run ends.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        let _ = torque;
        Ok(())
    }
}
