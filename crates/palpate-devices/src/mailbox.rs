// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device whose positions another thread sets, and whose forces it takes.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::DeviceError;
use palpate_field::Vector;
use palpate_haptics::{
    Device, DeviceLost, DeviceProfile, LatestReader, LatestWriter, PointState, TurnState,
    latest_value,
};

/// A device whose driver runs in another thread or another language, where a call from the
/// servo's thread would come too late.
///
/// The driver [sets](Mailbox::set) where the points are and [takes](Mailbox::forces) the newest
/// forces, as often as it likes; the servo never waits for it. A driver that is too slow makes
/// the hand feel older positions; it does not make ticks late.
///
/// Each side watches the other. A driver that sets nothing for longer than its
/// [`patience`](Self::with_patience) has died: the device is lost, and the servo stops. If
/// [`ticks`](Mailbox::ticks) stop growing, the servo hangs, and the driver must set its motors to
/// zero.
///
/// # Examples
///
/// ```
/// use palpate_devices::{Device, DeviceProfile, MailboxDevice, PointState};
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let profile = DeviceProfile::unlimited("of my own").with_max_force(4.0);
/// let start = PointState::at_rest(Vector([0.0, 0.12, 0.0]));
/// let (mut device, mut mailbox) = MailboxDevice::new(profile, &[start])?;
/// mailbox.set(&[PointState::at_rest(Vector([0.0, 0.1, 0.0]))])?; // from any thread
/// let mut points = [start];
/// device.read(0.0, &mut points)?; // in the servo's
/// assert_eq!(points[0].position, Vector([0.0, 0.1, 0.0]));
/// device.write(&[Vector([0.0, 2.0, 0.0])])?;
/// assert_eq!(mailbox.forces(), [Vector([0.0, 2.0, 0.0])]);
/// assert_eq!(mailbox.ticks(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct MailboxDevice<const D: usize> {
    profile: DeviceProfile,
    /// Where the points are until the driver sets them.
    start: Vec<PointState<D>>,
    readings: LatestReader<Reading<D>>,
    /// The last reading that was new, and when it came [s].
    seen: Option<(u64, f64)>,
    turn: Option<TurnState<D>>,
    patience: f64,
    ticks: u64,
    forces: LatestWriter<Forces<D>>,
    torque: LatestWriter<Vector<f64, 3>>,
}

/// The driver's end of a [`MailboxDevice`].
#[derive(Debug)]
pub struct Mailbox<const D: usize> {
    reading: Reading<D>,
    readings: LatestWriter<Reading<D>>,
    forces: LatestReader<Forces<D>>,
    torque: LatestReader<Vector<f64, 3>>,
}

/// What the driver says of its device.
#[derive(Clone, Debug)]
struct Reading<const D: usize> {
    /// How many readings were published before.
    number: u64,
    points: Vec<PointState<D>>,
    turn: Option<TurnState<D>>,
    is_lost: bool,
}

/// What the servo writes.
#[derive(Clone, Debug)]
struct Forces<const D: usize> {
    /// How often the servo has written forces.
    ticks: u64,
    points: Vec<Vector<f64, D>>,
}

impl<const D: usize> MailboxDevice<D> {
    /// How long the driver may set nothing unless [`with_patience`](Self::with_patience) says
    /// otherwise [s].
    pub const PATIENCE: f64 = 0.1;

    /// A device with one contact point for each state of `start`, and its driver's end. Until the
    /// driver sets them, the points are there, and the device is not lost.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there are none.
    pub fn new(
        profile: DeviceProfile,
        start: &[PointState<D>],
    ) -> Result<(Self, Mailbox<D>), DeviceError> {
        if start.is_empty() {
            return Err(DeviceError::NoContactPoint);
        }
        let start = start.to_vec();
        let no_forces = Forces { ticks: 0, points: vec![Vector::ZERO; start.len()] };
        let reading = Reading { number: 0, points: start.clone(), turn: None, is_lost: false };
        let (set_readings, readings) = latest_value(reading.clone());
        let (set_forces, forces) = latest_value(no_forces);
        let (set_torque, torque) = latest_value(Vector::ZERO);
        let mailbox = Mailbox { reading, readings: set_readings, forces, torque };
        let device = Self {
            profile,
            start,
            readings,
            seen: None,
            turn: None,
            patience: Self::PATIENCE,
            ticks: 0,
            forces: set_forces,
            torque: set_torque,
        };
        Ok((device, mailbox))
    }

    /// The device with another time for which the driver may set nothing [s], infinite for a
    /// driver that only sets what changes. The servo's ticks measure that time.
    #[must_use]
    pub fn with_patience(self, patience: f64) -> Self {
        Self { patience, ..self }
    }
}

impl<const D: usize> Mailbox<D> {
    /// Sets where every point is and how fast it moves, in the coordinates of the device.
    ///
    /// # Errors
    ///
    /// [`DeviceError::OneForEach`] if there is not one state for each point.
    pub fn set(&mut self, states: &[PointState<D>]) -> Result<(), DeviceError> {
        let points = self.reading.points.len();
        if states.len() != points {
            let (items, given) = ("states", states.len());
            return Err(DeviceError::OneForEach { items, given, points });
        }
        self.reading.points.clone_from_slice(states);
        self.publish();
        Ok(())
    }

    /// Sets the orientation and the angular velocity of a device with rotation.
    pub fn set_turn(&mut self, turn: TurnState<D>) {
        self.reading.turn = Some(turn);
        self.publish();
    }

    /// Says that the device is lost: the servo stops in its next tick.
    pub fn lose(&mut self) {
        self.reading.is_lost = true;
        self.publish();
    }

