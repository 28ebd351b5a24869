// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device whose positions another thread sets, and whose forces it takes.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;
use palpate_haptics::{
    Device, DeviceLost, DeviceProfile, HapticsError, LatestReader, LatestWriter, PointState,
    latest_value,
};

/// A device whose driver runs in another thread or another language, where a call from the
/// servo's thread would come too late.
///
/// The driver [sets](Mailbox::set) where the points are and [takes](Mailbox::forces) the newest
/// forces, as often as it likes; the servo never waits for it. A driver that is too slow makes
/// the hand feel older positions; it does not make ticks late.
///
/// # Examples
///
/// ```
/// use palpate_devices::{Device, DeviceProfile, MailboxDevice, PointState};
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let profile = DeviceProfile::unlimited("of my own").with_max_force(4.0);
/// let (mut device, mut mailbox) = MailboxDevice::<3>::new(profile, 1)?;
/// mailbox.set(&[PointState::at_rest(Vector([0.0, 0.1, 0.0]))])?; // from any thread
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// device.read(0.0, &mut points)?; // in the servo's
/// assert_eq!(points[0].position, Vector([0.0, 0.1, 0.0]));
/// device.write(&[Vector([0.0, 2.0, 0.0])])?;
/// assert_eq!(mailbox.forces(), [Vector([0.0, 2.0, 0.0])]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct MailboxDevice<const D: usize> {
    profile: DeviceProfile,
    points: usize,
    states: LatestReader<Vec<PointState<D>>>,
    forces: LatestWriter<Vec<Vector<f64, D>>>,
}

/// The driver's end of a [`MailboxDevice`].
#[derive(Debug)]
pub struct Mailbox<const D: usize> {
    states: LatestWriter<Vec<PointState<D>>>,
    forces: LatestReader<Vec<Vector<f64, D>>>,
    points: usize,
}

impl<const D: usize> MailboxDevice<D> {
    /// A device of so many `points`, and its driver's end. Until the driver sets them, the points
    /// are at rest at the origin.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoContactPoint`] if there are none.
    pub fn new(
        profile: DeviceProfile,
        points: usize,
    ) -> Result<(Self, Mailbox<D>), HapticsError> {
        if points == 0 {
            return Err(HapticsError::NoContactPoint);
        }
        let (set_states, states) =
            latest_value(vec![PointState::at_rest(Vector::ZERO); points]);
        let (forces, taken) = latest_value(vec![Vector::ZERO; points]);
        let mailbox = Mailbox { states: set_states, forces: taken, points };
        Ok((Self { profile, points, states, forces }, mailbox))
    }
}

impl<const D: usize> Mailbox<D> {
    /// Sets where every point is and how fast it moves, in the coordinates of the device.
    ///
    /// # Errors
    ///
    /// [`HapticsError::ContactPoints`] if there is not one state for each point.
    pub fn set(&mut self, states: &[PointState<D>]) -> Result<(), HapticsError> {
        if states.len() != self.points {
            return Err(HapticsError::ContactPoints {
                servo: states.len(),
                device: self.points,
            });
        }
        self.states.set(|all| all.clone_from_slice(states));
        Ok(())
    }

    /// The newest forces on the hand [N], one for each point; empty before the first tick.
    #[must_use]
    pub fn forces(&mut self) -> &[Vector<f64, D>] {
        self.forces.latest().map_or(&[], Vec::as_slice)
    }
}

impl<const D: usize> Device<D> for MailboxDevice<D> {
    fn points(&self) -> usize {
        self.points
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read(&mut self, _time: f64, points: &mut [PointState<D>]) -> Result<(), DeviceLost> {
        if let Some(states) = self.states.latest() {
            for (point, state) in points.iter_mut().zip(states) {
                *point = *state;
            }
        } else {
            points.fill(PointState::at_rest(Vector::ZERO));
        }
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write(&mut self, forces: &[Vector<f64, D>]) -> Result<(), DeviceLost> {
        self.forces.set(|all| {
            for (written, force) in all.iter_mut().zip(forces) {
                *written = *force;
            }
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_states_and_forces_count() {
        let (mut device, mut mailbox) =
            MailboxDevice::<2>::new(DeviceProfile::unlimited("two"), 2).unwrap();
        let mut points = [PointState::at_rest(Vector([9.0; 2])); 2];
        device.read(0.0, &mut points).unwrap();
        assert_eq!(points, [PointState::at_rest(Vector::ZERO); 2]);
        assert!(mailbox.forces().is_empty());
        for x in [1.0, 2.0] {
            let state = PointState::at_rest(Vector([x, 0.0]));
            mailbox.set(&[state, state]).unwrap();
            device.write(&[Vector([0.0, x]), Vector::ZERO]).unwrap();
        }
        device.read(1.0, &mut points).unwrap();
        assert_eq!(points[1].position, Vector([2.0, 0.0]));
        assert_eq!(mailbox.forces(), [Vector([0.0, 2.0]), Vector::ZERO]);
        assert!(mailbox.set(&points[..1]).is_err());
        assert!(MailboxDevice::<2>::new(DeviceProfile::unlimited("none"), 0).is_err());
    }
}
