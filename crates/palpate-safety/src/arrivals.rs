// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How the states of ticks come: late, after a time, or not at all.

use crate::error::SafetyError;
use palpate_device::{NumberError, Reading};

/// How far from a period the time between two readings still counts as one, as a part of it: times
/// are differences of sums, which rounding must not change.
const EVEN: f64 = 1e-6;

/// How the states of a tick came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// By how much the tick began too late [s].
    pub late: f64,
    /// The time between the last measurement and this one [s]; `None` if nothing was measured
    /// since.
    pub elapsed: Option<f64>,
    /// Whether there are states, new or old.
    pub is_ready: bool,
}

/// Times the states of ticks by what a loop tells of the next one.
///
/// ```
/// use palpate_device::Reading;
/// use palpate_safety::Arrivals;
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let mut arrivals = Arrivals::new(1000.0)?;
/// arrivals.set_reading(Reading::Fresh { time: 7.0 });
/// assert_eq!(arrivals.arrive().elapsed, Some(0.001)); // nothing is known of a time before
/// arrivals.set_reading(Reading::Fresh { time: 7.25 });
/// assert_eq!(arrivals.arrive().elapsed, Some(0.25));
/// arrivals.set_reading(Reading::Stale);
/// assert_eq!(arrivals.arrive().elapsed, None);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Arrivals {
    /// The duration of a tick [s].
    period: f64,
    /// By how much the next tick starts too late [s].
    late: f64,
    /// What was read for the next tick; `None` for states a period after those before.
    reading: Option<Reading>,
    /// When the last states were measured [s].
    measured: Option<f64>,
}

impl Arrivals {
    /// For ticks at `rate` [Hz].
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the rate is not positive and finite.
    pub fn new(rate: f64) -> Result<Self, SafetyError> {
        Ok(Self::with_period(1.0 / NumberError::check_rate(rate)?))
    }

    /// For ticks of a `period` [s] that was checked.
    #[must_use]
    pub fn with_period(period: f64) -> Self {
        Self { period, late: 0.0, reading: None, measured: None }
    }

    /// Sets by how much ticks start too late [s] from the next one on.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_late(&mut self, late: f64) {
        self.late = late;
    }

    /// Sets what was read for the next tick alone. Without it, its states were measured a period, and
    /// what the tick is late, after those before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_reading(&mut self, reading: Reading) {
        self.reading = Some(reading);
    }

    /// How the states of the tick that begins came.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn arrive(&mut self) -> Arrival {
        let late = self.late;
        let (elapsed, is_ready) = match self.reading.take() {
            None => (Some(self.period + late.max(0.0)), true),
            Some(Reading::Fresh { time }) => (self.since_measured(time), true),
            Some(Reading::Stale) => (None, true),
            Some(Reading::NotReady) => {
                self.measured = None;
                (Some(self.period), false)
            }
        };
        Arrival { late, elapsed, is_ready }
    }

    /// The time from the last measurement to the one at `time` [s]; `None` if `time` is not later.
    fn since_measured(&mut self, time: f64) -> Option<f64> {
        let before = self.measured;
        if time.is_finite() {
            self.measured = Some(time);
        }
        let Some(before) = before else { return self.measured.map(|_| self.period) };
        let elapsed = time - before;
        if (elapsed - self.period).abs() <= EVEN * self.period {
            return Some(self.period);
        }
        // Written so that NaN is no time.
        (elapsed > 0.0 && elapsed <= f64::MAX).then_some(elapsed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRESH: fn(f64) -> Option<Reading> = |time| Some(Reading::Fresh { time });

    fn arrivals(readings: &[Option<Reading>]) -> Vec<(Option<f64>, bool)> {
        let mut arrivals = Arrivals::new(1000.0).unwrap();
        let arrive = |reading: &Option<Reading>| {
            arrivals.reading = *reading;
            let arrival = arrivals.arrive();
            (arrival.elapsed, arrival.is_ready)
        };
        readings.iter().map(arrive).collect()
    }

    #[test]
    fn times_are_those_between_measurements() {
        let seen = arrivals(&[FRESH(7.0), FRESH(7.25), Some(Reading::Stale), FRESH(8.0)]);
        let times = [Some(0.001), Some(0.25), None, Some(0.75)];
        assert_eq!(seen, times.map(|time| (time, true)));
        assert_eq!(arrivals(&[None, None]), [(Some(0.001), true); 2]);
    }

    #[test]
    fn a_rounded_period_is_a_period() {
        let readings: Vec<_> = (0..5000).map(|k| FRESH(f64::from(k) / 1000.0)).collect();
        assert!(arrivals(&readings).iter().all(|seen| *seen == (Some(0.001), true)));
        let [_, seen] = arrivals(&[FRESH(0.0), FRESH(0.001_01)])[..] else { unreachable!() };
        assert_eq!(seen.0, Some(0.001_01));
    }

    #[test]
    fn a_time_that_is_not_later_is_stale_and_begins_anew() {
        let seen = arrivals(&[FRESH(5.0), FRESH(5.0), FRESH(1.0), FRESH(1.5), FRESH(f64::NAN)]);
        let times = [Some(0.001), None, None, Some(0.5), None];
        assert_eq!(seen, times.map(|time| (time, true)));
    }

    #[test]
    fn a_device_that_was_not_ready_may_begin_with_another_time() {
        let seen = arrivals(&[FRESH(5.0), Some(Reading::NotReady), FRESH(1.0), FRESH(1.5)]);
        let period = Some(0.001);
        assert_eq!(seen, [(period, true), (period, false), (period, true), (Some(0.5), true)]);
    }
}
