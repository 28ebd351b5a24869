// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Readings that a hand cannot have made.

use palpate_field::{Point, Vector};

use crate::error::SafetyError;
use crate::turn_readings::TurnReadings;
use palpate_device::{DeviceProfile, NumberError};

/// The way between two readings may be off by so many encoder steps: half a step an axis in each,
/// `√3` in space together; and rotation vectors differ by up to `π/2` times as much.
const STEPS: f64 = 3.0;

/// Readings that were held back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ReadingsReport {
    /// Ticks whose position was held back.
    pub held: u64,
    /// The largest distance of a rejected position from the last accepted one [m].
    pub farthest: f64,
    /// Ticks whose orientation was held back.
    pub turns_held: u64,
    /// The largest angle of a rejected orientation from the last accepted one [rad].
    pub farthest_turn: f64,
}

impl ReadingsReport {
    /// This report of positions with the orientations that were held back.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn with_turns(self, turns: &TurnReadings) -> Self {
        let Held { ticks, farthest } = turns.held();
        Self { turns_held: ticks, farthest_turn: farthest, ..self }
    }
}

/// What was held back of positions [m] or of orientations [rad].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Held {
    pub(crate) ticks: u64,
    pub(crate) farthest: f64,
}

impl Held {
    /// Counts a reading that is `way` from the last one that counted.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn add(&mut self, way: f64) {
        self.ticks += 1;
        self.farthest = self.farthest.max(way);
    }
}

/// The largest speed and acceleration of a hand, along axes [m/s, m/s²] or about them [rad/s, rad/s²];
/// both are positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HandLimits {
    pub(crate) max_speed: f64,
    pub(crate) max_acceleration: f64,
}

/// A motion since the last reading that counted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    /// How far the hand went [m] or turned [rad].
    pub(crate) way: f64,
    /// How far that is from where the last velocity would have led it.
    pub(crate) change: f64,
    /// The time since then [s].
    pub(crate) time: f64,
    /// The time over which the last velocity was measured [s]; infinite if it is not known.
    pub(crate) over: f64,
}

/// How far a hand can move, along axes [m] or about them [rad].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    max_speed: f64,
    max_acceleration: f64,
    slack: f64,
    /// The mean velocity over a time `t₀` is that of `lag · t₀/2` before its end.
    lag: f64,
}

impl Reach {
    /// For a hand with these limits, read in encoder steps; `lag` as in [`Reach`].
    pub(crate) fn new(limits: HandLimits, encoder_step: f64, lag: f64) -> Self {
        let HandLimits { max_speed, max_acceleration } = limits;
        Self { max_speed, max_acceleration, slack: STEPS * encoder_step, lag }
    }

    /// Whether every reading is within reach.
    pub(crate) fn is_unlimited(&self) -> bool {
        self.max_speed == f64::INFINITY && self.max_acceleration == f64::INFINITY
    }

    /// The farthest way in a time [s], without encoder steps.
    pub(crate) fn way_in(&self, time: f64) -> f64 {
        self.max_speed * time
    }

    /// Whether a hand can have moved so.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn has(&self, moved: Moved) -> bool {
        let Moved { way, change, time, over } = moved;
        let is_fast = self.max_speed < f64::INFINITY && way > self.way_in(time) + self.slack;
        // Infinite numbers are no limits, at a time of zero too.
        if is_fast || over == f64::INFINITY || self.max_acceleration == f64::INFINITY {
            return !is_fast;
        }
        let most = 0.5 * self.max_acceleration * time * (time + self.lag * over);
        // What the last velocity is off by grows with the time.
        change <= most + self.slack * (1.0 + time / over)
    }
}

/// Holds back the readings of a position that a hand cannot have made: glitches of encoders and
/// transports. [`TurnReadings`] does the same for orientations.
///
/// With the last position `x₀` that counted, its velocity `v₀`, measured over the time `t₀` before
/// it, and the time `t` since, a reading `x` counts if
///
/// ```text
/// |x − x₀| ≤ v t + δ   and   |x − x₀ − v₀ t| ≤ ½ a t (t + t₀) + δ (1 + t/t₀)
/// ```
///
/// with the device's [largest speed](DeviceProfile::max_speed) `v`, its [largest
/// acceleration](DeviceProfile::max_acceleration) `a` and three encoder steps `δ`. The second bound
/// is that of an acceleration of at most `a`, since `v₀` is the velocity `t₀/2` before `x₀`. Both
/// bounds grow, so that after a time any reading counts: a device that was moved while it was not
/// read is found again. Nothing is known of the velocity of the first reading, so that the second
/// keeps the first bound alone.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_device::DeviceProfile;
/// use palpate_safety::Readings;
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device = DeviceProfile { max_speed: 5.0, ..DeviceProfile::unlimited("example") };
/// let mut readings = Readings::new(&device)?;
/// assert!(readings.counts(Vector([0.0, 0.0, 0.0]), 1e-3));
/// assert!(!readings.counts(Vector([0.05, 0.0, 0.0]), 1e-3)); // 50 m/s
/// assert_eq!(readings.last(), Some(Vector([0.0, 0.0, 0.0])));
/// assert!(readings.counts(Vector([0.002, 0.0, 0.0]), 1e-3));
/// assert_eq!((readings.report().held, readings.report().farthest), (1, 0.05));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Readings {
    reach: Reach,
    /// The last position that counted.
    last: Option<Counted>,
    held: Held,
}

