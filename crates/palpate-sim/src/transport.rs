// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can go wrong between a device and a servo, simulated.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::{Fault, FaultKind, SimulationError};
use palpate_device::{
    Buttons, Device, DeviceLost, DeviceProfile, GripperState, NumberError, PointState, Reading,
    TurnState,
};
use palpate_field::Vector;
use std::collections::VecDeque;
use std::time::Duration;

/// The longest step in which a device moves that nobody reads [s].
const LONGEST_STEP: f64 = 1e-3;

/// The least time between two measurements [s]: jitter turns no order around.
const SHORTEST_STEP: f64 = 1e-6;

/// How often the methods around a run were called.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Calls {
    /// Calls of [`Device::open`] that succeeded.
    pub opened: u64,
    /// Calls of [`Device::open`] that failed.
    pub failed: u64,
    /// Calls of [`Device::enable`].
    pub enabled: u64,
    /// Calls of [`Device::close`].
    pub closed: u64,
}

/// A device with a transport that jitters, repeats, drops, delays or loses readings by a plan, and
/// that may set the pace: the same readings in every run.
///
/// The device behind it goes on while its readings do not come. What reaches the servo when they do
/// is what a real device would give.
///
/// # Examples
///
/// ```
/// use palpate_device::{Device, PointState, Reading};
/// use palpate_sim::{
///     Fault, FaultKind, HandPath, Interpolation, RecordedDevice, SimulatedTransport,
/// };
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.0, 0.0]), Vector([1.0, 0.0, 0.0])];
/// let hand = HandPath::new(vec![0.0, 8.0], ends, Interpolation::Linear)?;
/// let repeats = Fault { start: 2.0, duration: 2.0, kind: FaultKind::Stale };
/// let mut device = SimulatedTransport::new(RecordedDevice::new(vec![hand])?, vec![repeats])?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// assert_eq!(device.read(1.0, &mut points)?, Reading::Fresh { time: 1.0 });
/// assert_eq!(device.read(2.0, &mut points)?, Reading::Stale);
/// assert_eq!(device.read(3.0, &mut points)?, Reading::Stale);
/// assert_eq!(device.read(4.0, &mut points)?, Reading::Fresh { time: 4.0 });
/// assert_eq!(points[0].position, Vector([0.5, 0.0, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SimulatedTransport<T> {
    device: T,
    faults: Vec<Fault>,
    /// Where the generator of jitter stands.
    random: u64,
    /// The duration of a tick, if the device sets the pace [s].
    period: Option<f64>,
    /// The time of the last tick, without jitter [s].
    tick: Option<f64>,
    /// The time of the last tick [s].
    time: Option<f64>,
    /// The newest measurements, the last of them last.
    measured: VecDeque<Measured>,
    /// How many measurements were made.
    made: u64,
    /// How many measurements the servo has had, or had passed by.
    passed: u64,
    /// What the servo read last beside the points.
    turn: Option<TurnState>,
    buttons: Buttons,
    gripper: Option<GripperState>,
    /// The losses that are over, in the order of the faults.
    lost: Vec<bool>,
    /// How often the device must still be opened; zero while it is there.
    attempts: u32,
    calls: Calls,
}

/// A measurement on its way.
#[derive(Clone, Debug)]
struct Measured {
    reading: Reading,
    points: Vec<PointState>,
    turn: Option<TurnState>,
    buttons: Buttons,
    gripper: Option<GripperState>,
}

impl<T: Device> SimulatedTransport<T> {
    /// A device with these faults.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if a number of a fault is not finite, a time is negative, a delay more
    /// than 10 000 ticks, or the attempt that ends a loss is the one of number 0.
    pub fn new(device: T, faults: Vec<Fault>) -> Result<Self, SimulationError> {
        let mut longest = 0;
        for fault in &faults {
            fault.check()?;
            if let FaultKind::Delay { ticks } = fault.kind {
                longest = longest.max(ticks as usize);
            }
        }
        let none = Measured {
            reading: Reading::NotReady,
            points: vec![PointState::at_rest(Vector::ZERO); device.points()],
            turn: None,
            buttons: Buttons::NONE,
            gripper: None,
        };
        Ok(Self {
            device,
            lost: vec![false; faults.len()],
            faults,
            random: 0,
            period: None,
            tick: None,
            time: None,
            measured: vec![none; longest + 1].into(),
            made: 0,
            passed: 0,
            turn: None,
            buttons: Buttons::NONE,
            gripper: None,
            attempts: 0,
            calls: Calls::default(),
        })
    }

