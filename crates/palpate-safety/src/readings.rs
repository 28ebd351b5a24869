// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Readings that a hand cannot have made.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::device::DeviceProfile;
use crate::error::{NumberError, SafetyError};

/// A reading may be off by so many encoder steps: half a step each in the present position, in the
/// last one and in both of the last velocity, doubled.
const STEPS: f64 = 4.0;

/// Readings that were held back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ReadingsReport {
    /// Ticks whose reading was held back.
    pub held: u64,
    /// The farthest of them from the last position that counted [m].
    pub farthest: f64,
}

/// Holds back the readings of a position that a hand cannot have made: glitches of encoders and
/// transports.
///
/// With the last position `x₀` that counted, its velocity `v₀`, measured over the time `t₀` before
/// it, and the time `t` since, a reading `x` counts if
///
/// ```text
/// |x − x₀| ≤ v t + δ   and   |x − x₀ − v₀ t| ≤ ½ a t (t + t₀) + δ
/// ```
///
/// with the device's [largest speed](DeviceProfile::max_speed) `v`, its [largest
/// acceleration](DeviceProfile::max_acceleration) `a` and four encoder steps `δ`. The second bound
/// is that of an acceleration of at most `a`, since `v₀` is the velocity `t₀/2` before `x₀`. Both
/// bounds grow, so that after a time any reading counts: a device that was moved while it was not
/// read is found again.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_safety::{DeviceProfile, Readings};
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device = DeviceProfile::unlimited("example").with_max_speed(5.0);
/// let mut readings = Readings::new(&device)?;
/// assert!(readings.counts(Vector([0.0, 0.0]), 1e-3));
/// assert!(!readings.counts(Vector([0.05, 0.0]), 1e-3)); // 50 m/s
/// assert_eq!(readings.last(), Some(Vector([0.0, 0.0])));
/// assert!(readings.counts(Vector([0.002, 0.0]), 1e-3));
/// assert_eq!((readings.report().held, readings.report().farthest), (1, 0.05));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Readings<const D: usize> {
    max_speed: f64,
    max_acceleration: f64,
    slack: f64,
    /// The last position that counted.
    last: Option<Counted<D>>,
    report: ReadingsReport,
}

#[derive(Clone, Copy, Debug)]
struct Counted<const D: usize> {
    position: Point<D>,
    velocity: Vector<f64, D>,
    /// The time over which the velocity was measured [s].
    over: f64,
    /// The time since then [s].
    since: f64,
}

impl<const D: usize> Readings<D> {
    /// For the readings of `device`.
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the largest speed or acceleration is not positive, or the encoder
    /// step negative or not finite.
    pub fn new(device: &DeviceProfile) -> Result<Self, SafetyError> {
        let positive = NumberError::check_positive_or_infinite;
        let step = NumberError::check_not_negative("encoder_step", device.encoder_step, "m")?;
        Ok(Self {
            max_speed: positive("max_speed", device.max_speed, "m/s")?,
            max_acceleration: positive("max_acceleration", device.max_acceleration, "m/s²")?,
            slack: STEPS * step,
            last: None,
            report: ReadingsReport::default(),
        })
    }

    /// Whether a reading [m] counts, made `elapsed` after the one before [s]. The first one and
    /// those that are not finite do; after the latter, the next is the first again.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn counts(&mut self, position: Point<D>, elapsed: f64) -> bool {
        if self.max_speed == f64::INFINITY && self.max_acceleration == f64::INFINITY {
            return true;
        }
        if !position.is_finite() {
            self.last = None;
            return true;
        }
        let Some(last) = &mut self.last else {
            let (velocity, over, since) = (Vector::ZERO, 0.0, 0.0);
            self.last = Some(Counted { position, velocity, over, since });
            return true;
        };
        last.since += elapsed.max(0.0);
        let time = last.since;
        let way = position - last.position;
        let change = (way - last.velocity * time).norm();
        let most = 0.5 * self.max_acceleration * time * (time + last.over) + self.slack;
        if way.norm() <= self.max_speed * time + self.slack && change <= most {
            let velocity = way * (1.0 / time);
            *last = Counted { position, velocity, over: time, since: 0.0 };
            return true;
        }
        self.report.held += 1;
        self.report.farthest = self.report.farthest.max(way.norm());
        false
    }

    /// The last position that counted [m]; `None` before the first.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn last(&self) -> Option<Point<D>> {
        self.last.map(|last| last.position)
    }

    /// What was held back so far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn report(&self) -> ReadingsReport {
        self.report
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 1e-3;

    fn readings() -> Readings<2> {
        let device =
            DeviceProfile::unlimited("").with_max_speed(5.0).with_max_acceleration(500.0);
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
            assert!(readings.counts(Vector([x, 0.0]), PERIOD), "{tick}");
        }
    }

    #[test]
    fn a_jump_is_held_back_until_a_hand_can_have_made_it() {
        let mut readings = readings();
        assert!(readings.counts(Vector([0.1, 0.1]), PERIOD));
        let held =
            (0..100).take_while(|_| !readings.counts(Vector([0.15, 0.1]), PERIOD)).count();
        // ½ a t² reaches 50 mm after 14.1 ms, and 5 m/s after 10 ms.
        assert_eq!(held, 14);
        assert_eq!((readings.report().held, readings.last()), (14, Some(Vector([0.15, 0.1]))));
    }

    #[test]
    fn after_a_gap_the_hand_may_be_farther() {
        let mut readings = readings();
        assert!(readings.counts(Vector([0.0, 0.0]), PERIOD));
        assert!(readings.counts(Vector([0.05, 0.0]), 0.021));
        assert!(readings.counts(Vector([f64::NAN, 0.0]), PERIOD));
        assert!(readings.counts(Vector([3.0, 0.0]), PERIOD), "found again anywhere");
    }
}
