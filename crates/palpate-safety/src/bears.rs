// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a device bears what a servo was made for.

use palpate_device::{DeviceProfile, GripperProfile, TurningProfile};

use crate::error::SafetyError;

/// Refuses a `device` with tighter limits than `made_for`, the profile that a servo was made for: the
/// servo could harm such a device or be unstable on it.
///
/// # Errors
///
/// [`SafetyError::OtherDevice`] with the limit that is tighter.
///
/// ```
/// use palpate_device::DeviceProfile;
/// use palpate_safety::check_bears;
///
/// let strong = DeviceProfile { max_force: 8.0, ..DeviceProfile::unlimited("strong") };
/// let weak = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("weak") };
/// assert!(check_bears(&weak, &strong).is_ok());
/// assert!(check_bears(&strong, &weak).unwrap_err().to_string().contains("max_force of 8 N"));
/// ```
pub fn check_bears(
    made_for: &DeviceProfile,
    device: &DeviceProfile,
) -> Result<(), SafetyError> {
    let of = made_for;
    at_most("max_force", of.max_force, device.max_force, "N")?;
    at_most("continuous_force", of.continuous_force, device.continuous_force, "N")?;
    at_most("max_force_rate", of.max_force_rate, device.max_force_rate, "N/s")?;
    at_most("max_stiffness", of.max_stiffness, device.max_stiffness, "N/m")?;
    at_most("max_damping", of.max_damping, device.max_damping, "N·s/m")?;
    at_most("least_damping", of.least_damping, device.least_damping, "N·s/m")?;
    at_most("friction", of.friction, device.friction, "N")?;
    at_least("encoder_step", of.encoder_step, device.encoder_step, "m")?;
    match (&of.turning, &device.turning) {
        // Without a torque there is no limit to check.
        (None, _) => {}
        (Some(turning), None) => at_most("max_torque", turning.max_torque, 0.0, "N·m")?,
        (Some(turning), Some(device)) => turning_bears(turning, device)?,
    }
    match (&of.gripper, &device.gripper) {
        (None, _) => Ok(()),
        (Some(gripper), None) => at_most("gripper_max_force", gripper.max_force, 0.0, "N"),
        (Some(gripper), Some(device)) => gripper_bears(gripper, device),
    }
}

fn turning_bears(of: &TurningProfile, device: &TurningProfile) -> Result<(), SafetyError> {
    at_most("max_torque", of.max_torque, device.max_torque, "N·m")?;
    at_most("continuous_torque", of.continuous_torque, device.continuous_torque, "N·m")?;
    at_most("max_torque_rate", of.max_torque_rate, device.max_torque_rate, "N·m/s")?;
    at_most("angular_max_stiffness", of.max_stiffness, device.max_stiffness, "N·m/rad")?;
    at_most("angular_max_damping", of.max_damping, device.max_damping, "N·m·s/rad")?;
    at_most("angular_least_damping", of.least_damping, device.least_damping, "N·m·s/rad")?;
    at_most("angular_friction", of.friction, device.friction, "N·m")?;
    at_least("angular_encoder_step", of.encoder_step, device.encoder_step, "rad")
}

fn gripper_bears(of: &GripperProfile, device: &GripperProfile) -> Result<(), SafetyError> {
    at_most("gripper_max_force", of.max_force, device.max_force, "N")?;
    at_most("gripper_max_force_rate", of.max_force_rate, device.max_force_rate, "N/s")
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
