// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Why a device cannot be protected.

use palpate_device::NumberError;

use crate::refused::{Refused, listed};

/// Why a device cannot be protected as asked. Every variant carries the offending numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SafetyError {
    /// A number breaks the rule of its parameter.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// A device renders less than is asked of it, and is not to.
    #[error("{}", listed(.0))]
    MaterialRefused(Vec<Refused>),
    /// A device bears less than the one that the servo was made for.
    #[error(
        "the servo was made for a device with a {limit} of {servo} {unit}, but this device has \
         {device} {unit}: make the servo for this device"
    )]
    OtherDevice {
        /// Which limit differs: "max_force".
        limit: &'static str,
        /// The limit that the servo was made for, in `unit`.
        servo: f64,
        /// The limit of the device, in `unit`.
        device: f64,
        /// The unit of the limit: "N".
        unit: &'static str,
    },
}
