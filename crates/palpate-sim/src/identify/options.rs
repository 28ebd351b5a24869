// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a device is moved to identify it.

use super::IdentifyError;
use palpate_device::{DeviceProfile, NumberError, TurningProfile};

/// How far, how fast and how strongly a device is moved to [identify](super::identify) it.
///
/// The numbers are small: a handle that nobody holds moves by at most [`travel`](Self::travel)
/// from where it was.
///
/// ```
/// use palpate_sim::IdentifyOptions;
///
/// let options = IdentifyOptions { travel: 0.003, seed: 7, ..IdentifyOptions::new(4000.0) };
/// assert_eq!((options.rate, options.travel, options.force_part), (4000.0, 0.003, 0.3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifyOptions {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The farthest that the handle moves from its start [m].
    pub travel: f64,
    /// The farthest that the handle turns from its start [rad].
    pub angle: f64,
    /// The largest part of the device's largest force, and of its largest torque, that pushes.
    /// What the device can give without time limit is a limit too.
    pub force_part: f64,
    /// Shifts the lengths of the strokes, so that a repeated run meets the encoder steps
    /// elsewhere.
    pub seed: u64,
}

impl IdentifyOptions {
    /// Motions of 5 mm and 0.15 rad to each side, with at most 0.3 of the largest force, at
    /// `rate` [Hz].
    #[must_use]
    pub const fn new(rate: f64) -> Self {
        Self { rate, travel: 0.005, angle: 0.15, force_part: 0.3, seed: 0 }
    }

    /// # Errors
    ///
    /// The number that breaks its rule, or a travel that leaves the workspace.
    pub(super) fn check(&self, profile: &DeviceProfile) -> Result<(), IdentifyError> {
        NumberError::check_rate(self.rate)?;
        // A speed is measured over 4 ms, of which a loop must see a few ticks.
        if self.rate < LEAST_RATE {
            let rule = "at least 500, so that strokes of some milliseconds are seen";
            return Err(NumberError::new("rate", rule, self.rate, "Hz").into());
        }
        NumberError::check_positive("travel", self.travel, "m")?;
        // Written so that a radius of NaN is refused.
        let is_within = self.travel <= profile.workspace_radius;
        if !is_within {
            let (travel, radius) = (self.travel, profile.workspace_radius);
            return Err(IdentifyError::TravelBeyondWorkspace { travel, radius });
        }
        NumberError::check_positive_or_infinite("max_speed", profile.max_speed, "m/s")?;
        if let Some(turning) = &profile.turning {
            let speed = turning.max_speed;
            NumberError::check_positive_or_infinite("angular_max_speed", speed, "rad/s")?;
        }
        NumberError::check_positive("angle", self.angle, "rad")?;
        if self.angle > MOST_ANGLE {
            let rule = "at most 1, where rotation vectors add";
            return Err(NumberError::new("angle", rule, self.angle, "rad").into());
        }
        let is_part = self.force_part > 0.0 && self.force_part <= 1.0;
        if !is_part {
            let rule = "more than 0 and at most 1";
            return Err(NumberError::new("force_part", rule, self.force_part, "").into());
        }
        Ok(())
    }

    /// The largest force on the handle of a device [N].
    #[must_use]
    pub fn largest_force(&self, profile: &DeviceProfile) -> f64 {
        (self.force_part * profile.max_force).min(profile.continuous_force)
    }

    /// The largest torque on the handle [N·m].
    #[must_use]
    pub fn largest_torque(&self, turning: &TurningProfile) -> f64 {
        (self.force_part * turning.max_torque).min(turning.continuous_torque)
    }

    /// The bounds of motions along an axis.
    pub(super) fn along(&self, profile: &DeviceProfile) -> Bounds {
        Bounds {
            travel: self.travel,
            speed: (SPEED_PER_TRAVEL * self.travel).min(profile.max_speed / SPEED_RESERVE),
            force: self.largest_force(profile),
            force_rate: profile.max_force_rate,
        }
    }

    /// The bounds of motions about an axis; `None` for a device without torques.
    pub(super) fn about(&self, profile: &DeviceProfile) -> Option<Bounds> {
        let turning = profile.turning.as_ref().filter(|turning| turning.max_torque > 0.0)?;
        Some(Bounds {
            travel: self.angle,
            speed: (SPEED_PER_TRAVEL * self.angle).min(turning.max_speed / SPEED_RESERVE),
            force: self.largest_torque(turning),
            force_rate: turning.max_torque_rate,
        })
    }
}

/// A handle that is faster than a stroke accelerates by this factor is stopped.
pub(super) const SPEED_RESERVE: f64 = 2.0;

/// The slowest loop [Hz].
const LEAST_RATE: f64 = 500.0;

/// The largest angle [rad].
const MOST_ANGLE: f64 = 1.0;

/// The speed to which strokes accelerate over the travel [1/s]: 0.5 m/s for 5 mm. Faster ones
/// would cross the travel within a few ticks of 1 kHz, slower ones show little of the damping.
const SPEED_PER_TRAVEL: f64 = 100.0;

/// The bounds of the motions of one axis, in [m], [m/s], [N], [N/s], or about it in [rad],
/// [rad/s], [N·m], [N·m/s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) travel: f64,
    pub(super) speed: f64,
    pub(super) force: f64,
    pub(super) force_rate: f64,
}
