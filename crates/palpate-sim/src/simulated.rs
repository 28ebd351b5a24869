// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A simulated device, in a hand that yields to forces.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::SimulationError;
use palpate_device::{
    Buttons, Device, DeviceError, DeviceLost, DeviceProfile, GripperState, NumberError,
    PointState, Reading, TurnState, limited,
};
use palpate_field::{Point, Vector};
use std::time::Duration;

use crate::hand::Hand;
use crate::hand_path::HandPath;
use crate::motion::{Axis, Body, Energies, Load, Parts};
use crate::recorded::{Script, Watchdog};
use crate::turning::Turning;

/// Reads closer in time than this count as one [s]: a shorter difference gives no velocity.
const SHORTEST: f64 = 1e-9;

/// A device of a [`DeviceProfile`], held by a [`Hand`] at each of its contact points.
///
/// A contact point is a mass with the profile's viscous damping and Coulomb friction, together
/// with its hand's mass, spring, damper and push. The force written last, clamped to the
/// profile's largest, is held until the next write: a zero-order hold. Between two reads the
/// motion is integrated in closed form, with the hand's path as a straight line between its
/// places at the two reads; sticking and breakaway within that time are found. A read gives the
/// position in whole encoder steps.
///
/// The axes move independently, so friction acts on each axis: `f_c` along an axis, up to `√3
/// f_c` diagonally, as in a machine with one drive per axis.
///
/// The velocity read is the difference of the last two positions read, over the time between
/// them: with an encoder step Δ it comes in steps of Δ times the rate. Damping needs a better
/// estimate, over a window of positions.
///
/// A device whose profile has [rotation](DeviceProfile::turning) and that one hand holds also
/// rotates: with inertia, damping, friction and encoder steps about each axis, and a torque
/// that is held. The inertia is the same about every axis.
///
/// The device has a [watchdog](Device::set_watchdog), which takes the forces away when nothing was
/// written for its time. Buttons and a gripper follow a script.
///
/// The device starts at rest at the hand's target at the time of the first read. The servo must
/// keep all limits of the profile other than the largest force.
///
/// # Examples
///
/// A mass of 0.5 kg accelerates freely under a push of 1 N:
///
/// ```
/// use palpate_device::{Device, DeviceProfile, PointState};
/// use palpate_sim::{Hand, SimulatedDevice};
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ideal = DeviceProfile {
///     mass: 0.5,
///     least_damping: 0.0,
///     friction: 0.0,
///     ..DeviceProfile::unlimited("ideal")
/// };
/// let hand = Hand::resting(Vector([0.0, 3.0, 0.0]))?.with_mass(0.0)?.with_spring(0.0, 0.0)?;
/// let hand = hand.with_push(Vector([0.0, -1.0, 0.0]))?;
/// let mut device = SimulatedDevice::new(ideal, vec![hand])?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// device.read(0.0, &mut points)?;
/// device.read(0.5, &mut points)?;
/// assert_eq!(points[0].position, Vector([0.0, 2.75, 0.0])); // −½ (1 N / 0.5 kg) (0.5 s)²
/// assert_eq!(device.kinetic_energy(), 0.25); // that of the push over 0.25 m
/// assert_eq!(device.energy_given(), 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SimulatedDevice {
    profile: DeviceProfile,
    points: Vec<SimulatedPoint>,
    /// The rotation; `None` for a device without it.
    turning: Option<Turning>,
    /// The time of the last read [s].
    time: Option<f64>,
    script: Script,
    /// The held force on the fingers in the gripper [N].
    gripper_force: f64,
    watchdog: Watchdog,
}

#[derive(Clone, Debug)]
struct SimulatedPoint {
    hand: Hand,
    body: Body,
    axes: [Axis; 3],
    /// The force held [N].
    force: Vector<f64, 3>,
    /// The last reading.
    reading: PointState,
    /// The hand's target at the last read [m].
    target: Point<3>,
    /// Where the hand wants to be instead of on its path [m].
    aim: Option<Point<3>>,
    energies: Energies,
}

