// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The limit on the continuous force, which protects motors from heat.

use palpate_field::Vector;

use palpate_device::shortened;

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

impl ContinuousLimit {
    /// A limit for `continuous_force` [N], a time constant [s] and `rate` [Hz].
    pub(crate) fn new(continuous_force: f64, time_constant: f64, rate: f64) -> Self {
        let part = -libm::expm1(-1.0 / (time_constant * rate));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_passes_and_a_long_press_does_not() {
        let mut limit = ContinuousLimit::new(2.0, 1.0, 1000.0);
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
        let mut limit = ContinuousLimit::new(2.0, 0.1, 1000.0);
        let wanted = Vector([2.0, 0.0, 0.0]);
        for _ in 0..2000 {
            assert_eq!(limit.limit(wanted), None);
            limit.written(wanted);
        }
        assert!((limit.root_mean_square() - 2.0).abs() < 1e-6);
    }

    #[test]
    fn without_a_continuous_force_nothing_is_changed() {
        let mut limit = ContinuousLimit::new(f64::INFINITY, 0.1, 1000.0);
        limit.written(Vector([1e200, 0.0, 0.0]));
        assert_eq!(limit.limit(Vector([1e200, 1.0, 0.0])), None);
    }
}