    /// The newest forces on the hand [N], one for each point; empty before the first tick.
    #[must_use]
    pub fn forces(&mut self) -> &[Vector<f64, D>] {
        self.forces.latest().map_or(&[], |forces| &forces.points)
    }

    /// How often the servo has written forces. At 1 kHz, a number that does not change for 10 ms
    /// means that the servo's thread hangs, and that the motors must be set to zero: the last
    /// forces stay in the mailbox.
    #[must_use]
    pub fn ticks(&mut self) -> u64 {
        self.forces.latest().map_or(0, |forces| forces.ticks)
    }

    /// The newest torque on the hand [N·m], zero for a device without rotation.
    #[must_use]
    pub fn torque(&mut self) -> Vector<f64, 3> {
        self.torque.latest().copied().unwrap_or(Vector::ZERO)
    }

    fn publish(&mut self) {
        self.reading.number += 1;
        let Reading { number, points, turn, is_lost } = &self.reading;
        self.readings.set(|reading| {
            reading.number = *number;
            reading.points.clone_from_slice(points);
            reading.turn = *turn;
            reading.is_lost = *is_lost;
        });
    }
}

fn lost<T>(reason: &str) -> Result<T, DeviceLost> {
    Err(DeviceLost { reason: reason.to_owned() })
}

/// Copies as many states as both have.
fn write_states<const D: usize>(points: &mut [PointState<D>], states: &[PointState<D>]) {
    for (point, state) in points.iter_mut().zip(states) {
        *point = *state;
    }
}

impl<const D: usize> Device<D> for MailboxDevice<D> {
    fn points(&self) -> usize {
        self.start.len()
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    /// Real-time: allocates nothing until the device is lost, takes no lock, cannot panic.
    fn read(&mut self, time: f64, points: &mut [PointState<D>]) -> Result<(), DeviceLost> {
        let Some(reading) = self.readings.latest() else {
            write_states(points, &self.start);
            return Ok(());
        };
        if reading.is_lost {
            return lost("its driver says so");
        }
        match self.seen {
            Some((number, since)) if number == reading.number => {
                // NaN counts as no patience.
                let is_patient = time - since <= self.patience;
                if !is_patient {
                    return lost("its driver sets nothing any more");
                }
            }
            _ => self.seen = Some((reading.number, time)),
        }
        write_states(points, &reading.points);
        self.turn = reading.turn;
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write(&mut self, forces: &[Vector<f64, D>]) -> Result<(), DeviceLost> {
        self.ticks += 1;
        let ticks = self.ticks;
        self.forces.set(|all| {
            all.ticks = ticks;
            for (written, force) in all.points.iter_mut().zip(forces) {
                *written = *force;
            }
        });
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_turn(&mut self) -> Result<Option<TurnState<D>>, DeviceLost> {
        Ok(self.turn)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.torque.set(|written| *written = torque);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_field::Rotation;

    #[test]
    fn the_newest_states_and_forces_count() {
        let start = [PointState::at_rest(Vector([3.0, 4.0])); 2];
        let (mut device, mut mailbox) =
            MailboxDevice::<2>::new(DeviceProfile::unlimited("two"), &start).unwrap();
        let mut points = [PointState::at_rest(Vector([9.0; 2])); 2];
        device.read(0.0, &mut points).unwrap();
        assert_eq!(points, start);
        assert!(mailbox.forces().is_empty() && mailbox.ticks() == 0);
        for x in [1.0, 2.0] {
            let state = PointState::at_rest(Vector([x, 0.0]));
            mailbox.set(&[state, state]).unwrap();
            device.write(&[Vector([0.0, x]), Vector::ZERO]).unwrap();
        }
        device.read(1.0, &mut points).unwrap();
        assert_eq!(points[1].position, Vector([2.0, 0.0]));
        assert_eq!(mailbox.forces(), [Vector([0.0, 2.0]), Vector::ZERO]);
        assert_eq!(mailbox.ticks(), 2);
        assert!(mailbox.set(&points[..1]).is_err());
        assert!(MailboxDevice::<2>::new(DeviceProfile::unlimited("none"), &[]).is_err());
    }

    #[test]
    fn a_driver_that_died_is_a_lost_device() {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let (mut device, mut mailbox) =
            MailboxDevice::<2>::new(DeviceProfile::unlimited("one"), &points).unwrap();
        device.read(7.0, &mut points).unwrap(); // a driver that has not begun is no dead one
        mailbox.set(&points).unwrap();
        for time in [7.0, 7.05, 7.1] {
            device.read(time, &mut points).unwrap();
        }
        mailbox.set(&points).unwrap(); // the same place counts as well
        device.read(7.15, &mut points).unwrap();
        let error = device.read(7.26, &mut points).unwrap_err();
        assert_eq!(error.to_string(), "the device was lost: its driver sets nothing any more");
        let mut device = device.with_patience(f64::INFINITY);
        device.read(1e9, &mut points).unwrap();
        mailbox.lose();
        assert!(device.read(1e9, &mut points).is_err());
    }

    #[test]
    fn turns_and_torques_pass_as_well() {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let (mut device, mut mailbox) =
            MailboxDevice::<3>::new(DeviceProfile::unlimited("six"), &points).unwrap();
        assert_eq!(device.read_turn().unwrap(), None);
        let about_y = Rotation::from_axis_angle(Vector::unit(1), 0.3).unwrap();
        mailbox.set_turn(TurnState::at_rest(about_y));
        device.read(0.0, &mut points).unwrap();
        assert_eq!(device.read_turn().unwrap(), Some(TurnState::at_rest(about_y)));
        device.write_torque(Vector([0.0, 0.1, 0.0])).unwrap();
        assert_eq!(mailbox.torque(), Vector([0.0, 0.1, 0.0]));
    }
}
