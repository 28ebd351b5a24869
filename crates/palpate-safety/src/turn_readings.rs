// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Orientations that a hand cannot have made.

use std::f64::consts::PI;

use palpate_field::{Rotation, Vector};

use crate::error::SafetyError;
use crate::readings::{HandLimits, Held, Moved, Reach};
use palpate_device::{NumberError, TurningProfile};

/// Holds back the readings of an orientation that a hand cannot have made, as
/// [`Readings`](crate::Readings) does those of a position.
///
/// With the last orientation `R₀` that counted, its angular velocity `ω₀`, measured as a rotation
/// vector over the time `t₀` before it, and the time `t` since, a reading `R` counts if
///
/// ```text
/// ∠(R, R₀) ≤ v t + δ   and   ∠(R, exp(ω₀ t) R₀) ≤ ½ a t (t + 2 t₀) + δ (1 + t/t₀)
/// ```
///
/// with the angle `∠` of the rotation between two orientations, the [largest angular
/// speed](TurningProfile::max_speed) `v` and [acceleration](TurningProfile::max_acceleration) `a` of
/// the hand, and three encoder steps `δ`. No rotation within `v` and `a` is held back:
///
/// - The orientations `R(s)` and `exp(ω₀ s) R₀` part at most as fast as their angular velocities
///   differ, because the angle does not change if both are turned alike; likewise `R(s)` and `R₀`,
///   which gives the first bound.
/// - With the angular velocity `ω₁` at the middle of `t₀`, the same holds of `exp(ω₁ t₀)`, which is
///   within `∫ a |s| ds = a t₀²/4` of `exp(ω₀ t₀)`. Up to half a turn, rotation vectors differ by at
///   most π/2 times the angle between the rotations, `θ/2` over `sin(θ/2)`, so that
///   `|ω₁ − ω₀| ≤ π a t₀ / 8`.
/// - So `|ω(s) − ω₀| ≤ a (s + t₀/2) + π a t₀ / 8 ≤ a (s + t₀)`, whose integral over `t` is the second
///   bound.
///
/// Where a hand may have made half a turn or more within `t₀`, its angular velocity is not known, and
/// the next reading keeps the first bound alone; so does the second of all. Without a largest speed,
/// a device is taken to turn by less than half a turn between two readings.
///
/// ```
/// use palpate_field::{Rotation, Vector};
/// use palpate_device::TurningProfile;
/// use palpate_safety::{ReadingsReport, TurnReadings};
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device = TurningProfile { max_speed: 50.0, ..TurningProfile::unlimited() };
/// let mut readings = TurnReadings::new(&device)?;
/// let about_x = |angle: f64| Rotation::identity().turned(Vector([angle, 0.0, 0.0]));
/// assert!(readings.counts(about_x(0.25), 1e-3));
/// assert!(!readings.counts(about_x(0.375), 1e-3)); // 125 rad/s
/// assert!(readings.counts(about_x(0.26), 1e-3));
/// let report = ReadingsReport::default().with_turns(&readings);
/// assert_eq!((report.held, report.turns_held), (0, 1));
/// assert!((report.farthest_turn - 0.125).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct TurnReadings {
    reach: Reach,
    /// The last orientation that counted.
    last: Option<Counted>,
    held: Held,
}

#[derive(Clone, Copy, Debug)]
struct Counted {
    orientation: Rotation<3>,
    angular_velocity: Vector<f64, 3>,
    /// The time over which the angular velocity was measured [s]; infinite if it is not known.
    over: f64,
    /// The time since then [s].
    since: f64,
}

impl TurnReadings {
    /// For the readings of a device with this rotation.
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the largest angular speed or acceleration is not positive, or the
    /// encoder step negative or not finite.
    pub fn new(device: &TurningProfile) -> Result<Self, SafetyError> {
        let positive = NumberError::check_positive_or_infinite;
        let step = device.encoder_step;
        let step = NumberError::check_not_negative("angular_encoder_step", step, "rad")?;
        let acceleration = device.max_acceleration;
        let limits = HandLimits {
            max_speed: positive("angular_max_speed", device.max_speed, "rad/s")?,
            max_acceleration: positive("angular_max_acceleration", acceleration, "rad/s²")?,
        };
        let reach = Reach::new(limits, step, 2.0);
        Ok(Self { reach, last: None, held: Held::default() })
    }

