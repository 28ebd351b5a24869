// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a device bears what a servo was made for: the comparison of one limit.

use crate::error::SafetyError;

/// Refuses a limit of the servo's device that is larger than the running device's.
pub(super) fn at_most(
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
pub(super) fn at_least(
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