    /// The same with another jitter.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { random: seed, ..self }
    }

    /// The same for a device that sets the pace: it measures `rate` times a second [Hz] by its own
    /// time, which begins at zero.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the rate is not positive and finite.
    pub fn pacing_at(self, rate: f64) -> Result<Self, SimulationError> {
        Ok(Self { period: Some(1.0 / NumberError::check_rate(rate)?), ..self })
    }

    /// The device behind the transport.
    #[must_use]
    pub fn device(&self) -> &T {
        &self.device
    }

    /// How often the methods around a run were called.
    #[must_use]
    pub fn calls(&self) -> Calls {
        self.calls
    }

    /// The faults that last at a time [s].
    fn acting(&self, time: f64) -> impl Iterator<Item = FaultKind> {
        let lasts =
            move |fault: &&Fault| time >= fault.start && time < fault.start + fault.duration;
        self.faults.iter().filter(lasts).map(|fault| fault.kind)
    }

    /// The next number of the generator, evenly in [−1, 1]: SplitMix64 of Steele, Lea and Flood,
    /// "Fast splittable pseudorandom number generators" (2014).
    fn draw(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.random;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        2.0 * ((bits >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
    }

    /// Takes the loss that begins up to a time [s], if there is one.
    fn begins_loss(&mut self, time: f64) -> Option<u32> {
        let faults = self.faults.iter().zip(&mut self.lost);
        for (fault, is_over) in faults {
            if let FaultKind::Lost { attempts } = fault.kind
                && time >= fault.start
                && !std::mem::replace(is_over, true)
            {
                return Some(attempts);
            }
        }
        None
    }

    /// Measures the device in a tick at `time` [s].
    fn measure(&mut self, time: f64) -> Result<(), DeviceLost> {
        let jitter = self.acting(time).fold(0.0, |sum, kind| match kind {
            FaultKind::Jitter { most } => sum + most,
            _ => sum,
        });
        let jitter = if jitter > 0.0 { jitter * self.draw() } else { 0.0 };
        let last = self.time;
        let at = match last {
            // Jitter may have put the last one later than this tick.
            Some(last) if jitter != 0.0 || time < last => {
                (time + jitter).max(last + SHORTEST_STEP)
            }
            _ => time,
        };
        self.time = Some(at);
        let Some(mut next) = self.measured.pop_front() else { return Ok(()) };
        let made = self.make(&mut next, last, at);
        if made.is_ok() {
            self.made += 1;
            self.measured.push_back(next);
        } else {
            self.measured.push_front(next);
        }
        made
    }

    /// Measures the device at a time `at`, after the one before [s].
    fn make(
        &mut self,
        next: &mut Measured,
        last: Option<f64>,
        at: f64,
    ) -> Result<(), DeviceLost> {
        // A device that nobody read goes on in steps that its integration takes.
        if let Some(last) = last.filter(|last| at - last > 2.0 * LONGEST_STEP) {
            let steps = ((at - last) / LONGEST_STEP).ceil();
            for step in 1..steps as u64 {
                self.device
                    .read(last + (at - last) * (step as f64 / steps), &mut next.points)?;
            }
        }
        next.reading = self.device.read(at, &mut next.points)?;
        next.turn = self.device.read_turn()?;
        next.buttons = self.device.buttons();
        next.gripper = self.device.read_gripper()?;
        Ok(())
    }
}

impl<T: Device> Device for SimulatedTransport<T> {
    fn points(&self) -> usize {
        self.device.points()
    }

    fn profile(&self) -> &DeviceProfile {
        self.device.profile()
    }

    /// Real-time: allocates nothing until the device is lost, takes no lock, cannot panic; as far as
    /// the device behind it does.
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        // A reading that is not fresh must not be looked at.
        points.fill(PointState::at_rest(Vector([f64::NAN; 3])));
        let time = match (self.period, self.tick) {
            (Some(period), Some(last)) => last + period,
            (Some(_), None) => 0.0,
            (None, _) => time,
        };
        self.tick = Some(time);
        if let Some(attempts) = self.begins_loss(time) {
            self.attempts = attempts;
        }
        if self.attempts > 0 {
            return Err(DeviceLost::new(format!("the plan of faults says so at {time} s")));
        }
        self.measure(time)?;
        let (mut is_stale, mut is_ready, mut delay, mut off) = (false, true, 0, 0.0);
        for kind in self.acting(time) {
            match kind {
                FaultKind::Stale => is_stale = true,
                FaultKind::NotReady => is_ready = false,
                FaultKind::Delay { ticks } => delay = delay.max(u64::from(ticks)),
                FaultKind::Glitch { distance } => off += distance,
                FaultKind::Jitter { .. } | FaultKind::Lost { .. } => {}
            }
        }
        if !is_ready {
            return Ok(Reading::NotReady);
        }
        let due = self.made.saturating_sub(delay);
        if is_stale || due <= self.passed {
            return Ok(Reading::Stale);
        }
        self.passed = due;
        let place = self.measured.len().checked_sub(1 + delay as usize);
        let Some(measured) = place.and_then(|place| self.measured.get(place)) else {
            return Ok(Reading::Stale);
        };
        for (point, state) in points.iter_mut().zip(&measured.points) {
            *point = *state;
            if let Some(x) = point.position.0.first_mut() {
                *x += off;
            }
        }
        (self.turn, self.buttons, self.gripper) =
            (measured.turn, measured.buttons, measured.gripper);
        Ok(measured.reading)
    }

    /// Real-time: as [`read`](Self::read).
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.there()?;
        self.device.write(forces)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        Ok(self.turn)
    }

    /// Real-time: as [`read`](Self::read).
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.there()?;
        self.device.write_torque(torque)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn buttons(&mut self) -> Buttons {
        self.buttons
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_gripper(&mut self) -> Result<Option<GripperState>, DeviceLost> {
        Ok(self.gripper)
    }

    /// Real-time: as [`read`](Self::read).
    fn write_gripper_force(&mut self, force: f64) -> Result<(), DeviceLost> {
        self.there()?;
        self.device.write_gripper_force(force)
    }

    fn open(&mut self) -> Result<(), DeviceLost> {
        self.attempts = self.attempts.saturating_sub(1);
        let opened = self.there().and_then(|()| self.device.open());
        // What was on its way is lost.
        self.passed = self.made;
        *if opened.is_ok() { &mut self.calls.opened } else { &mut self.calls.failed } += 1;
        opened
    }

    fn set_watchdog(&mut self, time: Duration) -> Result<Option<Duration>, DeviceLost> {
        self.there()?;
        self.device.set_watchdog(time)
    }

    fn enable(&mut self) -> Result<(), DeviceLost> {
        self.there()?;
        self.calls.enabled += 1;
        self.device.enable()
    }

    /// Closes the device behind the transport if it is there.
    fn close(&mut self) -> Result<(), DeviceLost> {
        self.calls.closed += 1;
        self.there()?;
        self.device.close()
    }

    fn rate(&self) -> Option<f64> {
        self.period.map(|period| 1.0 / period).or_else(|| self.device.rate())
    }

    fn paces(&self) -> bool {
        self.period.is_some()
    }
}

