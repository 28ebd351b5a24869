// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Velocities, and when readings arrive.
//!
//! The velocity of a device point, estimated from quantised positions.
//!
//! F. Janabi-Sharifi, V. Hayward, C.-S. J. Chen, "Discrete-time adaptive windowing for velocity
//! estimation" (2000): the first-order adaptive window, fitted to its ends.

use palpate_device::{NumberError, Reading};
use palpate_field::{Point, Vector};

use crate::error::SafetyError;

/// The longest window, in readings. A longer window would reduce noise at constant speed only.
const LONGEST: usize = 16;

/// Tolerance on the encoder step, as a part of it: quantised positions may lie exactly one step
/// off a line, and rounding must not decide.
const SLACK: f64 = 1e-6;

/// Velocity over the longest window in which the positions lie on a straight line.
///
/// With positions `x_k` read at the times `t_k`, an encoder step `Δ` and a window of `n` readings,
///
/// ```text
/// v = (x_k − x_{k−n}) / (t_k − t_{k−n})
/// ```
///
/// where `n ≤ 16` is the largest such that, for it and every shorter window, no position in the
/// window is more than `Δ` from the line through its ends, on any axis. At constant velocity and
/// with positions wrong by at most `Δ/2` (rounded) or by `0` to `Δ` (cut off), the window is 16
/// readings and `|v − v_true| ≤ Δ / (t_k − t_{k−16})` on each axis: at even times a sixteenth of the
/// error of the plain difference. At a jump the window is one reading, so nothing is delayed.
///
/// Without encoder steps (`Δ = 0`) the estimate is the plain difference.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_safety::VelocityEstimator;
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let mut estimator = VelocityEstimator::new(1000.0, 0.0)?;
/// assert_eq!(estimator.update(Vector([0.5, 0.25, 0.0])), Vector([0.0, 0.0, 0.0]));
/// assert_eq!(estimator.update(Vector([0.75, 0.25, 0.0])), Vector([250.0, 0.0, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct VelocityEstimator {
    rate: f64,
    /// How far from the line a position may be [m].
    step: f64,
    /// A ring buffer: from the newest position on, each next one is older.
    positions: [Point<3>; LONGEST],
    /// For each position the time since the one before it, in periods.
    waits: [f64; LONGEST],
    newest: usize,
    known: usize,
    window: usize,
}

impl VelocityEstimator {
    /// An estimator for positions read at `rate` [Hz] and quantised to `encoder_step` [m].
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the rate is not positive, the step negative, or either not
    /// finite.
    pub fn new(rate: f64, encoder_step: f64) -> Result<Self, SafetyError> {
        Ok(Self {
            rate: NumberError::check_rate(rate)?,
            step: NumberError::check_not_negative("encoder_step", encoder_step, "m")?
                * (1.0 + SLACK),
            positions: [Vector::ZERO; LONGEST],
            waits: [1.0; LONGEST],
            newest: 0,
            known: 0,
            window: 0,
        })
    }

    /// Adds the `position` of the next tick [m], a period after the one before, and returns the
    /// velocity [m/s].
    ///
    /// The velocity is zero at the first position. A position that is not finite clears the
    /// window and gives zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most 16 positions
    /// an axis.
    #[must_use]
    pub fn update(&mut self, position: Point<3>) -> Vector<f64, 3> {
        self.add(position, 1.0)
    }

