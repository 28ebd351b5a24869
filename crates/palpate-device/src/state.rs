// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is read of a device in a tick.

use palpate_field::{Point, Rotation, Vector};

/// What a [`Device::read`](crate::Device::read) brought.
///
/// ```
/// use palpate_device::Reading;
///
/// assert!(Reading::Fresh { time: 0.25 }.has_state() && Reading::Stale.has_state());
/// assert!(!Reading::NotReady.has_state());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// The device was measured since the last read.
    Fresh {
        /// When it was measured [s], on a clock that runs evenly: the device's, the transport's or
        /// this machine's. Only differences count. A time that is not later than the one before, or
        /// no number, makes the reading a stale one.
        time: f64,
    },
    /// Nothing was measured since the last read: the last state holds on. The force is held too; the
    /// time counts as late, so that the watchdog of the safety chain lets go if it lasts.
    Stale,
    /// The device has no state, because it is homing, calibrating or not connected yet. Forces are
    /// zero, and rise again once there is a state.
    NotReady,
}

impl Reading {
    /// `true` if the device has a state, new or old.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub const fn has_state(self) -> bool {
        matches!(self, Self::Fresh { .. } | Self::Stale)
    }
}

/// One contact point of a device, as read in a tick, in device coordinates. They equal world
/// coordinates unless the servo's protection has a workspace map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState {
    /// The device point: where the hand holds the device [m].
    pub position: Point<3>,
    /// The velocity of the device point [m/s].
    pub velocity: Vector<f64, 3>,
}

impl PointState {
    /// A point at rest at `position` [m].
    #[must_use]
    pub fn at_rest(position: impl Into<Point<3>>) -> Self {
        Self { position: position.into(), velocity: Vector::ZERO }
    }

    /// `true` if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

/// Orientation and angular velocity of a device, as read in a tick, in device coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnState {
    /// The orientation of the handle in device coordinates.
    pub orientation: Rotation<3>,
    /// The angular velocity in device coordinates [rad/s], a vector along the axis; in the
    /// plane only z is used.
    pub angular_velocity: Vector<f64, 3>,
}

impl TurnState {
    /// A device at rest in an orientation.
    #[must_use]
    pub fn at_rest(orientation: Rotation<3>) -> Self {
        Self { orientation, angular_velocity: Vector::ZERO }
    }
}

/// The gripper of a device, as read in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct GripperState {
    /// How far the jaws are apart, where the fingers hold them [m].
    pub opening: f64,
    /// How fast they open [m/s].
    pub velocity: f64,
}

impl GripperState {
    /// A gripper at rest with this opening [m].
    #[must_use]
    pub const fn at_rest(opening: f64) -> Self {
        Self { opening, velocity: 0.0 }
    }
}
