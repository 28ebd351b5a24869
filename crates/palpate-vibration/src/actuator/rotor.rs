// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The speed of a rotating mass.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// The speed below which the mass rests, as a part of the rated speed: a thousandth has a
/// millionth of the amplitude.
const AT_REST: f64 = 1e-3;

/// A mass that turns, with its speed as a part of the rated one.
///
/// The speed s follows the level u with a time constant: `s' = (u − s) / rise` while the motor is
/// driven faster or backwards, and `/ fall` while it slows by itself. At rest it needs a level of
/// at least `start_level` in either direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rotor {
    pub(super) speed: f64,
    start_level: f64,
    /// What is left of a difference of speed after a step, driven and coasting.
    driven: f64,
    coasting: f64,
}

impl Rotor {
    /// A mass at rest with these time constants [s], in steps of `period` [s].
    pub(super) fn new(start_level: f64, rise: f64, fall: f64, period: f64) -> Self {
        let left = |constant: f64| libm::exp(-period / constant);
        Self { speed: 0.0, start_level, driven: left(rise), coasting: left(fall) }
    }

    /// The speed after a step at this level, which may be negative.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn advance(&mut self, level: f64) {
        if self.speed == 0.0 && level.abs() < self.start_level {
            return;
        }
        let is_driven = level * self.speed < 0.0 || level.abs() > self.speed.abs();
        let left = if is_driven { self.driven } else { self.coasting };
        self.speed = level + (self.speed - level) * left;
        if self.speed.abs() < AT_REST && level.abs() < self.start_level {
            self.speed = 0.0;
        }
    }

    /// The level that brings the mass to `speed` in one step, within ± `overdrive`: the inverse of
    /// [`advance`](Self::advance).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn level_for(&self, speed: f64, overdrive: f64) -> f64 {
        let inverse = |left: f64| (speed - self.speed * left) / (1.0 - left);
        let driven = inverse(self.driven);
        let level = if driven > self.speed || driven < 0.0 {
            driven
        } else {
            // Slower than it is: it coasts, at most down to level zero.
            inverse(self.coasting).clamp(0.0, self.speed.max(0.0))
        };
        level.clamp(-overdrive, overdrive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotor() -> Rotor {
        Rotor::new(0.7, 0.05, 0.1, 1e-3)
    }

    #[test]
    fn below_its_start_level_it_rests() {
        let mut motor = rotor();
        (0..1000).for_each(|_| motor.advance(0.69));
        assert_eq!(motor.speed, 0.0);
        motor.advance(0.7);
        assert!((motor.speed - 0.7 * (1.0 - (-0.02_f64).exp())).abs() < 1e-15);
    }

    #[test]
    fn after_a_time_constant_the_speed_is_at_63_percent_and_coasts_to_37() {
        let mut motor = rotor();
        (0..50).for_each(|_| motor.advance(1.0));
        let risen = 1.0 - (-1.0_f64).exp();
        assert!((motor.speed - risen).abs() < 1e-12);
        (0..100).for_each(|_| motor.advance(0.0));
        assert!((motor.speed - risen * (-1.0_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn the_level_for_a_speed_gives_that_speed() {
        for (from, to) in [(0.8, 0.81), (0.8, 0.795), (0.01, 0.0), (0.9, 0.9)] {
            let mut motor = Rotor { speed: from, ..rotor() };
            let level = motor.level_for(to, 1.5);
            assert!(level.abs() <= 1.5);
            motor.advance(level);
            assert!((motor.speed - to).abs() < 1e-12, "{from} to {to}: {}", motor.speed);
        }
    }
}
