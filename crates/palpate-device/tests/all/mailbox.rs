// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A driver and a servo that talk through a mailbox. Not beside the code: there a model checker takes the
//! place of the machine.

use std::time::Duration;

use palpate_device::{
    Buttons, Device, DeviceProfile, GripperState, Mailbox, MailboxDevice, PointState, Reading,
    TurnState,
};
use palpate_field::{Rotation, Vector};

fn fresh(time: f64) -> Reading {
    Reading::Fresh { time }
}

#[test]
fn the_newest_states_and_forces_count() {
    let (mut device, mut mailbox) =
        MailboxDevice::new(DeviceProfile::unlimited("two"), 2).unwrap();
    let mut points = [PointState::at_rest(Vector([9.0; 3])); 2];
    assert_eq!(device.read(0.0, &mut points).unwrap(), Reading::NotReady);
    assert!(mailbox.forces().is_empty() && mailbox.ticks() == 0);
    for x in [1.0, 2.0] {
        let state = PointState::at_rest(Vector([x, 0.0, 0.0]));
        mailbox.set(&[state, state]).unwrap();
        device.write(&[Vector([0.0, x, 0.0]), Vector::ZERO]).unwrap();
    }
    assert_eq!(device.read(1.0, &mut points).unwrap(), fresh(1.0));
    assert_eq!(points[1].position, Vector([2.0, 0.0, 0.0]));
    assert_eq!(device.read(1.001, &mut points).unwrap(), Reading::Stale);
    assert_eq!(mailbox.forces(), [Vector([0.0, 2.0, 0.0]), Vector::ZERO]);
    assert_eq!(mailbox.ticks(), 2);
    mailbox.set_at(77.0, &points).unwrap();
    assert_eq!(device.read(1.002, &mut points).unwrap(), fresh(77.0));
    assert!(mailbox.set(&points[..1]).is_err());
    assert!(MailboxDevice::new(DeviceProfile::unlimited("none"), 0).is_err());
}

#[test]
fn a_driver_that_died_is_a_lost_device_until_it_sets_again() {
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let (mut device, mut mailbox) =
        MailboxDevice::new(DeviceProfile::unlimited("one"), 1).unwrap();
    device.read(7.0, &mut points).unwrap(); // a driver that has not begun is no dead one
    mailbox.set(&points).unwrap();
    for time in [7.0, 7.05, 7.1] {
        device.read(time, &mut points).unwrap();
    }
    mailbox.set(&points).unwrap(); // the same place counts as well
    device.read(7.15, &mut points).unwrap();
    let error = device.read(7.26, &mut points).unwrap_err();
    assert_eq!(error.to_string(), "the device was lost: its driver sets nothing any more");
    device.open().unwrap();
    assert_eq!(device.read(9.0, &mut points).unwrap(), Reading::NotReady);
    mailbox.set(&points).unwrap();
    let mut device = device.with_patience(f64::INFINITY);
    assert_eq!(device.read(9.5, &mut points).unwrap(), fresh(9.5));
    assert_eq!(device.read(1e9, &mut points).unwrap(), Reading::Stale);
    mailbox.lose();
    assert!(device.read(1e9, &mut points).is_err() && device.open().is_err());
    mailbox.set(&points).unwrap();
    device.open().unwrap();
    assert_eq!(device.read(1e9, &mut points).unwrap(), fresh(1e9));
    mailbox.set_not_ready();
    assert_eq!(device.read(1e9, &mut points).unwrap(), Reading::NotReady);
}

