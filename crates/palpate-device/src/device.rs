// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The interface between a haptic device and the servo.

use std::time::Duration;

use palpate_field::Vector;

use crate::buttons::Buttons;
use crate::profile::DeviceProfile;
use crate::state::{GripperState, PointState, Reading, TurnState};

/// Why a device no longer answers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the device was lost: {reason}")]
pub struct DeviceLost {
    /// The message of the transport.
    pub reason: String,
}

impl DeviceLost {
    /// A device that was lost for this reason.
    #[must_use]
    pub fn new(reason: impl Into<String>) -> Self {
        Self { reason: reason.into() }
    }
}

/// A haptic device with one contact point or more.
///
/// A stylus has one point, a glove one for each finger. States and forces are in device
/// coordinates; the servo's `WorkspaceMap` converts them to the world
/// and back.
///
/// Four methods are required. A device with rotation, six degrees of freedom in space or three in
/// the plane, also implements [`read_turn`](Self::read_turn) and
/// [`write_torque`](Self::write_torque); a rigid tool then turns with the device's one contact
/// point. The other methods are for devices that must be opened, that watch their host, that have
/// buttons or a gripper, or that set the pace.
///
/// # Order of calls
///
/// A loop of `palpate_haptics::servo_loop` calls [`open`](Self::open), [`set_watchdog`](Self::set_watchdog) and
/// [`enable`](Self::enable); then in each tick [`read`](Self::read), [`read_turn`](Self::read_turn),
/// [`buttons`](Self::buttons) and [`read_gripper`](Self::read_gripper), then
/// [`write`](Self::write), [`write_torque`](Self::write_torque) and
/// [`write_gripper_force`](Self::write_gripper_force); and however the run ends, also by a panic, the
/// writes once more with zeros, and [`close`](Self::close). After a [`DeviceLost`], a loop that may
/// reconnect begins again with [`open`](Self::open).
pub trait Device {
    /// The number of contact points; it never changes.
    fn points(&self) -> usize;

    /// The limits and properties of the device.
    fn profile(&self) -> &DeviceProfile;

    /// Reads every contact point into `points`, which has one place for each, at `time` [s]
    /// since the servo started, and says whether the states are new. The servo uses the velocities
    /// read here only if the device has no encoder steps; otherwise it estimates them from positions
    /// and the times of the readings. What is written into `points` counts for a
    /// [fresh](Reading::Fresh) reading alone; one point that cannot be measured, as a lost finger,
    /// is NaN.
    ///
    /// Real-time: called in every tick, and must return well within one, or, if the device
    /// [paces](Self::paces) the servo, soon after its next measurement. A call that blocks for
    /// longer makes ticks late, and the watchdog of the safety chain then releases the hand.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if the device must be [opened](Self::open) again before it can be read. A
    /// transfer that fails once is a [stale](Reading::Stale) reading.
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost>;

    /// Writes one force on the hand for every contact point [N].
    ///
    /// Real-time: called in every tick, and once more with zero forces however the run ends: also
    /// after a [`DeviceLost`], and after a panic of the device.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost>;

    /// Orientation and angular velocity at the time of the last [`read`](Self::read); always
    /// `None` for a device without rotation.
    ///
    /// Real-time: called in every tick.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        Ok(None)
    }

    /// Writes the torque on the hand about the device point [N·m], a vector along its axis; in
    /// the plane only z is used.
    ///
    /// Real-time: called in every tick of a device with rotation, after [`write`](Self::write),
    /// and once more with zero torque however the run ends.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        let _ = torque;
        Ok(())
    }

    /// The buttons that were held down at the time of the last [`read`](Self::read).
    ///
    /// Real-time: called in every tick.
    fn buttons(&mut self) -> Buttons {
        Buttons::NONE
    }

    /// The gripper at the time of the last [`read`](Self::read); always `None` for a device without
    /// one.
    ///
    /// Real-time: called in every tick.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn read_gripper(&mut self) -> Result<Option<GripperState>, DeviceLost> {
        Ok(None)
    }

    /// Writes the force on the fingers in the gripper [N]; positive opens the jaws.
    ///
    /// Real-time: called in every tick of a device whose profile has a
    /// [gripper](DeviceProfile::gripper), and once more with zero however the run ends.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write_gripper_force(&mut self, force: f64) -> Result<(), DeviceLost> {
        let _ = force;
        Ok(())
    }

    /// Opens the transport, for the first time or after the device was lost. What fails leaves
    /// nothing open.
    ///
    /// Not real-time: it may block. Ticks that wait for it come late; the hand is without force
    /// meanwhile.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if the device cannot be opened now.
    fn open(&mut self) -> Result<(), DeviceLost> {
        Ok(())
    }

    /// Asks the device to take its forces away by itself when nothing was written to it for `time`:
    /// the last protection of a hand when the program dies. Returns the time that the device keeps,
    /// in its own steps and at most the one that is asked for; `None` for a device that does not
    /// watch.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    fn set_watchdog(&mut self, time: Duration) -> Result<Option<Duration>, DeviceLost> {
        let _ = time;
        Ok(None)
    }

    /// Switches the motors on, with no force; called after [`open`](Self::open).
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    fn enable(&mut self) -> Result<(), DeviceLost> {
        Ok(())
    }

    /// Switches the motors off and closes the transport; called last, after zero forces, also on a
    /// device that was lost.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if the device does not confirm it.
    fn close(&mut self) -> Result<(), DeviceLost> {
        Ok(())
    }

    /// How often the device measures [Hz], as far as it is known before the first reading. A servo
    /// that ticks more often is refused, because its stiffness would be that of a faster device.
    fn rate(&self) -> Option<f64> {
        None
    }

    /// Whether the device sets the pace: [`read`](Self::read) then waits for the next measurement
    /// and returns at once when it comes, or as [stale](Reading::Stale) within a few periods if none
    /// does. A loop runs such a device at the device's pace and no other.
    fn paces(&self) -> bool {
        false
    }
}
