// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The slew limit: how fast a force may change.

use palpate_field::Vector;

use palpate_device::shortened;

/// Follows a force on a straight line, by at most a fixed step a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlewLimit {
    /// The largest change a tick [N].
    step: f64,
    last: Vector<f64, 3>,
}

/// How fast a force may change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlewOptions {
    /// The largest change of the force [N/s].
    pub(crate) max_force_rate: f64,
    /// Ticks a second [Hz].
    pub(crate) rate: f64,
}

impl SlewLimit {
    pub(crate) fn new(SlewOptions { max_force_rate, rate }: SlewOptions) -> Self {
        Self { step: max_force_rate / rate, last: Vector::ZERO }
    }

    /// The limited force; `None` if it is unchanged.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit(&mut self, force: Vector<f64, 3>) -> Option<Vector<f64, 3>> {
        match shortened(force - self.last, self.step) {
            None => {
                self.last = force;
                None
            }
            Some(change) => {
                self.last += change;
                Some(self.last)
            }
        }
    }

    /// The last force [N].
    pub(crate) fn last(&self) -> Vector<f64, 3> {
        self.last
    }

    /// Forgets the last force: the next force starts from zero.
    pub(crate) fn restart(&mut self) {
        self.last = Vector::ZERO;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_reached_in_equal_steps() {
        let mut slew = SlewLimit::new(SlewOptions { max_force_rate: 1000.0, rate: 1000.0 });
        let wanted = Vector([0.0, 2.5, 0.0]);
        let steps: Vec<_> = (0..4).map(|_| slew.limit(wanted).unwrap_or(wanted).0[1]).collect();
        assert_eq!(steps, [1.0, 2.0, 2.5, 2.5]);
        slew.restart();
        assert_eq!(slew.limit(wanted), Some(Vector([0.0, 1.0, 0.0])));
        let mut free =
            SlewLimit::new(SlewOptions { max_force_rate: f64::INFINITY, rate: 1000.0 });
        assert_eq!(free.limit(wanted), None);
    }
}
