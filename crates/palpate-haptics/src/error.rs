// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors and options.

use std::convert::Infallible;

use palpate_device::{Device, DeviceError, DeviceProfile, NumberError};
use palpate_safety::SafetyError;

use crate::proxy::Probe;

/// Why a material, tool or servo is refused. Every variant carries the offending numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HapticsError {
    /// A number breaks the rule of its parameter.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// A device cannot be protected as asked.
    #[error(transparent)]
    Safety(SafetyError),
    /// A device is refused: it has no contact point.
    #[error(transparent)]
    Device(DeviceError),
    /// The servo and the device disagree about the number of contact points.
    #[error("the servo has {servo} contact points, the device {device}")]
    ContactPoints {
        /// Contact points of the servo.
        servo: usize,
        /// Contact points of the device.
        device: usize,
    },
    /// The device measures more seldom than the servo ticks, or sets a faster pace.
    #[error(
        "the device measures {device} times a second, but the servo ticks {servo} times: make the \
         servo with a rate of {device} Hz"
    )]
    Rate {
        /// Ticks of the servo a second [Hz].
        servo: f64,
        /// Measurements of the device a second [Hz].
        device: f64,
    },
    /// The run and the device disagree about who sets the pace.
    #[error("{}", if *is_device {
        "the device sets the pace itself: run it with `Pace::Device`"
    } else {
        "the device sets no pace: run it with `Pace::RealTime`"
    })]
    Pace {
        /// `true` if the device sets the pace.
        is_device: bool,
    },
    /// The list of bodies is empty.
    #[error("there must be at least one body to touch")]
    NoBody,
    /// No body has this index.
    #[error("there is no body {body}; there are {bodies}, counted from 0")]
    NoSuchBody {
        /// The index that was asked for.
        body: usize,
        /// The number of bodies.
        bodies: usize,
    },
    /// A hand-off has fewer places than there are bodies.
    #[error("the hand-off has room for {most} bodies, got {bodies}")]
    TooManyBodies {
        /// The number of bodies.
        bodies: usize,
        /// The capacity.
        most: usize,
    },
    /// Bodies were accepted for another servo.
    #[error("the bodies were accepted for another servo, whose device may render more")]
    OtherServo,
    /// A number of a pose is not finite or exceeds 1e15.
    #[error("the numbers of a pose must be finite and at most 1e15 in size")]
    Pose,
    /// A shape cannot carry the texture of a surface.
    #[error(transparent)]
    Shape(#[from] palpate_field::ShapeError),
    /// A curve needs two different points.
    #[error("a curve needs at least 2 different points, got {count}")]
    NoCurve {
        /// The number of different points, one or none.
        count: usize,
    },
    /// The shape of a tool has no bounded surface.
    #[error("a tool needs a bounded surface, and none was found")]
    NothingToTouchWith,
}

impl From<DeviceError> for HapticsError {
    fn from(error: DeviceError) -> Self {
        match error {
            DeviceError::Number(number) => Self::Number(number),
            error => Self::Device(error),
        }
    }
}

impl From<SafetyError> for HapticsError {
    fn from(error: SafetyError) -> Self {
        match error {
            SafetyError::Number(number) => Self::Number(number),
            error => Self::Safety(error),
        }
    }
}

impl From<Infallible> for HapticsError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

/// Rate, probe and force limit of a servo.
///
/// ```
/// use palpate_haptics::ServoOptions;
///
/// let options = ServoOptions { rate: 4000.0, max_force: 7.5, ..ServoOptions::default() };
/// assert_eq!((options.rate, options.max_force), (4000.0, 7.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoOptions {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The ball that touches.
    pub probe: Probe,
    /// The largest force on a contact point [N]; infinite for no limit.
    pub max_force: f64,
    /// The time over which the force of a contact rises from zero after a body covered the
    /// device point or moved onto it [s]. The contact points of a protected servo rise by
    /// [`SafetySettings::rise_rate`](palpate_safety::SafetySettings::rise_rate) instead.
    pub rise_time: f64,
}

impl Default for ServoOptions {
    /// 1 kHz, a ball of 2 mm, 3.3 N (a desktop stylus), rise in 0.1 s.
    fn default() -> Self {
        Self { rate: 1000.0, probe: Probe::default(), max_force: 3.3, rise_time: 0.1 }
    }
}

impl ServoOptions {
    /// The defaults, with the force limit of `device` if it has one.
    ///
    /// ```
    /// use palpate_device::DeviceProfile;
    /// use palpate_haptics::ServoOptions;
    ///
    /// let device = DeviceProfile { max_force: 7.5, ..DeviceProfile::unlimited("example") };
    /// assert_eq!(ServoOptions::of_device(&device).max_force, 7.5);
    /// ```
    #[must_use]
    pub fn of_device(device: &DeviceProfile) -> Self {
        let default = Self::default();
        // For a device without force feedback, the protection gives no force.
        let has_limit = device.max_force > 0.0 && device.max_force < f64::INFINITY;
        Self {
            max_force: if has_limit { device.max_force } else { default.max_force },
            ..default
        }
    }

    /// The same options at the rate of a device that measures more seldom, or that sets the pace.
    ///
    /// ```
    /// use palpate_device::{Device, DeviceProfile, MailboxDevice};
    /// use palpate_haptics::ServoOptions;
    ///
    /// let (slow, _driver) = MailboxDevice::new(DeviceProfile::unlimited("slow"), 1)?;
    /// let options = ServoOptions::default().at_rate_of(&slow.with_rate(250.0));
    /// assert_eq!(options.rate, 250.0);
    /// # Ok::<(), palpate_device::DeviceError>(())
    /// ```
    #[must_use]
    pub fn at_rate_of(self, device: &(impl Device + ?Sized)) -> Self {
        let is_own = |rate: &f64| *rate < self.rate || device.paces();
        Self { rate: device.rate().filter(is_own).unwrap_or(self.rate), ..self }
    }
}
