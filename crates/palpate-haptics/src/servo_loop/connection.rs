// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The connection of a loop to its device: opened, lost, opened again, closed.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::{Device, DeviceLost, NumberError, Reading};
use palpate_safety::Arrivals;
use std::time::Duration;

/// The time after which a device is to take its forces away when nothing is written to it: longer
/// than a tick that is late on a busy machine, and so short that a hand is not thrown far. The
/// longest that a device counts may be shorter: a byte of 125 µs holds 31.875 ms.
const WATCHDOG: Duration = Duration::from_millis(30);

/// The least time in periods: a device that took the force away between two ticks would buzz.
const WATCHDOG_PERIODS: f64 = 10.0;

/// How a loop goes on when its device is lost: ticks go on without force, and the loop opens the
/// device again at intervals. When it is found, forces rise from zero.
///
/// ```
/// use palpate_haptics::servo_loop::Reconnection;
///
/// let reconnection = Reconnection::every(0.5)?.with_patience(30.0)?;
/// assert_eq!((reconnection.interval(), reconnection.patience()), (0.5, 30.0));
/// # Ok::<(), palpate_device::NumberError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconnection {
    interval: f64,
    patience: f64,
}

impl Reconnection {
    /// Opens a lost device again every `interval` [s] of the servo's time, for as long as the run
    /// lasts.
    ///
    /// # Errors
    ///
    /// If the interval is not positive and finite.
    pub fn every(interval: f64) -> Result<Self, NumberError> {
        let interval = NumberError::check_positive("interval", interval, "s")?;
        Ok(Self { interval, patience: f64::INFINITY })
    }

    /// The same, but a device that is lost for longer than `patience` [s] ends the run.
    ///
    /// # Errors
    ///
    /// If the time is negative or NaN.
    pub fn with_patience(self, patience: f64) -> Result<Self, NumberError> {
        Ok(Self {
            patience: NumberError::check_zero_or_more("patience", patience, "s")?,
            ..self
        })
    }

    /// The time between two attempts [s].
    #[must_use]
    pub const fn interval(&self) -> f64 {
        self.interval
    }

    /// The longest time without the device [s].
    #[must_use]
    pub const fn patience(&self) -> f64 {
        self.patience
    }
}

/// What a run saw of the connection to its device.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ConnectionReport {
    /// The time after which the device takes its forces away by itself when the program dies [s];
    /// `None` for a device that does not.
    pub watchdog: Option<f64>,
    /// Ticks in which the device gave nothing new.
    pub stale_ticks: u64,
    /// Ticks in which the device had no state.
    pub not_ready_ticks: u64,
    /// The longest time between two measurements [s].
    pub longest_gap: f64,
    /// How often the device was lost.
    pub losses: u64,
    /// How often it was found again.
    pub reconnections: u64,
    /// The time without the device [s].
    pub lost_time: f64,
    /// Why it was lost the last time, or not found again; `None` if it never was.
    pub last_loss: Option<String>,
    /// Why the device was not closed; `None` if it was, or was not open.
    pub not_closed: Option<String>,
}

impl ConnectionReport {
    /// Whether something went wrong.
    pub(crate) fn is_troubled(&self) -> bool {
        let quiet =
            Self { watchdog: self.watchdog, longest_gap: self.longest_gap, ..Self::default() };
        *self != quiet
    }
}

/// Whether a loop has its device.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Before it was opened, and after it was closed.
    Closed,
    Open,
    /// Lost at a time, and to be opened again at another [s].
    Lost {
        since: f64,
        next: f64,
    },
}

/// The connection of a loop to its device.
#[derive(Debug)]
pub(crate) struct Connection {
    state: State,
    /// Whether there is something to close.
    is_held: bool,
    was_opened: bool,
    reconnection: Option<Reconnection>,
    period: f64,
    /// The time without a measurement [s], in ticks of a period.
    gap: f64,
    /// Times the measurements, as the servo does.
    arrivals: Arrivals,
    report: ConnectionReport,
}

impl Connection {
    pub(crate) fn new(rate: f64, reconnection: Option<Reconnection>) -> Self {
        let (state, period, gap) = (State::Closed, 1.0 / rate, 0.0);
        let report = ConnectionReport::default();
        let (is_held, was_opened, arrivals) = (false, false, Arrivals::with_period(period));
        Self { state, is_held, was_opened, reconnection, period, gap, arrivals, report }
    }

