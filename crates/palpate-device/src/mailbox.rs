// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device whose positions another thread sets, and whose forces it takes.

use crate::error::DeviceError;
use crate::latest::{LatestReader, LatestWriter, latest_value};
use crate::{
    Buttons, Device, DeviceLost, DeviceProfile, GripperState, PointState, Reading, TurnState,
};
use palpate_field::Vector;
use std::time::Duration;

/// A device whose driver runs in another thread or another language, where a call from the
/// servo's thread would come too late.
///
/// The driver [sets](Mailbox::set) where the points are and [takes](Mailbox::forces) the newest
/// forces, as often as it likes; the servo never waits for it. Before the first states the device is
/// [not ready](Reading::NotReady), and a tick that finds none that are new has a
/// [stale](Reading::Stale) reading, which holds the force for some ticks. A driver that sets states
/// less often than a servo of 1 kHz takes them tells [how often](Self::with_rate): the servo ticks as
/// often then, with the stiffness that this rate allows. One that sets less than half of what the
/// servo takes would get no force; after half a second the device is lost, and the error names both
/// rates.
///
/// Each side watches the other. A driver that sets nothing for longer than its
/// [`patience`](Self::with_patience) has died: the device is lost, until it is opened again and the
/// driver sets new states. If [`ticks`](Mailbox::ticks) stop growing, the servo hangs, and the driver
/// must set its motors to zero.
///
/// # Examples
///
/// ```
/// use palpate_device::{Device, DeviceProfile, MailboxDevice, PointState, Reading};
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let profile = DeviceProfile { max_force: 4.0, ..DeviceProfile::unlimited("of my own") };
/// let (mut device, mut mailbox) = MailboxDevice::new(profile, 1)?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// assert_eq!(device.read(0.0, &mut points)?, Reading::NotReady); // in the servo's thread
/// mailbox.set(&[PointState::at_rest(Vector([0.0, 0.1, 0.0]))])?; // from any thread
/// assert_eq!(device.read(0.001, &mut points)?, Reading::Fresh { time: 0.001 });
/// assert_eq!(points[0].position, Vector([0.0, 0.1, 0.0]));
/// assert_eq!(device.read(0.002, &mut points)?, Reading::Stale);
/// device.write(&[Vector([0.0, 2.0, 0.0])])?;
/// assert_eq!(mailbox.forces(), [Vector([0.0, 2.0, 0.0])]);
/// assert_eq!(mailbox.ticks(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct MailboxDevice {
    profile: DeviceProfile,
    points: usize,
    rate: Option<f64>,
    /// The longest time that the driver's device watches for; `None` if it does not.
    watchdog: Option<Duration>,
    messages: LatestReader<Message>,
    /// The last message that was new, and when it came [s].
    seen: Option<(u64, f64)>,
    /// The message at which the device was lost: it and those before are old.
    lost: u64,
    turn: Option<TurnState>,
    buttons: Buttons,
    gripper: Option<GripperState>,
    /// The time for which the driver may set nothing [s]; `None` for that of its rate.
    patience: Option<f64>,
    pace: Pace,
    orders: Orders,
    sent: LatestWriter<Orders>,
}

/// The driver's end of a [`MailboxDevice`].
#[derive(Debug)]
pub struct Mailbox {
    message: Message,
    messages: LatestWriter<Message>,
    orders: LatestReader<Orders>,
}

/// What the driver says of its device.
#[derive(Clone, Debug)]
struct Message {
    /// How many messages were sent, with this one.
    number: u64,
    /// When the states were measured [s]; `None` for when the servo takes them.
    time: Option<f64>,
    points: Vec<PointState>,
    turn: Option<TurnState>,
    buttons: Buttons,
    gripper: Option<GripperState>,
    is_ready: bool,
    is_lost: bool,
}

/// What the servo wants of the device.
#[derive(Clone, Debug)]
struct Orders {
    /// How often the servo has written forces.
    ticks: u64,
    forces: Vec<Vector<f64, 3>>,
    torque: Vector<f64, 3>,
    gripper_force: f64,
    is_enabled: bool,
    watchdog: Option<Duration>,
}

impl MailboxDevice {
    /// How long the driver may set nothing unless [`with_patience`](Self::with_patience) says
    /// otherwise [s]; at a [rate](Self::with_rate) below 50 Hz five periods, which are longer.
    pub const PATIENCE: f64 = 0.1;

    /// How many periods the driver may set nothing at a low rate: a thread that sleeps between its
    /// states is late by a period or two.
    const PATIENT_PERIODS: f64 = 5.0;

