// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A deadline each period, and how late it was met.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_haptics::{HapticsError, not_negative, positive};
use std::time::Duration;

use crate::clock::Clock;
use crate::run::ticks;
use crate::statistics::{Distribution, Times};

/// Warm-ups before a deadline: on a clock that stands still, they would never end.
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
    /// By more than a period.
    pub(crate) is_missed: bool,
}

impl Pacer {
    /// The first deadline is now.
    pub(crate) fn new(clock: &mut dyn Clock, rate: f64) -> Self {
        Self { period: Duration::from_secs_f64(1.0 / rate), deadline: clock.now() }
    }

    /// Waits as [`wait`](Self::wait). From `ahead` of the deadline on, `warm_up` is called again
    /// and again, as often as there is time for, but at most [`MOST_WARM_UPS`] times; and once even
    /// if it is late, which costs no more than what follows would cost for being cold.
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

    /// Waits for the next deadline. A deadline met more than a period late moves all later ones,
    /// so that nothing hurries after lost time.
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

pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// How late a loop without work wakes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Lateness {
    /// By how much; `None` if the loop had no tick.
    pub times: Option<Distribution>,
    /// Ticks more than a period late.
    pub missed: u64,
}

impl Lateness {
    /// Lets a loop without work run on `clock` at `rate` [Hz] for `duration` [s].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the rate is not positive or the duration negative.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_loop::{Lateness, VirtualClock};
    ///
    /// # fn main() -> Result<(), palpate_haptics::HapticsError> {
    /// let lateness = Lateness::measure(&mut VirtualClock::new(), 1000.0, 2.0)?;
    /// let times = lateness.times.expect("there are ticks");
    /// assert_eq!((times.count, times.max_ns, lateness.missed), (2000, 0, 0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn measure(
        clock: &mut dyn Clock,
        rate: f64,
        duration: f64,
    ) -> Result<Self, HapticsError> {
        let rate = positive("rate", rate, "Hz")?;
        let duration = not_negative("duration", duration, "s")?;
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
