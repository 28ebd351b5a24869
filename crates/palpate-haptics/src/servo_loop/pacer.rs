// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The pace of a loop, and its priority.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Duration;

use palpate_device::{Device, NumberError, Reading};
use thread_priority::{ThreadPriority, thread_native_id};

use super::clock::Clock;
use super::statistics::{Distribution, Times};
use crate::HapticsError;

/// The pace of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// In real time, at the servo's rate on the clock.
    #[default]
    RealTime,
    /// At the pace of a device that [sets it](palpate_device::Device::paces): each tick begins when the
    /// device was measured, and is as late as the time since the last measurement exceeds a period.
    /// The servo's time is that of the measurements.
    Device,
    /// Without waiting between ticks; the servo's time advances by a period a tick as in real
    /// time.
    AsFastAsPossible,
}

impl Pace {
    /// The pace in real time of a device: its own, if it sets one.
    pub(crate) fn of(device: &dyn Device) -> Self {
        if device.paces() { Self::Device } else { Self::RealTime }
    }

    /// Refuses a device that sets the pace if this is another, and one that does not if it should.
    pub(crate) fn check(self, device: &dyn Device) -> Result<(), HapticsError> {
        let is_device = device.paces();
        if is_device == (self == Self::Device) {
            Ok(())
        } else {
            Err(HapticsError::Pace { is_device })
        }
    }
}

/// The most warm-ups before a deadline: on a clock that stands still, they would never end.
const MOST_WARM_UPS: u32 = 64;

/// Waits for deadlines a period apart.
#[derive(Debug)]
pub(crate) struct Pacer {
    period: Duration,
    deadline: Duration,
}

/// How late a deadline was met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Late {
    pub(crate) ns: u64,
    /// Whether the deadline was missed by more than a period.
    pub(crate) is_missed: bool,
}

impl Pacer {
    /// A pacer whose first deadline is now.
    pub(crate) fn new(clock: &mut dyn Clock, rate: f64) -> Self {
        Self { period: Duration::from_secs_f64(1.0 / rate), deadline: clock.now() }
    }

    /// Waits as [`wait`](Self::wait), and calls `warm_up` repeatedly from the time `ahead`
    /// before the deadline, at most [`MOST_WARM_UPS`] times. A late tick is warmed up once,
    /// which costs no more than running it with cold caches.
    pub(crate) fn wait_warm(
        &mut self,
        clock: &mut dyn Clock,
        ahead: Duration,
        mut warm_up: impl FnMut(),
    ) -> Late {
        clock.wait_until(self.deadline.saturating_sub(ahead));
        for _ in 0..MOST_WARM_UPS {
            let start = clock.now();
            warm_up();
            let end = clock.now();
            if end + (end.saturating_sub(start)) >= self.deadline {
                break;
            }
        }
        self.wait(clock)
    }

    /// Waits for the next deadline. A deadline met more than a period late shifts all later
    /// ones, so that the loop does not hurry to catch up.
    pub(crate) fn wait(&mut self, clock: &mut dyn Clock) -> Late {
        clock.wait_until(self.deadline);
        let late = clock.now().saturating_sub(self.deadline);
        let is_missed = late > self.period;
        if is_missed {
            self.deadline += late;
        }
        self.deadline += self.period;
        Late { ns: nanoseconds(late), is_missed }
    }
}

impl Pacer {
    /// Lets the next deadline be a period from now.
    pub(crate) fn restart(&mut self, clock: &mut dyn Clock) {
        self.deadline = clock.now() + self.period;
    }
}

/// Follows the ticks of a device that sets the pace.
#[derive(Debug)]
pub(crate) struct Follower {
    period: f64,
    /// When the tick before began, on the loop's clock.
    last: Option<Duration>,
    /// The time of the ticks since the last measurement, which had none [s].
    passed: f64,
}

/// A tick of a device that sets the pace.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Followed {
    pub(crate) late: Late,
    /// The time since the tick before [s].
    pub(crate) time: f64,
}

impl Follower {
    pub(crate) fn new(rate: f64) -> Self {
        Self { period: 1.0 / rate, last: None, passed: 0.0 }
    }