    /// A device with so many contact points, and its driver's end.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there are none.
    pub fn new(profile: DeviceProfile, points: usize) -> Result<(Self, Mailbox), DeviceError> {
        if points == 0 {
            return Err(DeviceError::NoContactPoint);
        }
        let message = Message {
            number: 0,
            time: None,
            points: vec![PointState::at_rest(Vector::ZERO); points],
            turn: None,
            buttons: Buttons::NONE,
            gripper: None,
            is_ready: false,
            is_lost: false,
        };
        let orders = Orders {
            ticks: 0,
            forces: vec![Vector::ZERO; points],
            torque: Vector::ZERO,
            gripper_force: 0.0,
            is_enabled: false,
            watchdog: None,
        };
        let (send_messages, messages) = latest_value(message.clone());
        let (sent, taken) = latest_value(orders.clone());
        let mailbox = Mailbox { message, messages: send_messages, orders: taken };
        let device = Self {
            profile,
            points,
            rate: None,
            watchdog: None,
            messages,
            seen: None,
            lost: 0,
            turn: None,
            buttons: Buttons::NONE,
            gripper: None,
            patience: None,
            pace: Pace::default(),
            orders,
            sent,
        };
        Ok((device, mailbox))
    }

    /// The device with another time for which the driver may set nothing [s], infinite for a
    /// driver that only sets what changes, whose rate is not watched. The servo's ticks measure that
    /// time.
    #[must_use]
    pub fn with_patience(self, patience: f64) -> Self {
        Self { patience: Some(patience), ..self }
    }

    /// The device with so many states a second [Hz], as [`Device::rate`] tells the servo: needed of a
    /// driver that sets fewer than 1000.
    ///
    /// ```
    /// use palpate_device::{Device, DeviceProfile, MailboxDevice};
    ///
    /// // From the frames of a game.
    /// let (device, _mailbox) = MailboxDevice::new(DeviceProfile::unlimited("of my own"), 1)?;
    /// assert_eq!(device.with_rate(90.0).rate(), Some(90.0));
    /// # Ok::<(), palpate_device::DeviceError>(())
    /// ```
    #[must_use]
    pub fn with_rate(self, rate: f64) -> Self {
        Self { rate: Some(rate), ..self }
    }

    /// The device with a watchdog that waits for at most this time. The driver sets the time that
    /// [`Mailbox::watchdog`] asks for.
    #[must_use]
    pub fn with_watchdog(self, longest: Duration) -> Self {
        Self { watchdog: Some(longest), ..self }
    }

    /// The time for which the driver may set nothing [s].
    fn patience(&self) -> f64 {
        let of_rate = |rate: f64| (Self::PATIENT_PERIODS / rate).max(Self::PATIENCE);
        self.patience.unwrap_or_else(|| self.rate.map_or(Self::PATIENCE, of_rate))
    }

    /// The device is lost as of the message of this number.
    fn lose(&mut self, number: u64, reason: impl Into<String>) -> DeviceLost {
        (self.lost, self.pace) = (number, Pace::default());
        DeviceLost { reason: reason.into() }
    }

    /// Sends the orders to the driver.
    fn send(&mut self) {
        let orders = &self.orders;
        self.sent.set(|sent| {
            sent.forces.clone_from_slice(&orders.forces);
            sent.ticks = orders.ticks;
            sent.torque = orders.torque;
            sent.gripper_force = orders.gripper_force;
            sent.is_enabled = orders.is_enabled;
            sent.watchdog = orders.watchdog;
        });
    }
}

impl Mailbox {
    /// Sets where every point is and how fast it moves, in the coordinates of the device, as of when
    /// the servo takes it.
    ///
    /// # Errors
    ///
    /// [`DeviceError::OneForEach`] if there is not one state for each point.
    pub fn set(&mut self, states: &[PointState]) -> Result<(), DeviceError> {
        self.send(None, states)
    }

    /// As [`set`](Self::set), measured at `time` [s] on a clock that runs evenly: velocities and
    /// energies are exact then, whenever the servo takes the states. A driver tells the times of all
    /// its states or of none.
    ///
    /// # Errors
    ///
    /// As [`set`](Self::set).
    pub fn set_at(&mut self, time: f64, states: &[PointState]) -> Result<(), DeviceError> {
        self.send(Some(time), states)
    }

    /// Sets the orientation and the angular velocity of a device with rotation, from the next
    /// [`set`](Self::set) on.
    pub fn set_turn(&mut self, turn: TurnState) {
        self.message.turn = Some(turn);
    }

