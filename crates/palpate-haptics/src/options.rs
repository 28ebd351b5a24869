// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rate, probe and force limit of a servo.

use crate::proxy::Probe;
use palpate_device::{Device, DeviceProfile};

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
