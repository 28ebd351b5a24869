// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Stiffness and damping of a virtual wall, which decide whether a device stays passive.

use crate::error::SafetyError;
use palpate_device::NumberError;

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
    stiffness: f64,
    damping: f64,
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
