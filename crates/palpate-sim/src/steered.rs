// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A simulated device whose hand another thread leads.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::SimulationError;
use palpate_device::{
    Buttons, Device, DeviceError, DeviceLost, DeviceProfile, GripperState, LatestReader,
    LatestWriter, NumberError, PointState, Reading, TurnState, latest_value,
};
use palpate_field::{Point, Vector};
use std::time::Duration;

use crate::simulated::SimulatedDevice;

/// The longest time over which a hand goes to a new target [s]: that between two targets of a
/// pointer that pauses is no measure of how fast it moves.
const LONGEST_WAY: f64 = 0.1;

/// The time over which a hand goes to its first target [s]: that between two frames.
const FIRST_WAY: f64 = 1.0 / 60.0;

/// A [`SimulatedDevice`] whose hands go where a [`Steering`] leads them, as a pointer on a screen
/// does.
///
/// Targets come at 60 to 125 Hz, ticks at 1 kHz: a hand goes straight to a new target over the
/// time that passed between the last two, so that it moves evenly, one interval late, and no
/// faster than its largest speed. The device gives way as a simulated device does: where a body
/// holds it back, device and target part.
///
/// # Examples
///
/// ```
/// use palpate_device::{Device, PointState, profile_named};
/// use palpate_sim::{Hand, SimulatedDevice, SteeredDevice};
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let device = SimulatedDevice::new(
///     profile_named("omega")?,
///     vec![Hand::resting(Vector([0.0, 0.0, 0.0]))?],
/// )?;
/// let (mut device, mut steering) = SteeredDevice::new(device, 1.0)?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// device.read(0.0, &mut points)?;
/// steering.steer(&[Vector([0.02, 0.0, 0.0])])?; // from any thread
/// for tick in 1..=1000 {
///     device.read(1e-3 * f64::from(tick), &mut points)?;
/// }
/// // Friction keeps the device a little short of it.
/// assert!((points[0].position[0] - 0.02).abs() < 0.005);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct SteeredDevice {
    device: SimulatedDevice,
    targets: LatestReader<Vec<Point<3>>>,
    ways: Vec<Way>,
    max_speed: f64,
    /// The time of the last read [s].
    time: Option<f64>,
}

/// The straight way of a hand to its target.
#[derive(Clone, Copy, Debug)]
struct Way {
    from: Point<3>,
    to: Point<3>,
    /// When it began [s].
    start: f64,
    /// How long it takes [s].
    duration: f64,
    /// Where the hand is on it.
    at: Point<3>,
}

impl Way {
    /// Goes on from the time `last` to `time` [s], by at most `max_speed` [m/s].
    fn go(&mut self, last: f64, time: f64, max_speed: f64) {
        let part = ((time - self.start) / self.duration).clamp(0.0, 1.0);
        let wanted = self.from + (self.to - self.from) * part - self.at;
        let most = max_speed * (time - last).max(0.0);
        let length = wanted.norm();
        // Written so that a way that is not a number is not gone.
        if length <= most {
            self.at += wanted;
        } else if length > most {
            self.at += wanted * (most / length);
        }
    }
}

/// Leads the hands of a [`SteeredDevice`], from any thread; the servo never waits for it.
#[derive(Debug)]
pub struct Steering {
    targets: LatestWriter<Vec<Point<3>>>,
    hands: usize,
}

impl Steering {
    /// Leads each hand to a target [m], in the coordinates of the device.
    ///
    /// # Errors
    ///
    /// [`DeviceError::OneForEach`] if there is not one target for each hand;
    /// [`SimulationError::TargetNotFinite`] if one is not finite. No hand is led anywhere then.
    pub fn steer(
        &mut self,
        targets: &[impl Into<Point<3>> + Copy],
    ) -> Result<(), SimulationError> {
        if targets.len() != self.hands {
            let (items, given) = ("targets", targets.len());
            return Err(DeviceError::OneForEach { items, given, points: self.hands }.into());
        }
        let targets = || targets.iter().map(|target| (*target).into());
        for (index, target) in targets().enumerate() {
            if let Some(value) = target.0.into_iter().find(|x| !x.is_finite()) {
                return Err(SimulationError::TargetNotFinite { index, value });
            }
        }
        self.targets.set(|all| all.iter_mut().zip(targets()).for_each(|(one, new)| *one = new));
        Ok(())
    }
}

impl SteeredDevice {
    /// A device whose hands rest where those of `device` begin, until they are led elsewhere by
    /// at most `max_speed` [m/s]; and what leads them.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the speed is not positive.
    #[inline(never)]
    pub fn new(
        mut device: SimulatedDevice,
        max_speed: f64,
    ) -> Result<(Self, Steering), SimulationError> {
        let max_speed = NumberError::check_positive("max_speed", max_speed, "m/s")?;
        let places = device.start_places();
        let ways = places.iter().map(|at| {
            let (from, to, start) = (*at, *at, f64::NEG_INFINITY);
            Way { from, to, start, duration: FIRST_WAY, at: *at }
        });
        let ways = ways.collect();
        for (hand, place) in places.iter().enumerate() {
            device.aim(hand, *place);
        }
        let hands = places.len();
        let (writer, reader) = latest_value(places);
        let steering = Steering { targets: writer, hands };
        Ok((Self { device, targets: reader, ways, max_speed, time: None }, steering))
    }

    /// The simulated device.
    #[must_use]
    pub fn simulated(&self) -> &SimulatedDevice {
        &self.device
    }

