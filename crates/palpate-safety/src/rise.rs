// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The rise of a force that was zeroed.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

/// What lets a force rise again after it was zeroed: at the start, in a placement, by late
/// ticks, an input that is not finite, or an emergency stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Recovery {
    /// It rises at once, by [`SafetyOptions::rise_rate`](crate::SafetyOptions::rise_rate): a hand
    /// that sank into a wall is lifted out gently.
    #[default]
    Rise,
    /// It stays zero until no body pushes the hand, as in CHAI3D's `setWaitForSmallForce`.
    OnceOut,
}

/// A limit on a force that was zeroed, which rises until the force is below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rise {
    /// The increase of the limit in a tick [N].
    step: f64,
    recovery: Recovery,
    /// The largest force [N]; infinite if no force was zeroed.
    limit: f64,
    /// Whether the limit waits until the hand is out.
    is_waiting: bool,
}

impl Rise {
    /// A rise from zero by `rise_rate` [N/s], at `rate` [Hz].
    pub(crate) fn new(rise_rate: f64, recovery: Recovery, rate: f64) -> Self {
        let is_waiting = recovery == Recovery::OnceOut;
        Self { step: rise_rate / rate, recovery, limit: 0.0, is_waiting }
    }

    /// Rises by so many times the step.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, longer: f64) {
        self.step *= longer;
    }

    /// Lowers the limit to `force` [N], from where it rises.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn restart(&mut self, force: f64) {
        // `min` ignores NaN.
        self.limit = self.limit.min(if force >= 0.0 { force } else { 0.0 });
        self.is_waiting = self.recovery == Recovery::OnceOut;
    }

    /// One tick: the part, in [0, 1], of the sum of a force `wanted` by bodies and a `free` one
    /// that may pass; `None` if the force had risen before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn step<const D: usize>(
        &mut self,
        wanted: Vector<f64, D>,
        free: Vector<f64, D>,
    ) -> Option<f64> {
        (self.limit < f64::INFINITY).then(|| self.rise(wanted, free))
    }

    #[cold]
    fn rise<const D: usize>(&mut self, wanted: Vector<f64, D>, free: Vector<f64, D>) -> f64 {
        self.is_waiting &= wanted != Vector::ZERO;
        if !self.is_waiting {
            self.limit += self.step;
        }
        let force = (wanted + free).norm();
        if force <= self.limit {
            self.limit = f64::INFINITY;
            return 1.0;
        }
        self.limit / force
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(rise: &mut Rise, forces: &[f64]) -> Vec<f64> {
        let part =
            |rise: &mut Rise, x| rise.step(Vector([x, 0.0]), Vector::ZERO).unwrap_or(1.0);
        forces.iter().map(|x| x * part(rise, *x)).collect()
    }

    #[test]
    fn it_rises_until_it_has_caught_up() {
        let mut rise = Rise::new(20.0, Recovery::Rise, 10.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 5.0, 9.0]), [2.0, 4.0, 5.0, 9.0]);
        assert_eq!(rise.step(Vector([0.0, 9.0]), Vector::ZERO), None);
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0]), [5.0, 7.0]);
        rise.restart(f64::NAN);
        assert_eq!(steps(&mut rise, &[8.0]), [2.0]);
    }

    #[test]
    fn it_waits_until_the_hand_is_out() {
        let mut rise = Rise::new(20.0, Recovery::OnceOut, 10.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 0.0, 8.0]), [0.0, 0.0, 0.0, 8.0]);
        rise.restart(0.0);
        assert_eq!(rise.step(Vector::ZERO, Vector([0.0, 4.0])), Some(0.5));
        assert_eq!(steps(&mut rise, &[16.0, 4.0]), [4.0, 4.0]);
    }
}