    /// Whether a reading counts, made `elapsed` after the one before [s]. The first one does.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn counts(&mut self, orientation: Rotation<3>, elapsed: f64) -> bool {
        if self.reach.is_unlimited() {
            return true;
        }
        let unknown = Counted {
            orientation,
            angular_velocity: Vector::ZERO,
            over: f64::INFINITY,
            since: 0.0,
        };
        let Some(last) = &mut self.last else {
            self.last = Some(unknown);
            return true;
        };
        last.since += elapsed.max(0.0);
        let time = last.since;
        let way = last.orientation.turn_to(&orientation);
        let kept_on = last.orientation.turned(last.angular_velocity * time);
        let change = kept_on.turn_to(&orientation).norm();
        let moved = Moved { way: way.norm(), change, time, over: last.over };
        if !self.reach.has(moved) {
            self.held.add(way.norm());
            return false;
        }
        last.orientation = orientation;
        // Two readings at one time say nothing of the angular velocity.
        if time > 0.0 {
            let is_ambiguous = (PI..f64::INFINITY).contains(&self.reach.way_in(time));
            let angular_velocity = way * (1.0 / time);
            let known = Counted { angular_velocity, over: time, ..unknown };
            let is_known = !is_ambiguous && angular_velocity.is_finite();
            *last = if is_known { known } else { unknown };
        }
        true
    }

    /// Nothing was read for `elapsed` [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn miss(&mut self, elapsed: f64) {
        if let Some(last) = &mut self.last {
            last.since += elapsed.max(0.0);
        }
    }

    /// Forgets what was read: the next reading is the first again.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// The last orientation that counted; `None` before the first.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn last(&self) -> Option<Rotation<3>> {
        self.last.map(|last| last.orientation)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn held(&self) -> Held {
        self.held
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "an index is within its list")]
mod tests {
    use super::*;

    const PERIOD: f64 = 1e-3;

    fn readings() -> TurnReadings {
        let device = TurningProfile {
            max_speed: 50.0,
            max_acceleration: 1e4,
            ..TurningProfile::unlimited()
        };
        TurnReadings::new(&device).unwrap()
    }

    fn about_y(angle: f64) -> Rotation<3> {
        Rotation::identity().turned(Vector([0.0, angle, 0.0]))
    }

    #[test]
    fn a_quarter_turn_is_held_back_until_a_hand_can_have_made_it() {
        let mut readings = readings();
        for _ in 0..2 {
            assert!(readings.counts(about_y(0.3), PERIOD));
        }
        let turned = about_y(0.3 + 0.5 * PI);
        let held = (0..100).take_while(|_| !readings.counts(turned, PERIOD)).count();
        // ½ a t (t + 2 ms) reaches it after 16.8 ms, and 50 rad/s after 31.4 ms.
        assert_eq!((held, readings.last()), (31, Some(turned)));
        assert_eq!(readings.held().ticks, 31);
        assert!((readings.held().farthest - 0.5 * PI).abs() < 1e-15);
    }

    #[test]
    fn the_acceleration_alone_holds_back_what_the_speed_allows() {
        let mut readings = readings();
        for _ in 0..2 {
            assert!(readings.counts(about_y(0.0), PERIOD));
        }
        // ½ a t (t + 2 ms) is 15 mrad after a tick, and 40 mrad after two.
        assert!(!readings.counts(about_y(0.0151), PERIOD));
        assert!(readings.counts(about_y(0.0399), PERIOD));
    }

    #[test]
    fn what_was_missed_or_forgotten_may_be_anywhere() {
        let mut readings = readings();
        for _ in 0..2 {
            assert!(readings.counts(about_y(0.0), PERIOD));
        }
        readings.miss(0.062);
        assert!(readings.counts(about_y(3.1), PERIOD));
        readings.forget();
        assert_eq!(readings.last(), None);
        assert!(readings.counts(about_y(-2.0), PERIOD));
        assert_eq!(readings.held().ticks, 0);
    }

    /// The shorter way round is not that of the hand, so its velocity is not known: 190 rad/s over
    /// 20 ms would look like 124 rad/s back.
    #[test]
    fn a_hand_that_made_more_than_half_a_turn_unseen_is_not_held_back() {
        let device = TurningProfile {
            max_speed: 200.0,
            max_acceleration: 1e4,
            ..TurningProfile::unlimited()
        };
        let mut readings = TurnReadings::new(&device).unwrap();
        let mut time = 0.0_f64;
        for elapsed in [0.001, 0.001, 0.02, 0.001, 0.001, 0.02, 0.001] {
            time += elapsed;
            assert!(readings.counts(about_y(190.0 * time), elapsed), "{time}");
        }
    }

    /// As positions do.
    #[test]
    fn orientations_count_in_steps_and_in_ticks_that_are_uneven() {
        let step = 1e-3;
        let device = TurningProfile {
            max_speed: 50.0,
            max_acceleration: 300.0,
            encoder_step: step,
            ..TurningProfile::unlimited()
        };
        let mut readings = TurnReadings::new(&device).unwrap();
        let mut time = 0.0_f64;
        for tick in 0..10_000 {
            let elapsed = [1e-3, 2e-5, 2e-3, 1e-5, 0.0, f64::MIN_POSITIVE, 9e-4][tick % 7];
            time += elapsed;
            let angle = (2.0 * (9.0 * time).sin() / step).round() * step;
            assert!(readings.counts(about_y(angle), elapsed), "{tick}");
        }
        assert!(!readings.counts(about_y(2.5), 0.0));
    }

    #[test]
    fn limits_that_are_no_limits_are_refused() {
        let base = TurningProfile::unlimited;
        let refused =
            |device: &TurningProfile| TurnReadings::new(device).unwrap_err().to_string();
        assert_eq!(
            refused(&TurningProfile { max_speed: 0.0, ..base() }),
            "angular_max_speed must be positive, got 0 rad/s"
        );
        assert_eq!(
            refused(&TurningProfile { max_acceleration: f64::NAN, ..base() }),
            "angular_max_acceleration must be positive, got NaN rad/s²"
        );
    }
}
