// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a haptic device is to the servo.

use std::borrow::Cow;

use palpate_field::{Point, Rotation, Vector};

use crate::error::SafetyError;

/// One contact point of a device, as read in a tick. Coordinates of the device, which are those
/// of the world unless a [`WorkspaceMap`](crate::WorkspaceMap) places the device elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<const D: usize> {
    /// Where the hand holds the device [m].
    pub position: Point<D>,
    /// How fast it moves [m/s].
    pub velocity: Vector<f64, D>,
}

impl<const D: usize> PointState<D> {
    /// A point at rest at `position` [m].
    #[must_use]
    pub fn at_rest(position: Point<D>) -> Self {
        Self { position, velocity: Vector::ZERO }
    }

    /// `true` if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

/// How a device is turned, as read in a tick. Coordinates of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnState<const D: usize> {
    /// How the axes of what the hand holds lie in those of the device.
    pub orientation: Rotation<D>,
    /// How fast it turns [rad/s]: along the axis, as the device sees it; in the plane about z
    /// alone.
    pub angular_velocity: Vector<f64, 3>,
}

impl<const D: usize> TurnState<D> {
    /// Held still in an orientation.
    #[must_use]
    pub fn at_rest(orientation: Rotation<D>) -> Self {
        Self { orientation, angular_velocity: Vector::ZERO }
    }
}

/// What a device can do: data, from its maker or, where there is none, assumed.
///
/// Of a device that is not known, everything is [unlimited](Self::unlimited) until told
/// otherwise: its maker has to say what is safe.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DeviceProfile {
    /// The device's name.
    pub name: Cow<'static, str>,
    /// Largest force [N].
    pub max_force: f64,
    /// Largest force that it gives for as long as one likes [N].
    pub continuous_force: f64,
    /// Fastest change of force [N/s].
    pub max_force_rate: f64,
    /// Largest stiffness it renders at 1 kHz [N/m].
    pub max_stiffness: f64,
    /// Largest damping it renders at 1 kHz [N·s/m].
    pub max_damping: f64,
    /// Radius of the ball it reaches [m].
    pub workspace_radius: f64,
    /// What it weighs in the hand [kg].
    pub mass: f64,
    /// The least damping of its own that can be relied on, b of Colgate and Schenkel (1997)
    /// [N·s/m].
    pub least_damping: f64,
    /// Its Coulomb friction, f_c of Abbott and Okamura (2005) [N].
    pub friction: f64,
    /// The step of its encoders at the handle [m].
    pub encoder_step: f64,
    /// What it can do about its axes; none of a device that does not turn.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub turning: Option<TurningProfile>,
    /// Where the numbers are from.
    pub source: Cow<'static, str>,
    /// Which numbers are not from there, but assumed: names of fields.
    pub assumed: Cow<'static, [&'static str]>,
}

impl DeviceProfile {
    /// A device that does all it is told to, without mass, friction or steps.
    ///
    /// ```
    /// let ideal = palpate_safety::DeviceProfile::unlimited("ideal");
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
            turning: None,
            source: Cow::Borrowed(""),
            assumed: Cow::Borrowed(&[]),
        }
    }
}