#[derive(Clone, Copy, Debug)]
struct Counted {
    position: Point<3>,
    velocity: Vector<f64, 3>,
    /// The time over which the velocity was measured [s]; infinite if it is not known.
    over: f64,
    /// The time since then [s].
    since: f64,
}

impl Counted {
    /// A position of unknown velocity.
    fn unknown(position: Point<3>) -> Self {
        Self { position, velocity: Vector::ZERO, over: f64::INFINITY, since: 0.0 }
    }
}

impl Readings {
    /// For the readings of `device`.
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the largest speed or acceleration is not positive, or the encoder
    /// step negative or not finite.
    pub fn new(device: &DeviceProfile) -> Result<Self, SafetyError> {
        let positive = NumberError::check_positive_or_infinite;
        let step = NumberError::check_not_negative("encoder_step", device.encoder_step, "m")?;
        let limits = HandLimits {
            max_speed: positive("max_speed", device.max_speed, "m/s")?,
            max_acceleration: positive("max_acceleration", device.max_acceleration, "m/s²")?,
        };
        let reach = Reach::new(limits, step, 1.0);
        Ok(Self { reach, last: None, held: Held::default() })
    }

    /// Whether a reading [m] counts, made `elapsed` after the one before [s]. The first one and
    /// those that are not finite do; after the latter, the next is the first again.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn counts(&mut self, position: Point<3>, elapsed: f64) -> bool {
        if self.reach.is_unlimited() {
            return true;
        }
        if !position.is_finite() {
            self.last = None;
            return true;
        }
        let Some(last) = &mut self.last else {
            self.last = Some(Counted::unknown(position));
            return true;
        };
        last.since += elapsed.max(0.0);
        let time = last.since;
        let way = position - last.position;
        let change = (way - last.velocity * time).norm();
        let moved = Moved { way: way.norm(), change, time, over: last.over };
        if self.reach.has(moved) {
            // Two readings at one time say nothing of the velocity.
            last.position = position;
            if time > 0.0 {
                let velocity = way * (1.0 / time);
                let known = Counted { velocity, over: time, ..Counted::unknown(position) };
                *last = if velocity.is_finite() { known } else { Counted::unknown(position) };
            }
            return true;
        }
        self.held.add(way.norm());
        false
    }

    /// The last position that counted [m]; `None` before the first, and for a device without a largest
    /// speed and acceleration.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn last(&self) -> Option<Point<3>> {
        self.last.map(|last| last.position)
    }

    /// What was held back so far, of positions alone.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn report(&self) -> ReadingsReport {
        let Held { ticks: held, farthest } = self.held;
        ReadingsReport { held, farthest, ..ReadingsReport::default() }
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "an index is within its list")]
mod tests {
    use super::*;

    const PERIOD: f64 = 1e-3;

    fn readings() -> Readings {
        let device = DeviceProfile {
            max_speed: 5.0,
            max_acceleration: 500.0,
            ..DeviceProfile::unlimited("")
        };
        Readings::new(&device).unwrap()
    }

    #[test]
    fn a_hand_at_the_largest_acceleration_counts() {
        let mut readings = readings();
        for tick in 0..10 {
            let time = 1e-3 * f64::from(tick);
            // From rest forwards, and from 1.99 m/s back.
            let since = time - 0.004;
            let forwards = 249.0 * time * time;
            let back = 249.0 * (1.6e-5 + since * (0.008 - since));
            let x = if since < 0.0 { forwards } else { back };
            assert!(readings.counts(Vector([x, 0.0, 0.0]), PERIOD), "{tick}");
        }
    }

