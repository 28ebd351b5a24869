// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The limits of a gripper.

use crate::profile::DeviceProfile;

/// The limits of a gripper: jaws between two fingers, which a motor may push apart or together.
///
/// ```
/// use palpate_device::{DeviceProfile, GripperProfile};
///
/// let gripper = GripperProfile { max_force_rate: 2000.0, ..GripperProfile::new(0.025, 8.0) };
/// let device = DeviceProfile {
///     gripper: Some(gripper),
///     ..DeviceProfile::unlimited("with a gripper")
/// };
/// assert_eq!(device.gripper.map(|gripper| gripper.max_force), Some(8.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct GripperProfile {
    /// The widest opening of the jaws [m].
    pub max_opening: f64,
    /// The largest force on the fingers [N]; zero for a gripper without a motor.
    pub max_force: f64,
    /// The fastest change of force [N/s].
    pub max_force_rate: f64,
}

impl GripperProfile {
    /// A gripper that opens to `max_opening` [m] and pushes with at most `max_force` [N], which
    /// changes as fast as asked.
    #[must_use]
    pub const fn new(max_opening: f64, max_force: f64) -> Self {
        Self { max_opening, max_force, max_force_rate: f64::INFINITY }
    }

    /// The limits of the force on the fingers, for a safety chain of its own.
    #[must_use]
    pub fn force_profile(&self) -> DeviceProfile {
        DeviceProfile {
            max_force: self.max_force,
            max_force_rate: self.max_force_rate,
            ..DeviceProfile::unlimited("gripper")
        }
    }
}