    /// As [`update`](Self::update), with the time `elapsed` since the position before [s]. A time
    /// that is not positive and finite clears the window too.
    ///
    /// Real-time: as [`update`](Self::update).
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_safety::VelocityEstimator;
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let mut estimator = VelocityEstimator::new(1000.0, 0.0)?;
    /// let _ = estimator.update(Vector([0.5, 0.25, 0.0]));
    /// // 250 mm in four periods.
    /// assert_eq!(estimator.update_after(Vector([0.75, 0.25, 0.0]), 0.004), Vector([62.5, 0.0, 0.0]));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn update_after(&mut self, position: Point<3>, elapsed: f64) -> Vector<f64, 3> {
        // A rate times its period is not one for every rate.
        let is_period = elapsed == 1.0 / self.rate;
        self.add(position, if is_period { 1.0 } else { elapsed * self.rate })
    }

    /// Adds a position `wait` periods after the one before.
    #[inline]
    fn add(&mut self, position: Point<3>, wait: f64) -> Vector<f64, 3> {
        // Written so that a wait of NaN ends here.
        let is_usable = position.is_finite() && wait > 0.0 && wait <= f64::MAX;
        if !is_usable {
            self.reset();
            return Vector::ZERO;
        }
        let longest = if self.step > 0.0 { self.known } else { self.known.min(1) };
        let (window, velocity) = self.fit(position, wait, longest);
        self.window = window;
        self.newest = (self.newest + LONGEST - 1) % LONGEST;
        if let Some(place) = self.positions.get_mut(self.newest) {
            *place = position;
        }
        if let Some(place) = self.waits.get_mut(self.newest) {
            *place = wait;
        }
        self.known = (self.known + 1).min(LONGEST);
        let velocity = velocity * self.rate;
        if !velocity.is_finite() {
            self.window = 0;
            return Vector::ZERO;
        }
        velocity
    }

    /// The longest window up to `position`, `wait` periods after the newest, in which the positions
    /// lie on a line; and the mean displacement a period over that window, zero for a window of
    /// zero.
    #[inline]
    fn fit(&self, position: Point<3>, wait: f64, longest: usize) -> (usize, Vector<f64, 3>) {
        // A line from the newest position passes within a step of every position of the window
        // if its displacement per period lies between these bounds.
        let (mut least, mut most) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        let (mut fitting, mut age) = (Vector::ZERO, wait);
        for window in 1..=longest {
            let place = (self.newest + window - 1) % LONGEST;
            let (Some(oldest), Some(earlier)) =
                (self.positions.get(place), self.waits.get(place))
            else {
                return (window - 1, fitting);
            };
            // Of even times the age is a whole number, without rounding.
            let per_period = 1.0 / age;
            let way = (position - *oldest) * per_period;
            let step = self.step * per_period;
            for ((way, least), most) in way.0.iter().zip(&mut least).zip(&mut most) {
                // Written so that NaN ends the window.
                let is_on_line = *least <= *way && *way <= *most;
                if !is_on_line {
                    return (window - 1, fitting);
                }
                // Plain comparisons compile to one instruction each; `f64::max` must also treat
                // NaN.
                *least = if *least > way - step { *least } else { way - step };
                *most = if *most < way + step { *most } else { way + step };
            }
            fitting = way;
            age += earlier;
        }
        (longest, fitting)
    }

    /// Forgets all positions.
    pub fn reset(&mut self) {
        self.known = 0;
        self.window = 0;
    }

    /// The number of readings over which the last velocity was taken; 0 without a velocity.
    #[must_use]
    pub fn window(&self) -> usize {
        self.window
    }
}

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

    const RATE: f64 = 1000.0;

    #[test]
    fn without_steps_a_constant_velocity_is_exact() {
        // Numbers without rounding: a rate of 1024 Hz and ways of 1/1024 m.
        let mut estimator = VelocityEstimator::new(1024.0, 0.0).unwrap();
        for tick in 0..100 {
            let position = Vector([3.0, -0.5, 0.25]) * (f64::from(tick) / 1024.0);
            let velocity = estimator.update(position);
            assert!(tick == 0 || velocity == Vector([3.0, -0.5, 0.25]));
            assert_eq!(estimator.window(), usize::from(tick > 0));
        }
    }

    #[test]
    fn steps_err_by_at_most_a_step_over_the_window() {
        let step = 2e-5;
        for velocity in [1e-4, 0.003, 0.0123, 0.3, -0.07] {
            for quantise in [f64::floor as fn(f64) -> f64, f64::round] {
                let mut estimator = VelocityEstimator::new(RATE, step).unwrap();
                for tick in 0..500 {
                    let x = velocity * f64::from(tick) / RATE;
                    let seen = Vector([quantise(x / step) * step, 0.0, 0.0]);
                    let error = (estimator.update(seen).0[0] - velocity).abs();
                    let n = estimator.window();
                    assert_eq!(n, LONGEST.min(tick as usize));
                    assert!(n == 0 || error <= step * RATE / n as f64 * (1.0 + 1e-9));
                }
            }
        }
    }

    /// With uneven times the bound is that of the window's time.
    #[test]
    fn uneven_times_err_by_at_most_a_step_over_the_time_of_the_window() {
        let step = 2e-5;
        for velocity in [1e-4, 0.003, 0.0123, 0.3, -0.07] {
            let mut estimator = VelocityEstimator::new(RATE, step).unwrap();
            let (mut times, mut time) = (Vec::new(), 0.0);
            for tick in 0..500_u32 {
                // From a quarter of a period to four of them, in an order without pattern.
                let wait =
                    2.0_f64.powi((tick.wrapping_mul(2_654_435_761) >> 13) as i32 % 5 - 2);
                time += wait / RATE;
                times.push(time);
                let seen = Vector([(velocity * time / step).round() * step, 0.0, 0.0]);
                let found = estimator.update_after(seen, wait / RATE);
                let n = estimator.window();
                assert_eq!(n, LONGEST.min(tick as usize));
                let span = time - times.iter().rev().nth(n).unwrap();
                let error = (found.0[0] - velocity).abs();
                assert!(n == 0 || error <= step / span * (1.0 + 1e-9), "{tick}: {error}");
            }
        }
    }

    #[test]
    fn even_times_are_the_same_bits() {
        let [mut plain, mut timed] =
            [(); 2].map(|()| VelocityEstimator::new(RATE, 1e-5).unwrap());
        for tick in 0..2000 {
            let x = (0.01 * (f64::from(tick) * 0.013).sin() / 1e-5).round() * 1e-5;
            let position = Vector([x, -0.5 * x, 0.0]);
            assert_eq!(plain.update(position), timed.update_after(position, 1.0 / RATE));
        }
    }

    #[test]
    fn a_time_that_is_none_clears_the_window() {
        for elapsed in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
            let mut estimator = VelocityEstimator::new(RATE, 1e-5).unwrap();
            let _ = estimator.update(Vector([0.0, 0.0, 0.0]));
            assert_eq!(estimator.update_after(Vector([0.1, 0.0, 0.0]), elapsed), Vector::ZERO);
            assert_eq!(estimator.update(Vector([0.2, 0.0, 0.0])), Vector::ZERO);
        }
    }

    #[test]
    fn a_large_step_shows_in_the_same_tick() {
        let mut estimator = VelocityEstimator::new(RATE, 1e-5).unwrap();
        for _ in 0..50 {
            assert_eq!(estimator.update(Vector([0.01, 0.0, 0.0])), Vector::ZERO);
        }
        assert_eq!(estimator.window(), LONGEST);
        let velocity = estimator.update(Vector([0.011, 0.0, 0.0]));
        assert!((velocity - Vector([1.0, 0.0, 0.0])).norm() < 1e-12);
        assert_eq!(estimator.window(), 1);
    }

    #[test]
    fn a_position_that_is_not_finite_starts_anew() {
        let mut estimator = VelocityEstimator::new(RATE, 1e-5).unwrap();
        let _ = estimator.update(Vector([0.0, 0.0, 0.0]));
        assert!(estimator.update(Vector([0.1, 0.0, 0.0])).norm() > 1.0);
        assert_eq!(estimator.update(Vector([f64::NAN, 0.0, 0.0])), Vector::ZERO);
        assert_eq!(estimator.update(Vector([5.0, 0.0, 0.0])), Vector::ZERO);
        assert_eq!(estimator.update(Vector([5.0, 0.0, 0.0])), Vector::ZERO);
        let _ = estimator.update(Vector([f64::MAX, 0.0, 0.0]));
        assert_eq!(estimator.update(Vector([-f64::MAX, 0.0, 0.0])), Vector::ZERO);
    }

    #[test]
    fn wrong_numbers_are_named() {
        let error = VelocityEstimator::new(0.0, 0.0).unwrap_err();
        assert_eq!(error.to_string(), "rate must be from 1e-6 to 1e9, got 0 Hz");
        assert!(VelocityEstimator::new(1e3, -1e-6).is_err());
        assert!(VelocityEstimator::new(1e3, f64::NAN).is_err());
    }
}

#[cfg(test)]
mod arrivals_tests {
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
