// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The velocity of a device point, estimated from quantised positions.
//!
//! F. Janabi-Sharifi, V. Hayward, C.-S. J. Chen, "Discrete-time adaptive windowing for velocity
//! estimation" (2000): the first-order adaptive window, fitted to its ends.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::error::{NumberError, SafetyError};

/// The longest window, in periods. A longer window would reduce noise at constant speed only.
const LONGEST: usize = 16;

/// Tolerance on the encoder step, as a part of it: quantised positions may lie exactly one step
/// off a line, and rounding must not decide.
const SLACK: f64 = 1e-6;

/// Velocity over the longest window in which the positions lie on a straight line.
///
/// With positions `x_k` every `T`, an encoder step `Δ` and a window of `n` periods,
///
/// ```text
/// v = (x_k − x_{k−n}) / (n T)
/// ```
///
/// where `n ≤ 16` is the largest such that, for it and every shorter window, no position in the
/// window is more than `Δ` from the line through its ends, on any axis. At constant velocity and
/// with positions wrong by at most `Δ/2` (rounded) or by `0` to `Δ` (cut off), the window is 16
/// periods and `|v − v_true| ≤ Δ / (16 T)` on each axis: a sixteenth of the error of the plain
/// difference. At a jump the window is one period, so nothing is delayed.
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
/// assert_eq!(estimator.update(Vector([0.5, 0.25])), Vector([0.0, 0.0]));
/// assert_eq!(estimator.update(Vector([0.75, 0.25])), Vector([250.0, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct VelocityEstimator<const D: usize> {
    rate: f64,
    /// How far from the line a position may be [m].
    step: f64,
    /// A ring buffer: from the newest position on, each next one is older.
    positions: [Point<D>; LONGEST],
    newest: usize,
    known: usize,
    window: usize,
}

impl<const D: usize> VelocityEstimator<D> {
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
            newest: 0,
            known: 0,
            window: 0,
        })
    }

    /// Adds the `position` of the next tick [m] and returns the velocity [m/s].
    ///
    /// The velocity is zero at the first position. A position that is not finite clears the
    /// window and gives zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most 16 positions
    /// an axis.
    #[must_use]
    pub fn update(&mut self, position: Point<D>) -> Vector<f64, D> {
        if !position.is_finite() {
            self.reset();
            return Vector::ZERO;
        }
        let longest = if self.step > 0.0 { self.known } else { self.known.min(1) };
        self.window = self.window_to(position, longest);
        let velocity = match self.way(position, self.window) {
            Some(way) => way * self.rate,
            None => Vector::ZERO,
        };
        self.newest = (self.newest + LONGEST - 1) % LONGEST;
        if let Some(place) = self.positions.get_mut(self.newest) {
            *place = position;
        }
        self.known = (self.known + 1).min(LONGEST);
        if !velocity.is_finite() {
            self.window = 0;
            return Vector::ZERO;
        }
        velocity
    }

    /// The longest window up to `position` in which the positions lie on a line.
    #[inline]
    fn window_to(&self, position: Point<D>, longest: usize) -> usize {
        // A line from the newest position passes within a step of every position of the window
        // if its displacement per period lies between these bounds.
        let (mut least, mut most) = ([f64::NEG_INFINITY; D], [f64::INFINITY; D]);
        for window in 1..=longest {
            let Some(way) = self.way(position, window) else { return window - 1 };
            let step = self.step * per_window(window);
            for ((way, least), most) in way.0.iter().zip(&mut least).zip(&mut most) {
                // Written so that NaN ends the window.
                let is_on_line = *least <= *way && *way <= *most;
                if !is_on_line {
                    return window - 1;
                }
                // Plain comparisons compile to one instruction each; `f64::max` must also treat
                // NaN.
                *least = if *least > way - step { *least } else { way - step };
                *most = if *most < way + step { *most } else { way + step };
            }
        }
        longest
    }

    /// The mean displacement per period over `window` periods; `None` for a window of zero.
    #[inline]
    fn way(&self, position: Point<D>, window: usize) -> Option<Vector<f64, D>> {
        let oldest = self.positions.get((self.newest + window.checked_sub(1)?) % LONGEST)?;
        Some((position - *oldest) * per_window(window))
    }

    /// Forgets all positions.
    pub fn reset(&mut self) {
        self.known = 0;
        self.window = 0;
    }

    /// The number of periods over which the last velocity was taken; 0 without a velocity.
    #[must_use]
    pub fn window(&self) -> usize {
        self.window
    }
}

/// Converted by way of `u32`, because that conversion is one instruction.
#[inline]
fn per_window(window: usize) -> f64 {
    1.0 / f64::from(window as u32)
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
                    let seen = Vector([quantise(x / step) * step, 0.0]);
                    let error = (estimator.update(seen).0[0] - velocity).abs();
                    let n = estimator.window();
                    assert_eq!(n, LONGEST.min(tick as usize));
                    assert!(n == 0 || error <= step * RATE / n as f64 * (1.0 + 1e-9));
                }
            }
        }
    }

    #[test]
    fn a_large_step_shows_in_the_same_tick() {
        let mut estimator = VelocityEstimator::new(RATE, 1e-5).unwrap();
        for _ in 0..50 {
            assert_eq!(estimator.update(Vector([0.01, 0.0])), Vector::ZERO);
        }
        assert_eq!(estimator.window(), LONGEST);
        let velocity = estimator.update(Vector([0.011, 0.0]));
        assert!((velocity - Vector([1.0, 0.0])).norm() < 1e-12);
        assert_eq!(estimator.window(), 1);
    }

    #[test]
    fn a_position_that_is_not_finite_starts_anew() {
        let mut estimator = VelocityEstimator::new(RATE, 1e-5).unwrap();
        let _ = estimator.update(Vector([0.0, 0.0]));
        assert!(estimator.update(Vector([0.1, 0.0])).norm() > 1.0);
        assert_eq!(estimator.update(Vector([f64::NAN, 0.0])), Vector::ZERO);
        assert_eq!(estimator.update(Vector([5.0, 0.0])), Vector::ZERO);
        assert_eq!(estimator.update(Vector([5.0, 0.0])), Vector::ZERO);
        let _ = estimator.update(Vector([f64::MAX, 0.0]));
        assert_eq!(estimator.update(Vector([-f64::MAX, 0.0])), Vector::ZERO);
    }

    #[test]
    fn wrong_numbers_are_named() {
        let error = VelocityEstimator::<3>::new(0.0, 0.0).unwrap_err();
        assert_eq!(error.to_string(), "rate must be from 1e-6 to 1e9, got 0 Hz");
        assert!(VelocityEstimator::<3>::new(1e3, -1e-6).is_err());
        assert!(VelocityEstimator::<3>::new(1e3, f64::NAN).is_err());
    }
}
