// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Heat of continuous forces, and the watchdog.

use palpate_device::shortened;
use palpate_field::Vector;

/// The part of the continuous force at which the limit begins to act. Nearer to one, it acts
/// later and more abruptly.
const ONSET: f64 = 0.9;

/// Keeps the heat in the motors below the heat of their continuous force.
///
/// Heating grows with the square of the current, and so of the force; cooling is proportional
/// to the heat. With the written force `F` and the time constant `τ`: `τ dh/dt = |F|² − h`,
/// exact for a held force. While `√h` rises from 0.9 to 1 of the continuous force, longer
/// forces are shortened towards the continuous force, in proportion. So a burst of any force
/// passes at first, and `√h` does not exceed the continuous force, if the time constant is so
/// long that `√h` takes more than a tick from 0.9 to 1 of it. Forces below the continuous force
/// are never changed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContinuousLimit {
    continuous_force: f64,
    /// The part of its distance to `|F|²` by which `h` moves in a tick.
    part: f64,
    heat: f64,
}

/// The motors that a [`ContinuousLimit`] keeps cool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoolingOptions {
    /// The largest lasting force [N].
    pub(crate) continuous_force: f64,
    /// The time constant of the heat [s].
    pub(crate) cooling_time: f64,
    /// Ticks a second [Hz].
    pub(crate) rate: f64,
}

impl ContinuousLimit {
    pub(crate) fn new(options: CoolingOptions) -> Self {
        let CoolingOptions { continuous_force, cooling_time, rate } = options;
        let part = -libm::expm1(-1.0 / (cooling_time * rate));
        Self { continuous_force, part, heat: 0.0 }
    }

    /// The limited force; `None` if it is unchanged.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit(&self, force: Vector<f64, 3>) -> Option<Vector<f64, 3>> {
        let norm = force.norm();
        if norm <= self.continuous_force {
            return None;
        }
        let load = self.root_mean_square() / self.continuous_force;
        let blend = ((load - ONSET) / (1.0 - ONSET)).clamp(0.0, 1.0);
        if blend <= 0.0 {
            return None;
        }
        shortened(force, norm + (self.continuous_force - norm) * blend)
    }

    /// Updates the heat by the force that was written.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn written(&mut self, force: Vector<f64, 3>) {
        // An infinite square would never cool down.
        let square = force.dot(force).min(f64::MAX);
        self.heat += self.part * (square - self.heat);
    }

    /// `√h` [N]: the constant force that would give the same heat.
    pub(crate) fn root_mean_square(&self) -> f64 {
        self.heat.sqrt()
    }
}

/// How many periods ticks may be late together at a low rate. A device with a clock of its own has
/// nothing new in a tick now and then, and with jitter in two ticks together: a force that fell
/// each time would never be felt.
const LATE_PERIODS: f64 = 2.5;

/// Lowers the force to zero while ticks are late.
///
/// A force that is held for too long is stale. The time by which ticks are late adds up, and each
/// tick in time takes a period from the sum. When the sum reaches a limit, of at least
/// [some periods](LATE_PERIODS), the watchdog trips: the
/// force falls to zero, in ticks in time too, until the sum is zero. Meanwhile a tick in time takes
/// two periods from the sum: with a device of half the loop's rate every second tick has no new
/// reading, and its force must come back too.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watchdog {
    /// The sum at which it trips [s].
    limit: f64,
    /// The duration of a tick [s].
    period: f64,
    /// The decrease of the factor in a tick.
    fall: f64,
    /// The sum of late times, at most `limit` [s].
    late: f64,
    is_tripped: bool,
    factor: f64,
    trips: u64,
}

/// When a [`Watchdog`] trips, and how fast the force falls then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WatchdogOptions {
    /// By how much ticks are late together when it trips [s], but for 2.5 periods at least.
    pub(crate) late_time: f64,
    /// The time in which the force falls to zero [s].
    pub(crate) fall_time: f64,
    /// Ticks a second [Hz].
    pub(crate) rate: f64,
}

impl Watchdog {
    pub(crate) fn new(options: WatchdogOptions) -> Self {
        let WatchdogOptions { late_time, fall_time, rate } = options;
        // A time of zero gives an infinite decrease.
        let (period, fall) = (1.0 / rate, 1.0 / (fall_time * rate));
        let limit = late_time.max(LATE_PERIODS * period);
        Self { limit, period, fall, late: 0.0, is_tripped: false, factor: 1.0, trips: 0 }
    }