    #[test]
    fn a_jump_is_held_back_until_a_hand_can_have_made_it() {
        let mut readings = readings();
        for _ in 0..2 {
            assert!(readings.counts(Vector([0.1, 0.1, 0.0]), PERIOD));
        }
        let held =
            (0..100).take_while(|_| !readings.counts(Vector([0.15, 0.1, 0.0]), PERIOD)).count();
        // ½ a t (t + 1 ms) reaches 50 mm after 13.7 ms, and 5 m/s after 10 ms.
        assert_eq!(held, 13);
        assert_eq!(
            (readings.report().held, readings.last()),
            (13, Some(Vector([0.15, 0.1, 0.0])))
        );
    }

    /// Once it was held back until it could have come from rest.
    #[test]
    fn a_hand_that_moves_when_it_is_read_first_counts() {
        let mut readings = readings();
        for tick in 0..10 {
            let x = 4.9e-3 * f64::from(tick);
            assert!(readings.counts(Vector([x, -0.1, 0.0]), PERIOD), "{tick}");
        }
    }

    #[test]
    fn after_a_gap_the_hand_may_be_farther() {
        let mut readings = readings();
        assert!(readings.counts(Vector([0.0, 0.0, 0.0]), PERIOD));
        assert!(readings.counts(Vector([0.05, 0.0, 0.0]), 0.021));
        assert!(readings.counts(Vector([f64::NAN, 0.0, 0.0]), PERIOD));
        assert!(readings.counts(Vector([3.0, 0.0, 0.0]), PERIOD), "found again anywhere");
    }

    /// A velocity from a short time is off by more than one from a long time. Once a reading after a
    /// tick that came at once was held back, and those after it for up to 0.3 s.
    #[test]
    fn readings_in_steps_count_in_ticks_that_are_uneven() {
        let step = 5e-5;
        let device = DeviceProfile {
            max_speed: 5.0,
            max_acceleration: 100.0,
            encoder_step: step,
            ..DeviceProfile::unlimited("")
        };
        let mut readings = Readings::new(&device).unwrap();
        let mut time = 0.0_f64;
        for tick in 0..10_000 {
            let elapsed = [1e-3, 2e-5, 2e-3, 1e-5, 0.0, 9e-4, 1e-6][tick % 7];
            time += elapsed;
            let there = Vector([0.05 * (9.0 * time).sin(), 0.05 * (9.0 * time).cos(), 0.0]);
            let read = Vector(there.0.map(|x| (x / step).round() * step));
            assert!(readings.counts(read, elapsed), "{tick}");
        }
    }

    /// Once zero times infinity held back what was where it was.
    #[test]
    fn the_second_reading_may_come_at_the_time_of_the_first() {
        for (speed, acceleration) in
            [(5.0, f64::INFINITY), (f64::INFINITY, 500.0), (5.0, 500.0)]
        {
            let device = DeviceProfile {
                max_speed: speed,
                max_acceleration: acceleration,
                ..DeviceProfile::unlimited("")
            };
            let mut readings = Readings::new(&device).unwrap();
            for elapsed in [0.0, 0.0, PERIOD, 0.0] {
                assert!(
                    readings.counts(Vector([0.1, 0.1, 0.0]), elapsed),
                    "{speed}, {acceleration}"
                );
            }
        }
    }

    /// Regression: two readings with the same timestamp made the velocity NaN, and every later reading was
    /// rejected.
    #[test]
    fn readings_at_one_time_leave_the_velocity_as_it_was() {
        let mut readings = readings();
        for elapsed in [PERIOD, PERIOD, 0.0, -1.0, f64::MIN_POSITIVE, PERIOD, 0.0, PERIOD] {
            assert!(readings.counts(Vector([0.1, 0.1, 0.0]), elapsed), "{elapsed}");
        }
        assert!(!readings.counts(Vector([0.15, 0.1, 0.0]), 0.0));
        assert!(readings.counts(Vector([0.1, 0.1, 0.0]), PERIOD));
    }

    /// Once the later of two readings at one time was forgotten, its way made a velocity, and a hand at
    /// rest was held back.
    #[test]
    fn of_two_readings_at_one_time_the_later_is_the_last() {
        let device = DeviceProfile { max_acceleration: 500.0, ..DeviceProfile::unlimited("") };
        let mut readings = Readings::new(&device).unwrap();
        assert!(readings.counts(Vector([0.0, 0.0, 0.0]), PERIOD));
        let there = Vector([0.1, 0.0, 0.0]);
        assert!(readings.counts(there, 0.0));
        assert_eq!(readings.last(), Some(there));
        assert!((0..400).all(|_| readings.counts(there, PERIOD)));
    }
}
