// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What an identification asks of a device before and after its motions.

use std::time::Duration;

use palpate_device::{
    Device, DeviceLost, DeviceProfile, PointState, Reading, TurnState, TurningProfile,
    profile_named,
};
use palpate_field::Vector;
use palpate_sim::{IdentifyError, IdentifyOptions, SimulatedDevice};

use super::{free, identify};

/// A device that counts what a loop owes it.
struct Counted {
    device: SimulatedDevice,
    profile: DeviceProfile,
    calls: Vec<&'static str>,
    opens: bool,
    takes_forces: bool,
    senses_turns: bool,
    writes: u64,
    torques: u64,
}

impl Device for Counted {
    fn points(&self) -> usize {
        1
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn open(&mut self) -> Result<(), DeviceLost> {
        self.calls.push("open");
        if self.opens { Ok(()) } else { Err(DeviceLost::new("it is not plugged in")) }
    }

    fn set_watchdog(&mut self, after: Duration) -> Result<Option<Duration>, DeviceLost> {
        assert_eq!(after, Duration::from_millis(30));
        self.calls.push("watch");
        self.device.set_watchdog(after)
    }

    fn enable(&mut self) -> Result<(), DeviceLost> {
        self.calls.push("enable");
        Ok(())
    }

    fn close(&mut self) -> Result<(), DeviceLost> {
        self.calls.push("close");
        Ok(())
    }

    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        self.device.read(time, points)
    }

    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        if self.senses_turns { self.device.read_turn() } else { Ok(None) }
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.writes += 1;
        if !self.takes_forces {
            return Err(DeviceLost::new("the motors are off"));
        }
        self.device.write(forces)
    }

    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.torques += 1;
        self.device.write_torque(torque)
    }
}

fn counted(takes_forces: bool) -> Counted {
    let profile = profile_named("sigma7").unwrap();
    let device = free(profile.clone());
    Counted {
        device,
        profile,
        calls: Vec::new(),
        opens: true,
        takes_forces,
        senses_turns: true,
        writes: 0,
        torques: 0,
    }
}

#[test]
fn devices_are_opened_watched_enabled_and_closed() {
    let mut device = counted(true);
    identify(&mut device, IdentifyOptions::new(1000.0)).unwrap();
    assert_eq!(device.calls, ["open", "watch", "enable", "close"]);
    // A device that takes no force is still told that its torque is zero.
    let mut device = counted(false);
    let lost = identify(&mut device, IdentifyOptions::new(1000.0)).unwrap_err();
    assert!(matches!(lost, IdentifyError::Lost { .. }), "{lost}");
    assert_eq!((device.calls.last(), device.torques), (Some(&"close"), 2));
}

/// Once minus infinity was written.
#[test]
fn a_torque_without_a_limit_is_refused_before_the_device_is_opened() {
    let mut device = counted(true);
    device.profile =
        DeviceProfile { turning: Some(TurningProfile::unlimited()), ..device.profile };
    let refused = identify(&mut device, IdentifyOptions::new(1000.0)).unwrap_err();
    assert_eq!(refused.to_string(), "max_torque must be positive and finite, got inf N·m");
    assert_eq!((device.calls.len(), device.torques), (0, 0));
}

/// Once zero forces were written to it.
#[test]
fn a_device_that_does_not_open_is_left_alone() {
    let mut device = Counted { opens: false, ..counted(true) };
    let lost = identify(&mut device, IdentifyOptions::new(1000.0)).unwrap_err();
    let said = "it is not plugged in; nothing was written to the device";
    assert!(lost.to_string().ends_with(said), "{lost}");
    assert_eq!((device.calls, device.writes, device.torques), (vec!["open"], 0, 0));
}

#[test]
fn a_device_of_torques_has_to_say_where_it_points() {
    let mut device = Counted { senses_turns: false, ..counted(true) };
    let blind = identify(&mut device, IdentifyOptions::new(1000.0)).unwrap_err();
    let said =
        "along x: the reading at 0.001 s has no orientation, and the device gives torques";
    assert_eq!(blind.to_string(), said);
}