    /// One tick that is `late` by so much [s]; `true` if the watchdog trips in it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self, late: f64) -> bool {
        // Written so that NaN counts as late.
        let taken = if self.is_tripped { 2.0 * self.period } else { self.period };
        let change = if late <= 0.0 { -taken } else { late };
        let sum = self.late + change;
        self.late = if sum < self.limit { sum.max(0.0) } else { self.limit };
        let was_tripped = self.is_tripped;
        self.is_tripped = self.late >= self.limit || was_tripped && self.late > 0.0;
        self.factor = if self.is_tripped { (self.factor - self.fall).max(0.0) } else { 1.0 };
        let trips = self.is_tripped && !was_tripped;
        self.trips += u64::from(trips);
        trips
    }

    /// The factor on the force in this tick: it falls while the watchdog is tripped. Afterwards it is
    /// one at once, because the force [rises](crate::approach::Rise) from where it fell to.
    pub(crate) fn factor(&self) -> f64 {
        self.factor
    }

    /// The number of times the watchdog tripped.
    pub(crate) fn trips(&self) -> u64 {
        self.trips
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_passes_and_a_long_press_does_not() {
        let mut limit = ContinuousLimit::new(CoolingOptions {
            continuous_force: 2.0,
            cooling_time: 1.0,
            rate: 1000.0,
        });
        let wanted = Vector([0.0, 6.0, 0.0]);
        let mut written = wanted;
        for tick in 0..20_000 {
            let next = limit.limit(wanted).unwrap_or(wanted);
            // h = 36 (1 − e^−t) reaches (0.9 · 2)² at t = 0.0943 s.
            assert!(tick > 94 || next == wanted);
            assert!((next - written).norm() < 0.6, "smoothly");
            written = next;
            limit.written(written);
            assert!(limit.root_mean_square() <= 2.0);
        }
        assert!(written.norm() < 2.0 + 0.1 && written.norm() > 1.8);
    }

    #[test]
    fn what_may_last_is_never_changed() {
        let mut limit = ContinuousLimit::new(CoolingOptions {
            continuous_force: 2.0,
            cooling_time: 0.1,
            rate: 1000.0,
        });
        let wanted = Vector([2.0, 0.0, 0.0]);
        for _ in 0..2000 {
            assert_eq!(limit.limit(wanted), None);
            limit.written(wanted);
        }
        assert!((limit.root_mean_square() - 2.0).abs() < 1e-6);
    }

    #[test]
    fn without_a_continuous_force_nothing_is_changed() {
        let mut limit = ContinuousLimit::new(CoolingOptions {
            continuous_force: f64::INFINITY,
            cooling_time: 0.1,
            rate: 1000.0,
        });
        limit.written(Vector([1e200, 0.0, 0.0]));
        assert_eq!(limit.limit(Vector([1e200, 1.0, 0.0])), None);
    }
}

#[cfg(test)]
mod watchdog_tests {
    use super::*;

    fn factors(dog: &mut Watchdog, late: &[f64]) -> Vec<f64> {
        let step = |late: &f64| {
            dog.step(*late);
            dog.factor()
        };
        late.iter().map(step).collect()
    }

    #[test]
    fn it_trips_after_late_time_and_recovers_after_half_as_much_in_time() {
        let mut dog =
            Watchdog::new(WatchdogOptions { late_time: 4.0, fall_time: 2.0, rate: 1.0 });
        let late = [1.0, 0.0, 3.5, 0.5, 0.0, 1.5, 0.0, 0.0, 0.0];
        assert_eq!(factors(&mut dog, &late), [1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 1.0]);
        assert_eq!(dog.trips(), 1);
    }

    /// At 90 Hz, 11 ms without a reading were more than 5 ms: each took the force away.
    #[test]
    fn a_slow_servo_waits_for_two_readings() {
        for rate in [12.0, 30.0, 60.0, 90.0, 250.0] {
            let options = WatchdogOptions { late_time: 0.005, fall_time: 0.02, rate };
            let (mut dog, period) = (Watchdog::new(options), 1.0 / rate);
            let jitter = [period, 0.0, period, period, 0.0, 0.0, 0.0].repeat(100);
            assert_eq!(factors(&mut dog, &jitter), [1.0; 700], "{rate}");
            assert!(factors(&mut dog, &[period; 3]).last() < Some(&1.0), "{rate}");
        }
    }

    /// A stall counted as one late tick, however long it lasted.
    #[test]
    fn a_stall_counts_by_its_time() {
        let mut dog =
            Watchdog::new(WatchdogOptions { late_time: 0.005, fall_time: 0.0, rate: 1000.0 });
        assert!(dog.step(0.03));
        assert_eq!(factors(&mut dog, &[0.0; 4]), [0.0, 0.0, 1.0, 1.0]);
        assert!(dog.step(f64::NAN));
    }

    /// Once its sum never came back to zero, and the force stayed away for good.
    #[test]
    fn a_device_of_half_the_rate_gets_its_force_back() {
        let mut dog =
            Watchdog::new(WatchdogOptions { late_time: 0.005, fall_time: 0.0, rate: 1000.0 });
        assert!(dog.step(0.03));
        assert_eq!(factors(&mut dog, &[0.001, 0.0].repeat(5)).last(), Some(&1.0));
        assert_eq!(factors(&mut dog, &[0.001, 0.0].repeat(1000)).last(), Some(&1.0));
        assert_eq!(dog.trips(), 1);
    }
}