    /// Sets the buttons that are held down, from the next [`set`](Self::set) on.
    pub fn set_buttons(&mut self, buttons: Buttons) {
        self.message.buttons = buttons;
    }

    /// Sets the gripper of a device that has one, from the next [`set`](Self::set) on.
    pub fn set_gripper(&mut self, gripper: GripperState) {
        self.message.gripper = Some(gripper);
    }

    /// Says that the device has no state until the next [`set`](Self::set): it is homing, or
    /// calibrating. It must be said again before the [patience](MailboxDevice::with_patience) is
    /// over.
    pub fn set_not_ready(&mut self) {
        self.message.is_ready = false;
        self.publish();
    }

    /// Says that the device is lost, until the next [`set`](Self::set): the servo stops in its next
    /// tick, or waits until the device can be opened again.
    pub fn lose(&mut self) {
        self.message.is_lost = true;
        self.publish();
    }

    /// The newest forces on the hand [N], one for each point; empty before the first tick.
    #[must_use]
    pub fn forces(&mut self) -> &[Vector<f64, 3>] {
        let orders = self.orders.latest().filter(|orders| orders.ticks > 0);
        orders.map_or(&[], |orders| &orders.forces)
    }

    /// How often the servo has written forces. At 1 kHz, a number that does not change for 10 ms
    /// means that the servo's thread hangs, and that the motors must be set to zero: the last
    /// forces stay in the mailbox.
    #[must_use]
    pub fn ticks(&mut self) -> u64 {
        self.orders.latest().map_or(0, |orders| orders.ticks)
    }

    /// The newest torque on the hand [N·m], zero for a device without rotation.
    #[must_use]
    pub fn torque(&mut self) -> Vector<f64, 3> {
        self.orders.latest().map_or(Vector::ZERO, |orders| orders.torque)
    }

    /// The newest force on the fingers in the gripper [N], zero for a device without one.
    #[must_use]
    pub fn gripper_force(&mut self) -> f64 {
        self.orders.latest().map_or(0.0, |orders| orders.gripper_force)
    }

    /// Whether the motors are to be on: from the start of a run to its end.
    #[must_use]
    pub fn is_enabled(&mut self) -> bool {
        self.orders.latest().is_some_and(|orders| orders.is_enabled)
    }

    /// The time to which the device's watchdog is to be set; `None` before a run, and for a device
    /// [without one](MailboxDevice::with_watchdog).
    #[must_use]
    pub fn watchdog(&mut self) -> Option<Duration> {
        self.orders.latest().and_then(|orders| orders.watchdog)
    }

    fn send(&mut self, time: Option<f64>, states: &[PointState]) -> Result<(), DeviceError> {
        let message = &mut self.message;
        let points = message.points.len();
        if states.len() != points {
            let (items, given) = ("states", states.len());
            return Err(DeviceError::OneForEach { items, given, points });
        }
        message.points.clone_from_slice(states);
        message.time = time;
        (message.is_ready, message.is_lost) = (true, false);
        self.publish();
        Ok(())
    }

    fn publish(&mut self) {
        self.message.number += 1;
        let Message { number, time, points, turn, buttons, gripper, is_ready, is_lost } =
            &self.message;
        self.messages.set(|message| {
            message.points.clone_from_slice(points);
            (message.number, message.time, message.turn) = (*number, *time, *turn);
            (message.buttons, message.gripper) = (*buttons, *gripper);
            (message.is_ready, message.is_lost) = (*is_ready, *is_lost);
        });
    }
}

/// How often the driver sets states, beside how often the servo takes them.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    /// When the watch began, with the first states [s].
    since: Option<f64>,
    /// Ticks since then.
    ticks: u32,
    /// States that came since then.
    states: u32,
    /// Ticks since the last states.
    gap: u32,
    /// The sum of the gaps between states, in ticks, each of [`LONGEST_GAP`](Self::LONGEST_GAP) at
    /// most.
    gaps: u32,
}

/// A driver that sets states too seldom for the servo.
#[derive(Clone, Copy, Debug)]
struct TooSlow {
    /// States a second [Hz].
    driver: f64,
    /// Ticks a second [Hz].
    servo: f64,
}

impl Pace {
    /// The time over which the driver is watched [s]: a machine that is busy for a moment is not slow.
    const WATCHED: f64 = 0.5;

    /// The fewest gaps by which a driver is judged.
    const FEWEST: u32 = 6;

    /// The longest gap that counts, in ticks: one pause does not make a driver slow.
    const LONGEST_GAP: u32 = 4;

    /// The largest mean of the gaps, in ticks. A device of half the servo's rate keeps its force;
    /// what is more than that is jitter.
    const MOST: f64 = 2.1;

