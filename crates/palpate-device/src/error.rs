// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Why a device of a driver is refused.

use crate::number::NumberError;

/// Why a device or the states of its points are refused.
///
/// ```
/// use palpate_device::{DeviceError, DeviceProfile, MailboxDevice};
///
/// let none = MailboxDevice::new(DeviceProfile::unlimited("of my own"), 0);
/// assert_eq!(none.err(), Some(DeviceError::NoContactPoint));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A number breaks the rule of its parameter.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// There must be at least one contact point, or one actuator or channel in its place.
    #[error("there must be at least one contact point, actuator or channel")]
    NoContactPoint,
    /// Not one item for each contact point.
    #[error("{points} contact points need as many {items}, got {given}")]
    OneForEach {
        /// What is given.
        items: &'static str,
        /// How many there are.
        given: usize,
        /// The number of contact points.
        points: usize,
    },
}