impl<T> SimulatedTransport<T> {
    /// Refuses a call while the device is lost.
    fn there(&self) -> Result<(), DeviceLost> {
        match self.attempts {
            0 => Ok(()),
            left => Err(DeviceLost::new(format!("it opens at attempt {left} from now"))),
        }
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, clippy::panic, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use crate::{HandPath, Interpolation, RecordedDevice};

    /// A device whose x is the time [s] times a metre a second.
    fn clock() -> RecordedDevice {
        let ends = vec![Vector([0.0, 0.0, 0.0]), Vector([1000.0, 0.0, 0.0])];
        let path = HandPath::new(vec![0.0, 1000.0], ends, Interpolation::Linear).unwrap();
        RecordedDevice::new(vec![path]).unwrap()
    }

    fn with(faults: &[(f64, f64, FaultKind)]) -> SimulatedTransport<RecordedDevice> {
        let fault = |&(start, duration, kind): &_| Fault { start, duration, kind };
        SimulatedTransport::new(clock(), faults.iter().map(fault).collect()).unwrap()
    }

    /// Reads at whole seconds: what came, and where the device was.
    fn reads(
        device: &mut SimulatedTransport<RecordedDevice>,
        count: u32,
    ) -> Vec<(Reading, f64)> {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let mut read = |tick| {
            let reading = device.read(f64::from(tick), &mut points).unwrap();
            (reading, points[0].position[0])
        };
        (0..count).map(&mut read).collect()
    }

    fn fresh(times: &[f64]) -> Vec<(Reading, f64)> {
        times.iter().map(|time| (Reading::Fresh { time: *time }, *time)).collect()
    }

    #[test]
    fn delayed_readings_tell_when_they_were_made() {
        let mut device = with(&[(3.0, 4.0, FaultKind::Delay { ticks: 2 })]);
        let came = reads(&mut device, 9);
        assert_eq!(came[..3], fresh(&[0.0, 1.0, 2.0]));
        // Those on their way when the delay begins have come already.
        assert!(came[3..5].iter().all(|(reading, _)| *reading == Reading::Stale));
        assert_eq!(came[5..], fresh(&[3.0, 4.0, 7.0, 8.0]));
    }

    /// Once the only measurement was dropped with the error, and all after it were stale.
    #[test]
    fn a_device_that_is_found_again_is_fresh_behind_two_transports_too() {
        let lost = Fault { start: 2.0, duration: 0.0, kind: FaultKind::Lost { attempts: 1 } };
        let inner = SimulatedTransport::new(clock(), vec![lost]).unwrap();
        let mut device = SimulatedTransport::new(inner, Vec::new()).unwrap();
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let mut is_fresh = |device: &mut SimulatedTransport<_>, time| {
            device.read(time, &mut points).map(|reading| reading == Reading::Fresh { time })
        };
        assert_eq!([0.0, 1.0].map(|t| is_fresh(&mut device, t)), [Ok(true), Ok(true)]);
        assert!(is_fresh(&mut device, 2.0).is_err());
        device.open().unwrap();
        assert_eq!([3.0, 4.0].map(|t| is_fresh(&mut device, t)), [Ok(true), Ok(true)]);
    }

    /// Once each tick came a period after the last one with its jitter, and drifted.
    #[test]
    fn jitter_of_a_device_that_paces_does_not_add_up() {
        let jitter = Fault { start: 0.0, duration: 1e9, kind: FaultKind::Jitter { most: 0.2 } };
        let device = SimulatedTransport::new(clock(), vec![jitter]).unwrap();
        let mut device = device.pacing_at(1.0).unwrap();
        for (tick, (_, x)) in (0..900).zip(reads(&mut device, 900)) {
            assert!((x - f64::from(tick)).abs() <= 0.2 + 1e-9, "{tick}: {x}");
        }
    }

    /// Once the reading after a late one was made before it.
    #[test]
    fn measurements_after_jitter_keep_their_order() {
        let jitter = [(10.0, 80.0, FaultKind::Jitter { most: 5.0 })];
        for seed in 0..20 {
            let mut device = with(&jitter).with_seed(seed);
            let came = reads(&mut device, 110);
            assert!(came.windows(2).all(|pair| pair[0].1 < pair[1].1), "{seed}");
            assert_eq!(came[100..], fresh(&(100..110).map(f64::from).collect::<Vec<_>>()));
        }
    }

    #[test]
    fn what_does_not_come_is_not_to_be_looked_at() {
        let mut device = with(&[(1.0, 1.0, FaultKind::Stale), (2.0, 1.0, FaultKind::NotReady)]);
        let came = reads(&mut device, 4);
        assert_eq!(
            came.iter().map(|(reading, _)| *reading).collect::<Vec<_>>(),
            [
                Reading::Fresh { time: 0.0 },
                Reading::Stale,
                Reading::NotReady,
                Reading::Fresh { time: 3.0 }
            ]
        );
        assert!(came[1].1.is_nan() && came[2].1.is_nan());
    }

    #[test]
    fn a_glitch_is_off_by_its_distance() {
        let mut device = with(&[(1.0, 1.0, FaultKind::Glitch { distance: -0.25 })]);
        let places: Vec<_> = reads(&mut device, 3).iter().map(|(_, x)| *x).collect();
        assert_eq!(places, [0.0, 0.75, 2.0]);
    }

    #[test]
    fn jitter_moves_measurements_and_their_times_alike() {
        let jitter = [(0.0, 1000.0, FaultKind::Jitter { most: 0.4 })];
        let (mut device, mut other) = (with(&jitter).with_seed(1), with(&jitter).with_seed(2));
        let (came, others) = (reads(&mut device, 900), reads(&mut other, 900));
        assert_ne!(came, others);
        assert_eq!(came, reads(&mut with(&jitter).with_seed(1), 900));
        let (mut sum, mut largest, mut last) = (0.0, 0.0_f64, -1.0);
        for (tick, (reading, x)) in came.into_iter().enumerate() {
            let Reading::Fresh { time } = reading else { panic!("{reading:?}") };
            let off = time - tick as f64;
            assert!((x - time.max(0.0)).abs() < 1e-9 && time > last && off.abs() <= 0.4);
            (sum, largest, last) = (sum + off, largest.max(off.abs()), time);
        }
        // A mean of 900 even numbers in ±0.4 has a standard deviation of 0.0077.
        assert!((sum / 900.0).abs() < 4.0 * 0.0077 && largest > 0.39);
    }

    #[test]
    fn a_pacing_device_has_a_time_of_its_own() {
        let mut device = with(&[(0.5, 0.25, FaultKind::Stale)]).pacing_at(4.0).unwrap();
        assert!(device.paces() && Device::rate(&device) == Some(4.0));
        let came = reads(&mut device, 5);
        assert_eq!(came[..2], fresh(&[0.0, 0.25]));
        assert_eq!((came[2].0, &came[3..]), (Reading::Stale, &fresh(&[0.75, 1.0])[..]));
        assert!(with(&[]).pacing_at(0.0).is_err() && !with(&[]).paces());
    }

    #[test]
    fn a_lost_device_answers_nothing_until_it_is_opened_often_enough() {
        let mut device = with(&[(1.0, 0.0, FaultKind::Lost { attempts: 2 })]);
        let mut points = [PointState::at_rest(Vector::ZERO)];
        device.read(0.5, &mut points).unwrap();
        device.write(&[Vector([1.0, 0.0, 0.0])]).unwrap();
        let error = device.read(1.5, &mut points).unwrap_err();
        assert_eq!(error.reason, "the plan of faults says so at 1.5 s");
        assert!(device.write(&[Vector::ZERO]).is_err() && device.close().is_err());
        assert!(device.open().is_err() && device.enable().is_err());
        device.open().unwrap();
        assert_eq!(device.read(2.0, &mut points).unwrap(), Reading::Fresh { time: 2.0 });
        assert_eq!(points[0].position, Vector([2.0, 0.0, 0.0]));
        let Calls { opened, failed, enabled, closed } = device.calls();
        assert_eq!((opened, failed, enabled, closed), (1, 1, 0, 1));
    }

    #[test]
    fn faults_that_cannot_be_are_refused_with_their_numbers() {
        let refused = |start, duration, kind| {
            let fault = Fault { start, duration, kind };
            SimulatedTransport::new(clock(), vec![fault]).unwrap_err().to_string()
        };
        let said = "start of a fault must be zero or more and finite, got -1 s";
        assert_eq!(refused(-1.0, 0.0, FaultKind::Stale), said);
        let said = "attempts must be at least 1, got 0";
        assert_eq!(refused(0.0, 0.0, FaultKind::Lost { attempts: 0 }), said);
        let said = "delay must be at most 10000 ticks, got 10001";
        assert_eq!(refused(0.0, 1.0, FaultKind::Delay { ticks: 10_001 }), said);
        assert!(refused(0.0, 1.0, FaultKind::Jitter { most: f64::NAN }).contains("NaN s"));
        let glitch = FaultKind::Glitch { distance: f64::INFINITY };
        assert!(refused(0.0, f64::NAN, glitch).starts_with("duration of a fault"));
    }
}