    /// One tick with states, at `time` [s]. `Some` if the driver was too slow for as long as it is
    /// watched.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn tick(&mut self, time: f64, is_new: bool) -> Option<TooSlow> {
        let Some(since) = self.since else {
            self.since = Some(time);
            return None;
        };
        self.ticks += 1;
        self.gap += 1;
        if !is_new {
            return None;
        }
        self.states += 1;
        self.gaps += std::mem::take(&mut self.gap).min(Self::LONGEST_GAP);
        let watched = time - since;
        if watched < Self::WATCHED || self.states < Self::FEWEST {
            return None;
        }
        let of = |count: u32| f64::from(count) / watched;
        let found = TooSlow { driver: of(self.states), servo: of(self.ticks) };
        let is_slow = f64::from(self.gaps) > Self::MOST * f64::from(self.states);
        *self = Self { since: Some(time), ..Self::default() };
        is_slow.then_some(found)
    }
}

impl std::fmt::Display for TooSlow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { driver, servo } = self;
        write!(
            f,
            "its driver sets {driver:.0} states a second, but the servo takes {servo:.0}, and would \
             give no force: tell the mailbox its rate, `with_rate({driver:.1})`, or in Python \
             `Mailbox(…, rate={driver:.0})`"
        )
    }
}

/// Copies as many states as both have.
fn write_states(points: &mut [PointState], states: &[PointState]) {
    for (point, state) in points.iter_mut().zip(states) {
        *point = *state;
    }
}

impl Device for MailboxDevice {
    fn points(&self) -> usize {
        self.points
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Real-time: allocates nothing until the device is lost, takes no lock, cannot panic.
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        let Some(message) = self.messages.latest() else { return Ok(Reading::NotReady) };
        let number = message.number;
        if number <= self.lost {
            return Ok(Reading::NotReady);
        }
        if message.is_lost {
            return Err(self.lose(number, SAYS_SO));
        }
        write_states(points, &message.points);
        (self.turn, self.buttons, self.gripper) =
            (message.turn, message.buttons, message.gripper);
        let (is_ready, measured) = (message.is_ready, message.time.unwrap_or(time));
        let is_new = self.seen.is_none_or(|(seen, _)| seen != number);
        if is_new {
            self.seen = Some((number, time));
        }
        let since = self.seen.map_or(0.0, |(_, since)| time - since);
        let patience = self.patience();
        // NaN counts as no patience.
        let is_patient = since <= patience;
        if !is_patient {
            return Err(self.lose(number, "its driver sets nothing any more"));
        }
        if !is_ready {
            self.pace = Pace::default();
        } else if patience < f64::INFINITY
            && let Some(slow) = self.pace.tick(time, is_new)
        {
            return Err(self.lose(number, slow.to_string()));
        }
        Ok(match (is_ready, is_new) {
            (false, _) => Reading::NotReady,
            (true, true) => Reading::Fresh { time: measured },
            (true, false) => Reading::Stale,
        })
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.orders.ticks += 1;
        for (written, force) in self.orders.forces.iter_mut().zip(forces) {
            *written = *force;
        }
        self.send();
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        Ok(self.turn)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.orders.torque = torque;
        self.send();
        Ok(())
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn buttons(&mut self) -> Buttons {
        self.buttons
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read_gripper(&mut self) -> Result<Option<GripperState>, DeviceLost> {
        Ok(self.gripper)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write_gripper_force(&mut self, force: f64) -> Result<(), DeviceLost> {
        self.orders.gripper_force = force;
        self.send();
        Ok(())
    }

    /// Refuses to open while the driver says that the device is lost.
    fn open(&mut self) -> Result<(), DeviceLost> {
        let is_lost = self.messages.latest().is_some_and(|message| message.is_lost);
        if is_lost { Err(DeviceLost::new(SAYS_SO)) } else { Ok(()) }
    }

    fn set_watchdog(&mut self, time: Duration) -> Result<Option<Duration>, DeviceLost> {
        self.orders.watchdog = self.watchdog.map(|longest| longest.min(time));
        self.send();
        Ok(self.orders.watchdog)
    }

    fn enable(&mut self) -> Result<(), DeviceLost> {
        self.orders.is_enabled = true;
        self.send();
        Ok(())
    }

    fn close(&mut self) -> Result<(), DeviceLost> {
        self.orders.is_enabled = false;
        self.send();
        Ok(())
    }
}

/// Why a device is lost whose driver lost it.
const SAYS_SO: &str = "its driver says so";