impl SimulatedDevice {
    /// A device with one contact point for each hand.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there is no hand. [`SimulationError::Number`] if the
    /// profile's mass, least damping, friction or encoder step is negative or not finite, its
    /// largest force is negative or NaN, neither device nor hand has a mass, or `c / M + √(k /
    /// M)` of both together, with the damping `c`, stiffness `k` and mass `M`, is more than 1e4
    /// / s; the same rules hold for rotation.
    #[inline(never)]
    pub fn new(profile: DeviceProfile, hands: Vec<Hand>) -> Result<Self, SimulationError> {
        if hands.is_empty() {
            return Err(DeviceError::NoContactPoint.into());
        }
        NumberError::check_not_negative("encoder_step", profile.encoder_step, "m")?;
        if profile.max_force != f64::INFINITY {
            NumberError::check_not_negative("max_force", profile.max_force, "N")?;
        }
        let turning = match (&profile.turning, hands.as_slice()) {
            (Some(turning), [hand]) => Some(Turning::new(turning, hand)?),
            _ => None,
        };
        let points = hands.into_iter().map(|hand| {
            let body = Body::new(&Parts {
                device_mass: profile.mass,
                hand_mass: hand.mass(),
                damping: profile.least_damping,
                friction: profile.friction,
                grip_stiffness: hand.stiffness(),
                grip_damping: hand.damping(),
            })?;
            Ok(SimulatedPoint {
                hand,
                body,
                axes: [Axis { position: 0.0, velocity: 0.0 }; 3],
                force: Vector::ZERO,
                reading: PointState::at_rest(Vector::ZERO),
                target: Vector::ZERO,
                aim: None,
                energies: Energies::default(),
            })
        });
        let points = points.collect::<Result<_, SimulationError>>()?;
        let (script, watchdog) = (Script::default(), Watchdog::default());
        Ok(Self { profile, points, turning, time: None, script, gripper_force: 0.0, watchdog })
    }

    /// This device with buttons that are held down: those of an entry from its time on [s], up to
    /// the time of the next entry. Before the first no button is down.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if a time is NaN or earlier than the one before.
    pub fn with_buttons(
        mut self,
        buttons: Vec<(f64, Buttons)>,
    ) -> Result<Self, SimulationError> {
        self.script.set_buttons(buttons)?;
        Ok(self)
    }

    /// This device with a gripper that opens as `path` says along x [m], whatever the force on the fingers.
    #[must_use]
    pub fn with_gripper(mut self, path: HandPath) -> Self {
        self.script.gripper = Some(path);
        self
    }

    /// The held force on the fingers in the gripper [N]: the last one written, clamped to the
    /// largest of the profile's gripper, zero for a profile without one.
    #[must_use]
    pub fn gripper_force(&self) -> f64 {
        self.gripper_force
    }

    /// How often the device took its forces away by itself, because nothing was written to it for
    /// the time of its [watchdog](Device::set_watchdog).
    #[must_use]
    pub fn watchdog_trips(&self) -> u64 {
        self.watchdog.trips()
    }

    /// Moves from the time `last` to `time` [s]; without force from the time at which the watchdog
    /// takes it away.
    fn advance(&mut self, last: f64, time: f64) {
        let Some(end) = self.watchdog.trip(time) else {
            self.advance_evenly(last, time);
            return;
        };
        if end - last >= SHORTEST {
            self.advance_evenly(last, end);
        }
        self.let_go();
        let last = last.max(end);
        if time - last >= SHORTEST {
            self.advance_evenly(last, time);
        }
    }

    /// Moves from the time `last` to `time` [s] with the held forces.
    fn advance_evenly(&mut self, last: f64, time: f64) {
        self.points.iter_mut().for_each(|point| point.advance(last, time));
        if let Some(turning) = &mut self.turning {
            turning.advance(last, time);
        }
    }

    /// Takes all forces away.
    fn let_go(&mut self) {
        self.points.iter_mut().for_each(|point| point.force = Vector::ZERO);
        if let Some(turning) = &mut self.turning {
            turning.write(Vector::ZERO);
        }
        self.gripper_force = 0.0;
    }

    /// Where the hands want to be at first [m].
    pub(crate) fn start_places(&self) -> Vec<Point<3>> {
        self.points.iter().map(|point| point.wanted(0.0)).collect()
    }

