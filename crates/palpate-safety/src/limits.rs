// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The limits of a device in one form for translation and rotation, so that each rule and each
//! stage is written once: torque corresponds to force, and angle to length.

use std::sync::Arc;

use crate::Rule;
use crate::error::SafetyError;
use palpate_device::{DeviceProfile, NumberError, TurningProfile};

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