    pub(crate) fn is_open(&self) -> bool {
        self.state == State::Open
    }

    /// Whether a device that is lost is opened again.
    pub(crate) fn reconnects(&self) -> bool {
        self.reconnection.is_some()
    }

    /// Whether the device was open once, so that it may hold forces.
    pub(crate) fn was_opened(&self) -> bool {
        self.was_opened
    }

    /// Whether the device is lost, and is to be opened again at `time` [s].
    pub(crate) fn is_due(&self, time: f64) -> bool {
        // A tick that rounding puts before its time counts.
        let time = time + 0.5 * self.period;
        matches!(self.state, State::Lost { next, .. } if time >= next)
    }

    /// Opens a device at `time` [s], and enables it if it `fits`.
    pub(crate) fn open(
        &mut self,
        device: &mut dyn Device,
        time: f64,
        fits: impl FnOnce(&dyn Device) -> Result<(), DeviceLost>,
    ) -> Result<(), DeviceLost> {
        device.open()?;
        self.is_held = true;
        self.was_opened = true;
        fits(device)?;
        let least = Duration::from_secs_f64(WATCHDOG_PERIODS * self.period);
        let watchdog = device.set_watchdog(WATCHDOG.max(least));
        let watchdog = watchdog.and_then(|watchdog| device.enable().map(|()| watchdog));
        self.report.watchdog = watchdog?.map(|time| time.as_secs_f64());
        if let State::Lost { since, .. } = std::mem::replace(&mut self.state, State::Open) {
            self.report.reconnections += 1;
            self.report.lost_time += time - since;
        }
        Ok(())
    }

    /// Takes note that the device was lost, or not found, at `time` [s], and lets it go.
    ///
    /// # Errors
    ///
    /// The loss, if the loop is not to reconnect, or not any more.
    pub(crate) fn lose(
        &mut self,
        device: &mut dyn Device,
        lost: DeviceLost,
        time: f64,
    ) -> Result<(), DeviceLost> {
        let since = match self.state {
            State::Lost { since, .. } => since,
            State::Closed | State::Open => {
                self.report.losses += 1;
                time
            }
        };
        self.report.last_loss = Some(lost.reason.clone());
        let Some(reconnection) = self.reconnection.filter(|r| time - since <= r.patience)
        else {
            self.end_at(since, time);
            return Err(lost);
        };
        if std::mem::take(&mut self.is_held) {
            // A device that is gone need not answer; that it is lost is in the report.
            drop(device.close());
        }
        self.state = State::Lost { since, next: time + reconnection.interval };
        Ok(())
    }

    /// Closes the device, as far as it is open.
    pub(crate) fn close(&mut self, device: &mut dyn Device) {
        if std::mem::take(&mut self.is_held) {
            self.state = State::Closed;
            self.report.not_closed = device.close().err().map(|lost| lost.reason);
        }
    }

    /// Takes note of what a tick read. Returns the time between the last two measurements [s]; `None`
    /// without a new one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn see(&mut self, reading: Reading) -> Option<f64> {
        self.arrivals.set_reading(reading);
        let arrival = self.arrivals.arrive();
        if !arrival.is_ready {
            self.report.not_ready_ticks += u64::from(self.is_open());
            self.gap = 0.0;
            return None;
        }
        let elapsed = arrival.elapsed;
        let gap = elapsed.unwrap_or(self.gap + self.period);
        self.gap = if elapsed.is_some() { 0.0 } else { gap };
        self.report.stale_ticks += u64::from(elapsed.is_none());
        self.report.longest_gap = self.report.longest_gap.max(gap);
        elapsed
    }

    /// The report of a run that ended at `time` [s].
    pub(crate) fn report(mut self, time: f64) -> ConnectionReport {
        if let State::Lost { since, .. } = self.state {
            self.end_at(since, time);
        }
        self.report
    }

    fn end_at(&mut self, since: f64, time: f64) {
        self.report.lost_time += time - since;
        if let State::Lost { .. } = self.state {
            self.state = State::Closed;
        }
    }
}