    /// Lets a hand want to be at `place` [m] from now on, whatever its path.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn aim(&mut self, hand: usize, place: Point<3>) {
        if let Some(point) = self.points.get_mut(hand) {
            point.aim = Some(place);
        }
    }

    /// The true state of each contact point, without encoder steps.
    pub fn states(&self) -> impl Iterator<Item = PointState> {
        self.points.iter().map(SimulatedPoint::state)
    }

    /// The true orientation and angular velocity, without encoder steps; `None` for a device
    /// without rotation.
    #[must_use]
    pub fn turn(&self) -> Option<TurnState> {
        self.turning.as_ref().map(Turning::state)
    }

    /// The held torque [N·m]: the last one written, clamped to the largest.
    #[must_use]
    pub fn torque(&self) -> Vector<f64, 3> {
        self.turning.as_ref().map_or(Vector::ZERO, Turning::torque)
    }

    /// The held forces [N]: the last ones written, clamped to the largest.
    pub fn forces(&self) -> impl Iterator<Item = Vector<f64, 3>> {
        self.points.iter().map(|point| point.force)
    }

    /// The energy balance of all contact points and the rotation up to the last read.
    #[must_use]
    pub fn energies(&self) -> Energies {
        let mut sum = Energies::default();
        for point in &self.points {
            sum.add(&point.energies);
        }
        if let Some(turning) = &self.turning {
            sum.add(turning.energies());
        }
        sum
    }

    /// The work that the servo's forces and torques did on device and hand from the start to the
    /// last read, `∑ ∫ F·dx + ∫ τ·dθ` over all contact points [J].
    ///
    /// Exact, because force and torque are constant between writes. Positive if the virtual
    /// world gave energy, as even a plain sampled spring does. The device's own damping and
    /// friction may dissipate this energy; the remainder is
    /// [`energy_to_hand`](Self::energy_to_hand).
    #[must_use]
    pub fn energy_given(&self) -> f64 {
        self.energies().servo
    }

    /// The work that device and arm did on the hands' springs, dampers and pushes from the start
    /// to the last read [J].
    ///
    /// Never positive if device and virtual world together are passive: for a wall of stiffness
    /// `K` read without steps, if `K ≤ 2b/T` (Colgate and Schenkel 1997).
    #[must_use]
    pub fn energy_to_hand(&self) -> f64 {
        -self.energies().hand
    }

    /// The kinetic energy of device and hands, `∑ ½ M v² + ½ I ω²` [J].
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let of = |point: &SimulatedPoint| {
            let velocity = point.state().velocity;
            0.5 * point.body.mass() * velocity.dot(velocity)
        };
        let turning = self.turning.as_ref().map_or(0.0, Turning::kinetic_energy);
        self.points.iter().map(of).sum::<f64>() + turning
    }
}

impl SimulatedPoint {
    fn state(&self) -> PointState {
        PointState {
            position: Vector(self.axes.map(|axis| axis.position)),
            velocity: Vector(self.axes.map(|axis| axis.velocity)),
        }
    }

    /// Where the hand wants to be at a time [s].
    fn wanted(&self, time: f64) -> Point<3> {
        self.aim.unwrap_or_else(|| self.hand.path().state_at(time).position)
    }

    /// Places the device at the hand's target.
    fn start(&mut self, time: f64, encoder_step: f64) {
        self.target = self.wanted(time);
        self.axes = self.target.0.map(|position| Axis { position, velocity: 0.0 });
        self.reading = PointState::at_rest(self.encoded(encoder_step));
    }

    /// Moves from the time `last` to `time` [s].
    fn advance(&mut self, last: f64, time: f64) {
        let duration = time - last;
        let target = self.wanted(time);
        let target_velocity = (target - self.target) * (1.0 / duration);
        let push = self.hand.push();
        let loads = self.force.0.iter().zip(push.0).zip(self.target.0).zip(target_velocity.0);
        for (axis, (((force, push), target), target_velocity)) in
            self.axes.iter_mut().zip(loads)
        {
            let load = Load { force: *force, push, target, target_velocity };
            self.energies.add(&self.body.advance(axis, load, duration));
        }
        self.target = target;
    }

    /// Reads the point, `duration` after the last reading [s].
    fn measure(&mut self, duration: f64, encoder_step: f64) {
        let position = self.encoded(encoder_step);
        let velocity = (position - self.reading.position) * (1.0 / duration);
        self.reading = PointState { position, velocity };
    }

    /// The position in whole steps of the encoder.
    fn encoded(&self, step: f64) -> Point<3> {
        let position = self.state().position;
        if step > 0.0 {
            Vector(position.0.map(|x| (x / step).round() * step))
        } else {
            position
        }
    }
}

