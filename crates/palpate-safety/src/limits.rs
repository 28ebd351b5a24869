// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Limits and settings.

use std::sync::Arc;

use palpate_device::{DeviceProfile, NumberError, TurningProfile};

use crate::Rule;
use crate::acceptance::Acceptance;
use crate::approach::Recovery;
use crate::error::SafetyError;

/// A limit with its name and its unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    value: f64,
    name: &'static str,
    unit: &'static str,
}

impl Limit {
    fn new(value: f64, name: &'static str, unit: &'static str) -> Self {
        Self { value, name, unit }
    }

    /// The limit, which must be positive.
    pub(crate) fn positive(&self) -> Result<f64, SafetyError> {
        Ok(NumberError::check_positive_or_infinite(self.name, self.value, self.unit)?)
    }

    /// The limit, which must be positive; `rule` is the text of the error, which says also why.
    pub(crate) fn positive_for(&self, rule: &'static str) -> Result<f64, SafetyError> {
        if self.value > 0.0 {
            return Ok(self.value);
        }
        Err(NumberError::new(self.name, rule, self.value, self.unit).into())
    }

    /// The limit, which must be zero or more and finite.
    pub(crate) fn not_negative(&self) -> Result<f64, SafetyError> {
        Ok(NumberError::check_not_negative(self.name, self.value, self.unit)?)
    }

    /// The limit, which may be zero or infinite.
    pub(crate) fn zero_or_more(&self) -> Result<f64, SafetyError> {
        Ok(NumberError::check_zero_or_more(self.name, self.value, self.unit)?)
    }
}

/// The translational or rotational numbers of a profile, under the names of the translational
/// ones.
#[derive(Clone, Debug)]
pub struct DeviceLimits {
    pub(crate) max_force: Limit,
    pub(crate) continuous_force: Limit,
    pub(crate) max_force_rate: Limit,
    pub(crate) max_stiffness: Limit,
    pub(crate) max_damping: Limit,
    pub(crate) mass: Limit,
    pub(crate) least_damping: Limit,
    pub(crate) friction: Limit,
    pub(crate) encoder_step: Limit,
    /// The rules of stiffness, then those of damping.
    pub(crate) rules: [Rule; 5],
    pub(crate) assumed: Arc<[&'static str]>,
}

impl DeviceLimits {
    /// The translational limits of a device.
    #[must_use]
    pub fn along(device: &DeviceProfile) -> Self {
        Self {
            max_force: Limit::new(device.max_force, "max_force", "N"),
            continuous_force: Limit::new(device.continuous_force, "continuous_force", "N"),
            max_force_rate: Limit::new(device.max_force_rate, "max_force_rate", "N/s"),
            max_stiffness: Limit::new(device.max_stiffness, "max_stiffness", "N/m"),
            max_damping: Limit::new(device.max_damping, "max_damping", "N·s/m"),
            mass: Limit::new(device.mass, "mass", "kg"),
            least_damping: Limit::new(device.least_damping, "least_damping", "N·s/m"),
            friction: Limit::new(device.friction, "friction", "N"),
            encoder_step: Limit::new(device.encoder_step, "encoder_step", "m"),
            rules: [
                Rule::Passivity,
                Rule::Quantisation,
                Rule::MaxStiffness,
                Rule::DampingLeft,
                Rule::MaxDamping,
            ],
            assumed: device.assumed.as_ref().into(),
        }
    }

