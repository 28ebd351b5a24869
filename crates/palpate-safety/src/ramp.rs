// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A ramp over which forces rise and fall.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// A factor in [0, 1] on a force, which changes linearly in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramp {
    factor: f64,
    rise: f64,
    fall: f64,
}

impl Ramp {
    /// A ramp from 0 to 1 in `rise_time` and back in `fall_time` [s], at `rate` [Hz], which
    /// starts at `factor`. A time of zero gives a jump.
    pub(crate) fn new(factor: f64, rise_time: f64, fall_time: f64, rate: f64) -> Self {
        // A time of zero gives an infinite step, which is clamped to one.
        Self { factor, rise: 1.0 / (rise_time * rate), fall: 1.0 / (fall_time * rate) }
    }

    /// Multiplies the factor by `part`, in [0, 1].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn lower(&mut self, part: f64) {
        // Written so that NaN gives zero.
        self.factor *= if part >= 0.0 { part.min(1.0) } else { 0.0 };
    }

    /// Moves a tick up or down, and returns the factor.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self, up: bool) -> f64 {
        let next = if up { self.factor + self.rise } else { self.factor - self.fall };
        self.factor = next.clamp(0.0, 1.0);
        self.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rises_and_falls_in_its_times() {
        let mut ramp = Ramp::new(0.0, 4.0, 2.0, 1.0);
        let up: Vec<_> = (0..5).map(|_| ramp.step(true)).collect();
        assert_eq!(up, [0.25, 0.5, 0.75, 1.0, 1.0]);
        assert_eq!([ramp.step(false), ramp.step(false), ramp.step(false)], [0.5, 0.0, 0.0]);
        let mut jump = Ramp::new(0.0, 0.0, 0.0, 1.0);
        assert_eq!((jump.step(true), jump.step(false)), (1.0, 0.0));
    }
}