impl Device for SimulatedDevice {
    fn points(&self) -> usize {
        self.points.len()
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic. A time that is not a
    /// nanosecond later than the last, or not finite, repeats the last reading. After a gap of
    /// more than a tenth of a second, a device with a stiff hand may have stood still for a part
    /// of it.
    #[inline(never)]
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        let encoder_step = self.profile.encoder_step;
        let mut is_new = true;
        match self.time {
            None => {
                for point in &mut self.points {
                    point.start(time, encoder_step);
                }
                if let Some(turning) = &mut self.turning {
                    turning.start(time);
                }
                self.time = time.is_finite().then_some(time);
            }
            Some(last) if time - last >= SHORTEST && time <= f64::MAX => {
                self.advance(last, time);
                for point in &mut self.points {
                    point.measure(time - last, encoder_step);
                }
                if let Some(turning) = &mut self.turning {
                    turning.measure(time - last);
                }
                self.time = Some(time);
            }
            Some(_) => is_new = false,
        }
        for (reading, point) in points.iter_mut().zip(&self.points) {
            *reading = point.reading;
        }
        Ok(if is_new { Reading::Fresh { time } } else { Reading::Stale })
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic. A force that is not finite
    /// counts as zero.
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        for (point, force) in self.points.iter_mut().zip(forces) {
            point.force = limited(*force, self.profile.max_force);
        }
        self.watchdog.written(self.time);
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        Ok(self.turning.as_ref().map(Turning::reading))
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic. A torque that is not finite
    /// counts as zero.
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        if let Some(turning) = &mut self.turning {
            turning.write(torque);
        }
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn buttons(&mut self) -> Buttons {
        self.time.map_or(Buttons::NONE, |time| self.script.buttons(time))
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_gripper(&mut self) -> Result<Option<GripperState>, DeviceLost> {
        Ok(self.time.and_then(|time| self.script.gripper(time)))
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic. A force that is not finite counts
    /// as zero.
    fn write_gripper_force(&mut self, force: f64) -> Result<(), DeviceLost> {
        let most = self.profile.gripper.map_or(0.0, |gripper| gripper.max_force);
        let Vector([force, ..]) = limited(Vector([force, 0.0, 0.0]), most);
        self.gripper_force = force;
        Ok(())
    }

    /// The device keeps every time; it counts by the times of the reads.
    fn set_watchdog(&mut self, time: Duration) -> Result<Option<Duration>, DeviceLost> {
        self.watchdog.set(time);
        Ok(Some(time))
    }

    /// Takes all forces away.
    fn close(&mut self) -> Result<(), DeviceLost> {
        self.let_go();
        self.watchdog.written(None);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resting(encoder_step: f64) -> SimulatedDevice {
        let profile = DeviceProfile {
            mass: 0.1,
            least_damping: 0.5,
            friction: 0.0,
            max_force: 2.5,
            encoder_step,
            ..DeviceProfile::unlimited("test")
        };
        let hand = Hand::resting(Vector([0.010_4, -0.003, 0.0])).unwrap();
        SimulatedDevice::new(profile, vec![hand]).unwrap()
    }

    #[test]
    fn forces_are_cut_to_the_largest_and_what_is_none_is_zero() {
        let mut device = resting(0.0);
        for (written, expected) in [
            ([3.0, -4.0, 0.0], [1.5, -2.0, 0.0]),
            ([0.6, 0.8, 0.0], [0.6, 0.8, 0.0]),
            ([f64::NAN, 1.0, 0.0], [0.0; 3]),
            ([f64::INFINITY, 1.0, 0.0], [0.0; 3]),
        ] {
            device.write(&[Vector(written)]).unwrap();
            assert_eq!(device.forces().next(), Some(Vector(expected)));
        }
    }

    #[test]
    fn positions_come_in_steps_and_velocities_are_their_differences() {
        let mut device = resting(1e-3);
        let mut points = [PointState::at_rest(Vector::ZERO)];
        device.read(0.0, &mut points).unwrap();
        assert_eq!(points[0], PointState::at_rest(Vector([10.0 * 1e-3, -3.0 * 1e-3, 0.0])));
        device.write(&[Vector([2.0, 0.0, 0.0])]).unwrap();
        let mut last = points[0].position;
        for tick in 1..=100 {
            device.read(0.001 * f64::from(tick), &mut points).unwrap();
            let steps = points[0].position[0] / 1e-3;
            assert!((steps - steps.round()).abs() < 1e-12);
            let true_position = device.states().next().unwrap().position;
            assert!((points[0].position - true_position).norm() <= 0.5e-3 * 2.0_f64.sqrt());
            let speed = (points[0].position[0] - last[0]) / 0.001;
            assert!((points[0].velocity[0] - speed).abs() < 1e-9);
            last = points[0].position;
        }
        assert!(last[0] > 0.012);
    }

    #[test]
    fn times_that_do_not_go_on_repeat_the_last_reading() {
        let mut device = resting(0.0);
        let mut points = [PointState::at_rest(Vector::ZERO)];
        device.read(f64::NAN, &mut points).unwrap();
        assert!(points[0].is_finite());
        device.write(&[Vector([2.0, 0.0, 0.0])]).unwrap();
        for time in [0.0, 0.1] {
            device.read(time, &mut points).unwrap();
        }
        let (reading, energies) = (points[0], device.energies());
        for time in [0.1, 0.05, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            device.read(time, &mut points).unwrap();
            assert_eq!((points[0], device.energies()), (reading, energies));
        }
        device.read(1e12, &mut points).unwrap();
        assert!(points[0].is_finite());
    }

    #[test]
    fn wrong_profiles_are_refused_with_their_numbers() {
        let hand = || vec![Hand::resting(Vector([0.0, 0.0, 0.0])).unwrap()];
        let profile = resting(0.0).profile;
        let error = |profile: DeviceProfile| {
            SimulatedDevice::new(profile, hand()).unwrap_err().to_string()
        };
        let none = SimulatedDevice::new(profile.clone(), Vec::new());
        assert_eq!(none.unwrap_err(), DeviceError::NoContactPoint.into());
        let unlimited = error(DeviceProfile::unlimited("x"));
        assert_eq!(unlimited, "least_damping must be zero or more and finite, got inf N·s/m");
        let negative = error(DeviceProfile { friction: -1.0, ..profile.clone() });
        assert_eq!(negative, "friction must be zero or more and finite, got -1 N");
        assert!(
            error(DeviceProfile { max_force: f64::NAN, ..profile.clone() }).contains("NaN")
        );
        let fast = error(DeviceProfile { least_damping: 1e5, ..profile });
        assert!(fast.contains("must be at most 1e4, got"), "{fast}");
    }

    #[test]
    fn a_force_that_is_not_renewed_ends_with_the_watchdog() {
        // A force of 1 N against a push of 1 N, on 0.1 kg without damping.
        let profile =
            DeviceProfile { mass: 0.1, least_damping: 0.0, ..DeviceProfile::unlimited("test") };
        let hand =
            Hand::resting(Vector([0.0, 0.0, 0.0])).unwrap().with_spring(0.0, 0.0).unwrap();
        let hand = hand.with_mass(0.0).unwrap().with_push(Vector([0.0, -1.0, 0.0])).unwrap();
        let profile = DeviceProfile { friction: 0.0, ..profile };
        let mut device = SimulatedDevice::new(profile, vec![hand]).unwrap();
        let asked = Duration::from_millis(30);
        assert_eq!(device.set_watchdog(asked).unwrap(), Some(asked));
        let mut points = [PointState::at_rest(Vector::ZERO)];
        device.read(0.0, &mut points).unwrap();
        device.write(&[Vector([0.0, 1.0, 0.0])]).unwrap();
        device.read(0.03, &mut points).unwrap();
        assert_eq!((points[0].position, device.watchdog_trips()), (Vector::ZERO, 0));
        device.write(&[Vector([0.0, 1.0, 0.0])]).unwrap();
        device.read(0.08, &mut points).unwrap();
        // Free for 20 of 50 ms: −½ (1 N / 0.1 kg) (20 ms)², a mean of −40 mm/s.
        assert!((points[0].position[1] + 0.002).abs() < 1e-12, "{points:?}");
        assert!((points[0].velocity[1] + 0.04).abs() < 1e-12, "{points:?}");
        assert_eq!((device.watchdog_trips(), device.forces().next()), (1, Some(Vector::ZERO)));
        device.read(0.2, &mut points).unwrap();
        assert_eq!(device.watchdog_trips(), 1);
    }
}