    /// Where each hand is led at the moment [m].
    pub fn hands(&self) -> impl Iterator<Item = Point<3>> {
        self.ways.iter().map(|way| way.at)
    }
}

impl Device for SteeredDevice {
    fn points(&self) -> usize {
        self.device.points()
    }

    fn profile(&self) -> &DeviceProfile {
        self.device.profile()
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        let last = self.time.replace(time).unwrap_or(time);
        if let Some(targets) = self.targets.latest() {
            for (way, target) in self.ways.iter_mut().zip(targets) {
                if *target != way.to {
                    let since = time - way.start;
                    let duration =
                        if since < f64::INFINITY { since.min(LONGEST_WAY) } else { FIRST_WAY };
                    *way = Way { from: way.at, to: *target, start: time, duration, ..*way };
                }
            }
        }
        for (hand, way) in self.ways.iter_mut().enumerate() {
            way.go(last, time, self.max_speed);
            self.device.aim(hand, way.at);
        }
        self.device.read(time, points)
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.device.write(forces)
    }

    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        self.device.read_turn()
    }

    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.device.write_torque(torque)
    }

    fn buttons(&mut self) -> Buttons {
        self.device.buttons()
    }

    fn read_gripper(&mut self) -> Result<Option<GripperState>, DeviceLost> {
        self.device.read_gripper()
    }

    fn write_gripper_force(&mut self, force: f64) -> Result<(), DeviceLost> {
        self.device.write_gripper_force(force)
    }

    fn set_watchdog(&mut self, time: Duration) -> Result<Option<Duration>, DeviceLost> {
        self.device.set_watchdog(time)
    }

    fn close(&mut self) -> Result<(), DeviceLost> {
        self.device.close()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Hand;

    fn steered(max_speed: f64) -> (SteeredDevice, Steering) {
        let profile = DeviceProfile { friction: 0.0, ..DeviceProfile::unlimited("ideal") };
        let profile = DeviceProfile { mass: 0.1, least_damping: 1.0, ..profile };
        let hand = Hand::resting(Vector([1.0, 0.0, 0.0])).unwrap();
        let device = SimulatedDevice::new(profile, vec![hand]).unwrap();
        SteeredDevice::new(device, max_speed).unwrap()
    }

    fn hand_at(device: &mut SteeredDevice, time: f64) -> f64 {
        device.read(time, &mut [PointState::at_rest(Vector::ZERO)]).unwrap();
        device.hands().next().unwrap()[0]
    }

    #[test]
    fn a_hand_goes_evenly_to_a_target_over_the_last_interval() {
        let (mut device, mut steering) = steered(100.0);
        assert_eq!(hand_at(&mut device, 0.0), 1.0);
        steering.steer(&[Vector([2.0, 0.0, 0.0])]).unwrap();
        assert_eq!(hand_at(&mut device, 1.0), 1.0);
        assert!((hand_at(&mut device, 1.0 + 0.5 / 60.0) - 1.5).abs() < 1e-12);
        // The next comes 0.0625 s after the first, and so takes as long.
        assert_eq!(hand_at(&mut device, 1.0625), 2.0);
        steering.steer(&[Vector([1.0, 0.0, 0.0])]).unwrap();
        assert_eq!(hand_at(&mut device, 1.0625), 2.0);
        assert_eq!(hand_at(&mut device, 1.0625 + 0.03125), 1.5);
        assert_eq!(hand_at(&mut device, 1.125), 1.0);
        assert_eq!(hand_at(&mut device, 9.0), 1.0);
    }

    #[test]
    fn a_hand_is_no_faster_than_its_largest_speed() {
        let (mut device, mut steering) = steered(0.5);
        hand_at(&mut device, 0.0);
        steering.steer(&[Vector([2.0, 0.0, 0.0])]).unwrap();
        let mut last = hand_at(&mut device, 0.0);
        for tick in 1..=4000_u32 {
            let now = hand_at(&mut device, 1e-3 * f64::from(tick));
            assert!((0.0..=0.5e-3 * (1.0 + 1e-9)).contains(&(now - last)), "{tick}");
            last = now;
        }
        assert_eq!(last, 2.0);
    }

    #[test]
    fn what_leads_nowhere_is_refused() {
        let (mut device, mut steering) = steered(1.0);
        let none: [Point<3>; 0] = [];
        let error = steering.steer(&none).unwrap_err();
        assert_eq!(error.to_string(), "1 contact points need as many targets, got 0");
        let error = steering.steer(&[Vector([f64::NAN, 0.0, 0.0])]).unwrap_err();
        assert_eq!(error.to_string(), "target 0 must be finite, got NaN m");
        assert_eq!(hand_at(&mut device, 1.0), 1.0);
        assert!(SteeredDevice::new(device.device.clone(), 0.0).is_err());
    }

    #[test]
    fn a_device_held_back_parts_from_its_hand() {
        let (mut device, mut steering) = steered(1.0);
        hand_at(&mut device, 0.0);
        steering.steer(&[Vector([1.1, 0.0, 0.0])]).unwrap();
        let mut points = [PointState::at_rest(Vector::ZERO)];
        for tick in 1..=2000 {
            device.read(1e-3 * f64::from(tick), &mut points).unwrap();
            device.write(&[Vector([-6.0, 0.0, 0.0])]).unwrap();
        }
        // 6 N against a grip of 300 N/m: 20 mm.
        assert!((points[0].position[0] - 1.08).abs() < 1e-6, "{points:?}");
    }
}