    /// A tick that begins now, with a measurement `elapsed` after the last one [s], or without one.
    /// The time of ticks without any state is that of no measurement.
    /// It is late by the clock or by the times of the measurements, whichever says more: a clock in
    /// a test may stand still.
    pub(crate) fn follow(
        &mut self,
        clock: &mut dyn Clock,
        elapsed: Option<f64>,
        reading: Reading,
    ) -> Followed {
        let now = clock.now();
        let Some(last) = self.last.replace(now) else {
            return Followed { late: Late { ns: 0, is_missed: false }, time: 0.0 };
        };
        let waited = now.saturating_sub(last).as_secs_f64();
        let time = match elapsed {
            Some(elapsed) => (elapsed - std::mem::take(&mut self.passed)).max(0.0),
            None => {
                let time = waited.max(self.period);
                self.passed = if reading.has_state() { self.passed + time } else { 0.0 };
                time
            }
        };
        let late = (waited.max(time) - self.period).max(0.0);
        let late = Duration::try_from_secs_f64(late).unwrap_or(Duration::MAX);
        let is_missed = late.as_secs_f64() > self.period;
        Followed { late: Late { ns: nanoseconds(late), is_missed }, time }
    }
}

/// The number of ticks in `duration` [s], rounded, so that 10 s at 1 kHz are 10 000 ticks in
/// spite of rounding.
pub(crate) fn ticks(duration: f64, rate: f64) -> u64 {
    (duration * rate).round() as u64
}

pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// How late an idle loop wakes.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Lateness {
    /// The distribution of lateness; `None` if the loop had no tick.
    pub times: Option<Distribution>,
    /// Ticks more than a period late.
    pub missed: u64,
}

impl Lateness {
    /// Runs an idle loop on `clock` at `rate` [Hz] for `duration` [s].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the rate is not positive or the duration negative.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_haptics::servo_loop::{Lateness, VirtualClock};
    ///
    /// # fn main() -> Result<(), palpate_haptics::HapticsError> {
    /// let lateness = Lateness::measure(&mut VirtualClock::new(), 1000.0, 2.0)?;
    /// let times = lateness.times.expect("there are ticks");
    /// assert_eq!((times.count, times.max, lateness.missed), (2000, 0.0, 0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn measure(
        clock: &mut dyn Clock,
        rate: f64,
        duration: f64,
    ) -> Result<Self, HapticsError> {
        let rate = NumberError::check_rate(rate)?;
        let duration = NumberError::check_not_negative("duration", duration, "s")?;
        let mut pacer = Pacer::new(clock, rate);
        let mut times = Times::new();
        let mut missed = 0;
        for _ in 0..ticks(duration, rate) {
            let late = pacer.wait(clock);
            times.record(late.ns);
            missed += u64::from(late.is_missed);
        }
        Ok(Self { times: times.distribution(), missed })
    }
}

/// The requested real-time priority, in percent of the range: below the system's own watchdogs,
/// above its interrupt threads.
#[cfg(unix)]
const PERCENT: u8 = 70;

/// Whether a thread is scheduled before others.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Priority {
    /// The normal priority; no other was requested.
    Normal,
    /// A raised priority.
    Raised,
    /// The system refused a raised priority.
    Refused {
        /// The error of the operating system.
        reason: String,
    },
}

/// Requests that the system schedules this thread before others: with the POSIX policy first
/// in, first out where it exists, with the highest priority of the thread's class elsewhere.
///
/// Linux grants the request to processes with the capability `CAP_SYS_NICE` or a limit `rtprio`
/// (in `/etc/security/limits.conf`).
#[must_use]
pub fn raise_priority() -> Priority {
    match ask() {
        Ok(()) => Priority::Raised,
        Err(error) => Priority::Refused { reason: described(&error) },
    }
}

#[cfg(unix)]
fn ask() -> Result<(), thread_priority::Error> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy,
    };
    let percent = ThreadPriorityValue::try_from(PERCENT).unwrap_or_default();
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let thread = thread_native_id();
    set_thread_priority_and_policy(thread, ThreadPriority::Crossplatform(percent), policy)
        // Some systems have a shorter range.
        .or_else(|_| set_thread_priority_and_policy(thread, ThreadPriority::Max, policy))
}

#[cfg(not(unix))]
fn ask() -> Result<(), thread_priority::Error> {
    thread_priority::set_thread_priority(thread_native_id(), ThreadPriority::Max)
}

fn described(error: &thread_priority::Error) -> String {
    match error {
        thread_priority::Error::OS(code) => {
            std::io::Error::from_raw_os_error(*code).to_string()
        }
        other => format!("{other:?}"),
    }
}