    /// The rotational limits of a device.
    #[must_use]
    pub fn about(device: &TurningProfile) -> Self {
        let limit = |value, name, unit| Limit::new(value, name, unit);
        Self {
            max_force: limit(device.max_torque, "max_torque", "N·m"),
            continuous_force: limit(device.continuous_torque, "continuous_torque", "N·m"),
            max_force_rate: limit(device.max_torque_rate, "max_torque_rate", "N·m/s"),
            max_stiffness: limit(device.max_stiffness, "angular_max_stiffness", "N·m/rad"),
            max_damping: limit(device.max_damping, "angular_max_damping", "N·m·s/rad"),
            mass: limit(device.inertia, "inertia", "kg·m²"),
            least_damping: limit(device.least_damping, "angular_least_damping", "N·m·s/rad"),
            friction: limit(device.friction, "angular_friction", "N·m"),
            encoder_step: limit(device.encoder_step, "angular_encoder_step", "rad"),
            rules: [
                Rule::AngularPassivity,
                Rule::AngularQuantisation,
                Rule::MaxAngularStiffness,
                Rule::AngularDampingLeft,
                Rule::MaxAngularDamping,
            ],
            assumed: device.assumed.as_ref().into(),
        }
    }
}

/// Energy that a hand does not feel [J].
const RESERVE: f64 = 1e-4;

/// The time constant with which motors are taken to cool [s]: makers do not state it.
const COOLING_TIME: f64 = 2.0;

/// How fast a force rises under a hand at rest without lifting it as a blow would [N/s].
const RISE_RATE: f64 = 20.0;

/// Five ticks of 1 ms that are late together: fewer are the jitter of an ordinary machine [s].
const LATE_TIME: f64 = 0.005;

/// A force that falls in this time is felt as soft [s].
const FALL_TIME: f64 = 0.02;

/// A hand that leans against it feels a strong drive, and can still stop its arm [W].
const DRIVE_POWER: f64 = 1.0;

/// How a safety chain protects, beside the limits of its device.
///
/// ```
/// use palpate_safety::SafetySettings;
///
/// let settings = SafetySettings { rise_rate: 10.0, ..SafetySettings::default() };
/// assert_eq!((settings.rise_rate, settings.fall_time), (10.0, 0.02));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetySettings {
    /// What the device renders of materials, tools and guides.
    pub acceptance: Acceptance,
    /// Whether materials, tools and guides are refused of which the device renders less than all.
    pub is_strict: bool,
    /// Whether the passivity controllers, of walls and of [free
    /// forces](crate::PortState::free_force), and the stage of limit cycles act; the observers always
    /// run. A wanted force that must do work on the hand is incompatible with the controller. On a
    /// device of infinite damping, neither the controllers nor that stage act.
    pub has_passivity_control: bool,
    /// Energy that each controller lets out before the hand has put any in [J].
    pub reserve: f64,
    /// The largest power of bodies that are moved from outside, on the hand [W].
    pub drive_power: f64,
    /// The time constant with which the motors cool [s].
    pub cooling_time: f64,
    /// How a force comes back after a beginning in a body: the start, an emergency stop, a hand
    /// that is set down, a device that was not ready. After all else it comes back at once.
    pub recovery: Recovery,
    /// How fast a force rises after it was zeroed [N/s], infinite for at once: after the start, a
    /// placement, late ticks, lost readings, an input that is not finite, or an emergency stop. A
    /// torque rises as fast in the units of its coupling, `√(κ/K)` metres a radian.
    pub rise_rate: f64,
    /// The time by which ticks are late together when the force falls to zero [s], but for 2.5
    /// periods at least. Each tick in time takes a period from that sum, and two once the force
    /// falls; when the sum is zero, the force rises again.
    pub late_time: f64,
    /// The time over which late ticks lower the force to zero [s].
    pub fall_time: f64,
}

impl SafetySettings {
    /// The largest power of drives [W].
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if it is not positive; it may be infinite.
    pub(crate) fn max_drive_power(&self) -> Result<f64, SafetyError> {
        Ok(NumberError::check_positive_or_infinite("drive_power", self.drive_power, "W")?)
    }
}

impl Default for SafetySettings {
    /// Every stage acts. The device renders what it can ([`Acceptance::Device`]); the reserve is
    /// 0.1 mJ, which a hand does not feel; drives give 1 W; motors cool within 2 s; forces rise by 20 N/s, and fall
    /// within 0.02 s when ticks are late by 5 ms.
    fn default() -> Self {
        Self {
            acceptance: Acceptance::Device,
            is_strict: false,
            has_passivity_control: true,
            reserve: RESERVE,
            drive_power: DRIVE_POWER,
            cooling_time: COOLING_TIME,
            recovery: Recovery::Rise,
            rise_rate: RISE_RATE,
            late_time: LATE_TIME,
            fall_time: FALL_TIME,
        }
    }
}

/// A stiffness and a damping.
///
/// ```
/// let error = palpate_safety::Impedance::new(-3.0, 0.0).unwrap_err();
/// assert_eq!(error.to_string(), "stiffness must be positive and finite, got -3 N/m");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Impedance {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
}

impl Impedance {
    /// A `stiffness` [N/m] and a `damping` [N·s/m].
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the stiffness is not positive, the damping negative, or
    /// either not finite.
    pub fn new(stiffness: f64, damping: f64) -> Result<Self, SafetyError> {
        Ok(Self {
            stiffness: NumberError::check_positive("stiffness", stiffness, "N/m")?,
            damping: NumberError::check_not_negative("damping", damping, "N·s/m")?,
        })
    }

    /// Force per length of stretch [N/m].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Force per speed [N·s/m].
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }
}

impl Default for Impedance {
    /// 500 N/m and 1 N·s/m: firm, and passive at 1 kHz on a device with 1.25 N·s/m of physical
    /// damping.
    fn default() -> Self {
        Self { stiffness: 500.0, damping: 1.0 }
    }
}