#[test]
fn turns_buttons_and_grippers_pass_with_the_states() {
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let (mut device, mut mailbox) =
        MailboxDevice::new(DeviceProfile::unlimited("seven"), 1).unwrap();
    let about_y = Rotation::from_axis_angle(Vector::unit(1), 0.3).unwrap();
    mailbox.set_turn(TurnState::at_rest(about_y));
    mailbox.set_buttons(Buttons::NONE.with(2));
    mailbox.set_gripper(GripperState::at_rest(0.01));
    device.read(0.0, &mut points).unwrap();
    assert_eq!((device.read_turn().unwrap(), device.buttons()), (None, Buttons::NONE));
    mailbox.set(&points).unwrap();
    device.read(0.0, &mut points).unwrap();
    assert_eq!(device.read_turn().unwrap(), Some(TurnState::at_rest(about_y)));
    assert_eq!(device.buttons(), Buttons::NONE.with(2));
    assert_eq!(device.read_gripper().unwrap(), Some(GripperState::at_rest(0.01)));
    device.write_torque(Vector([0.0, 0.1, 0.0])).unwrap();
    device.write_gripper_force(-1.5).unwrap();
    assert_eq!((mailbox.torque(), mailbox.gripper_force()), (Vector([0.0, 0.1, 0.0]), -1.5));
}

#[test]
fn a_driver_hears_of_watchdog_and_motors() {
    let unlimited = || DeviceProfile::unlimited("one");
    let (device, mut mailbox) = MailboxDevice::new(unlimited(), 1).unwrap();
    let [asked, longest] = [32, 20].map(Duration::from_millis);
    let mut device = device.with_watchdog(longest).with_rate(500.0);
    assert_eq!((mailbox.is_enabled(), mailbox.watchdog()), (false, None));
    assert_eq!(device.set_watchdog(asked).unwrap(), Some(longest));
    device.enable().unwrap();
    assert_eq!((mailbox.is_enabled(), mailbox.watchdog()), (true, Some(longest)));
    device.close().unwrap();
    assert!(!mailbox.is_enabled());
    assert_eq!(Device::rate(&device), Some(500.0));
    let (mut device, _mailbox) = MailboxDevice::new(unlimited(), 1).unwrap();
    assert_eq!(device.set_watchdog(asked).unwrap(), None);
}

/// Why a device is lost that is read so many times a second for 3 s, by a driver that sets states so
/// often.
fn lost(rate: u32, driver: u32, device: &mut MailboxDevice, mailbox: &mut Mailbox) -> String {
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let mut set = 0;
    for tick in 0..3 * rate {
        while set * rate <= tick * driver {
            mailbox.set(&points).unwrap();
            set += 1;
        }
        if let Err(lost) = device.read(f64::from(tick) / f64::from(rate), &mut points) {
            return lost.reason;
        }
    }
    String::new()
}

#[test]
fn a_driver_too_slow_for_the_servo_is_told_with_both_rates() {
    let mailbox = || MailboxDevice::new(DeviceProfile::unlimited("slow"), 1).unwrap();
    for driver in [12, 30, 60, 90, 250, 400] {
        let (mut device, mut driven) = mailbox();
        let said = format!(
            "its driver sets {driver} states a second, but the servo takes 1000, and would give no \
             force: tell the mailbox its rate, `with_rate({driver}."
        );
        let reason = lost(1000, driver, &mut device, &mut driven);
        assert!(reason.starts_with(&said), "{driver}: {reason}");
        let (device, mut driven) = mailbox();
        let mut told = device.with_rate(f64::from(driver));
        assert_eq!(lost(driver, driver, &mut told, &mut driven), "");
    }
    for driver in [500, 700, 1000, 2000] {
        let (mut device, mut driven) = mailbox();
        assert_eq!(lost(1000, driver, &mut device, &mut driven), "");
    }
    // One that only sets what changes has no rate.
    let (device, mut driven) = mailbox();
    let mut changes = device.with_patience(f64::INFINITY);
    assert_eq!(lost(1000, 90, &mut changes, &mut driven), "");
}

#[test]
fn one_pause_makes_no_driver_slow() {
    let (mut device, mut mailbox) =
        MailboxDevice::new(DeviceProfile::unlimited("busy"), 1).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    for tick in 0..3000 {
        // 80 ms of each 250 ms without states.
        if tick % 250 >= 80 {
            mailbox.set(&points).unwrap();
        }
        device.read(f64::from(tick) * 1e-3, &mut points).unwrap();
    }
}
