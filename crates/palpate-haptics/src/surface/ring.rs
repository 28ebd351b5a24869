// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ringing after a tap on a surface.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::Impact;

use crate::error::HapticsError;
use palpate_device::NumberError;

/// Ringing ends below this part of its first amplitude.
const SILENCE: f64 = 1e-4;

/// A decaying sinusoid for each tap: `a · v · exp(−d·t) · sin(2π·f·t)` for a tap at normal
/// speed `v` (Okamura, Cutkosky and Dennerlein 2001).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ring {
    amplitude: f64,
    frequency: f64,
    decay: f64,
}

impl Ring {
    pub(crate) fn new(impact: &Impact) -> Result<Self, HapticsError> {
        Ok(Self {
            amplitude: NumberError::check_not_negative(
                "impact.amplitude",
                impact.amplitude,
                "N·s/m",
            )?,
            frequency: NumberError::check_positive("impact.frequency", impact.frequency, "Hz")?,
            decay: NumberError::check_not_negative("impact.decay", impact.decay, "1/s")?,
        })
    }

    /// The ringing that a tap at `speed` [m/s] starts, at `rate` [Hz].
    ///
    /// A frequency above half the rate would only produce its alias, so the tap is silent; so
    /// is a tap whose amplitude overflows.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn struck(&self, speed: f64, rate: f64) -> Ringing {
        let loudest = self.amplitude * speed;
        // Both parts of the phasor may add up to twice the amplitude.
        if self.frequency >= 0.5 * rate || !(2.0 * loudest).is_finite() {
            return Ringing::SILENT;
        }
        let angle = 2.0 * std::f64::consts::PI * self.frequency / rate;
        let shrink = libm::exp(-self.decay / rate);
        Ringing {
            force: 0.0,
            quadrature: loudest,
            turn: (libm::sin(angle) * shrink, libm::cos(angle) * shrink),
            silence: SILENCE * loudest,
        }
    }
}

/// Ringing in progress: a phasor that rotates and decays with each tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ringing {
    /// The force along the normal [N].
    force: f64,
    quadrature: f64,
    turn: (f64, f64),
    silence: f64,
}

impl Ringing {
    pub(crate) const SILENT: Self =
        Self { force: 0.0, quadrature: 0.0, turn: (0.0, 0.0), silence: 0.0 };

    /// The force of this tick along the normal [N]; advances to the next tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self) -> f64 {
        let force = self.force;
        if force.abs() + self.quadrature.abs() <= self.silence {
            *self = Self::SILENT;
            return force;
        }
        let (sin, cos) = self.turn;
        self.force = force * cos + self.quadrature * sin;
        self.quadrature = self.quadrature * cos - force * sin;
        force
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tap_rings_as_its_formula_says() {
        let impact =
            Impact { description: None, amplitude: 3.0, frequency: 100.0, decay: 40.0 };
        let ring = Ring::new(&impact).unwrap();
        let mut ringing = ring.struck(0.5, 1000.0);
        for tick in 0..200 {
            let time = 1e-3 * f64::from(tick);
            let turn = 2.0 * std::f64::consts::PI * 100.0 * time;
            let expected = 1.5 * (-40.0 * time).exp() * turn.sin();
            assert!((ringing.step() - expected).abs() < 1e-12, "{tick}");
        }
        for _ in 0..1000 {
            ringing.step();
        }
        assert_eq!(ringing, Ringing::SILENT);
        assert_eq!(ring.struck(0.5, 150.0), Ringing::SILENT);
    }

    /// A tap at nearly the largest number, as from a broken device, would ring as NaN without
    /// end and remove the force of the spring. Found by fuzzing.
    #[test]
    fn no_blow_rings_without_end() {
        let impact =
            Impact { description: None, amplitude: 2.0, frequency: 100.0, decay: 30.0 };
        let ring = Ring::new(&impact).unwrap();
        for speed in [0.2 * f64::MAX, 0.45 * f64::MAX, f64::MAX, f64::INFINITY, f64::NAN] {
            let mut ringing = ring.struck(speed, 1000.0);
            for _ in 0..1000 {
                assert!(ringing.step().is_finite(), "{speed}");
            }
            assert_eq!(ringing, Ringing::SILENT, "{speed}");
        }
    }
}