impl DeviceProfile {
    /// Refuses a `device` that bears less than this one: what is rendered for this one might
    /// harm it, or be unstable on it.
    pub fn check_bears(&self, device: &Self) -> Result<(), SafetyError> {
        at_most("max_force", self.max_force, device.max_force, "N")?;
        at_most("continuous_force", self.continuous_force, device.continuous_force, "N")?;
        at_most("max_force_rate", self.max_force_rate, device.max_force_rate, "N/s")?;
        at_most("max_stiffness", self.max_stiffness, device.max_stiffness, "N/m")?;
        at_most("max_damping", self.max_damping, device.max_damping, "N·s/m")?;
        at_most("least_damping", self.least_damping, device.least_damping, "N·s/m")?;
        at_least("encoder_step", self.encoder_step, device.encoder_step, "m")?;
        match (&self.turning, &device.turning) {
            // Without a torque there is nothing to bear.
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

/// What a device can do about its axes: the numbers of a [`DeviceProfile`], angles for lengths
/// and torques for forces. They are those of the worst axis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TurningProfile {
    /// Largest torque [N·m]; zero of a device that senses how it is turned, and gives no torque.
    pub max_torque: f64,
    /// Largest torque that it gives for as long as one likes [N·m].
    pub continuous_torque: f64,
    /// Fastest change of torque [N·m/s].
    pub max_torque_rate: f64,
    /// Largest angular stiffness it renders at 1 kHz [N·m/rad].
    pub max_stiffness: f64,
    /// Largest angular damping it renders at 1 kHz [N·m·s/rad].
    pub max_damping: f64,
    /// Its moment of inertia in the hand [kg·m²].
    pub inertia: f64,
    /// The least angular damping of its own that can be relied on [N·m·s/rad].
    pub least_damping: f64,
    /// Its Coulomb friction [N·m].
    pub friction: f64,
    /// The step of its encoders [rad].
    pub encoder_step: f64,
    /// Where the numbers are from.
    pub source: Cow<'static, str>,
    /// Which numbers are not from there, but assumed: names of fields.
    pub assumed: Cow<'static, [&'static str]>,
}

impl TurningProfile {
    /// A device that gives any torque, without inertia, friction or steps.
    ///
    /// ```
    /// use palpate_safety::{DeviceProfile, TurningProfile};
    ///
    /// let turning = Some(TurningProfile { max_torque: 0.2, ..TurningProfile::unlimited() });
    /// let device = DeviceProfile { turning, ..DeviceProfile::unlimited("six degrees of freedom") };
    /// assert!(device.turning.is_some_and(|turning| turning.max_stiffness == f64::INFINITY));
    /// ```
    #[must_use]
    pub fn unlimited() -> Self {
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
            source: Cow::Borrowed(""),
            assumed: Cow::Borrowed(&[]),
        }
    }
}

impl TurningProfile {
    /// As [`DeviceProfile::check_bears`], about the axes.
    fn check_bears(&self, device: &Self) -> Result<(), SafetyError> {
        at_most("max_torque", self.max_torque, device.max_torque, "N·m")?;
        let (torque, of_device) = (self.continuous_torque, device.continuous_torque);
        at_most("continuous_torque", torque, of_device, "N·m")?;
        at_most("max_torque_rate", self.max_torque_rate, device.max_torque_rate, "N·m/s")?;
        at_most("angular max_stiffness", self.max_stiffness, device.max_stiffness, "N·m/rad")?;
        at_most("angular max_damping", self.max_damping, device.max_damping, "N·m·s/rad")?;
        let (damping, of_device) = (self.least_damping, device.least_damping);
        at_most("angular least_damping", damping, of_device, "N·m·s/rad")?;
        at_least("angular encoder_step", self.encoder_step, device.encoder_step, "rad")
    }
}

/// Why a device no longer answers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the device was lost: {reason}")]
pub struct DeviceLost {
    /// What its transport said.
    pub reason: String,
}

/// A haptic device with one contact point or more.
///
/// A stylus has one point, a glove one for each finger. Coordinates of the device both ways: a
/// [`WorkspaceMap`](crate::WorkspaceMap) of the servo takes them to the world.
///
/// A device that turns, with six degrees of freedom in space or three in the plane, also
/// [says how it is turned](Self::read_turn) and [takes a torque](Self::write_torque); a
/// tool with a shape turns with its one point. Other devices leave both as they
/// are.
pub trait Device<const D: usize> {
    /// How many contact points it has; the same for life.
    fn points(&self) -> usize;

    /// What it can do.
    fn profile(&self) -> &DeviceProfile;

    /// Reads every contact point into `points`, which has one place for each, at `time` [s]
    /// since the servo started.
    ///
    /// Real-time: called in every tick.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if there is nothing more to read, ever; the servo then stops. A reading
    /// that fails once should repeat the last one.
    fn read(&mut self, time: f64, points: &mut [PointState<D>]) -> Result<(), DeviceLost>;

    /// Writes one force on the hand for every contact point [N].
    ///
    /// Real-time: called in every tick, and once with zero forces when the servo stops.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write(&mut self, forces: &[Vector<f64, D>]) -> Result<(), DeviceLost>;

    /// How the hand turns the device, at the time of the last [`read`](Self::read); `None`, always,
    /// of a device that does not turn.
    ///
    /// Real-time: called in every tick.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn read_turn(&mut self) -> Result<Option<TurnState<D>>, DeviceLost> {
        Ok(None)
    }

    /// Writes the torque on the hand about the device point [N·m], along its axis; in the plane
    /// about z alone.
    ///
    /// Real-time: called in every tick of a device that turns, after [`write`](Self::write), and
    /// once with no torque when the servo stops.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        let _ = torque;
        Ok(())
    }
}
