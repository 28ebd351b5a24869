// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a force follows an edit of the bodies.

use palpate_field::Vector;

use palpate_device::shortened;

/// The most by which a force changes in a tick after an edit [N]: a hand does not feel it as a kick.
/// With more, an edit of a few millimetres would be a blow; with less, a wall would give way under
/// the hand meanwhile.
const STEP: f64 = 0.3;

/// Follows a wanted force by 0.3 N a tick, from an edit on until it has caught up.
///
/// A force of zero is followed at once: then nothing pushes, and what lingered would push a hand
/// that nothing touches.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// The most by which the force changes in a tick [N]; for a torque [N·m].
    step: f64,
    last: Vector<f64, 3>,
    is_on: bool,
}

impl Approach {
    /// For forces, or for torques where a radian counts as the length `unit` [m].
    #[must_use]
    pub fn new(unit: f64) -> Self {
        Self { step: STEP * unit, last: Vector::ZERO, is_on: false }
    }

    /// Takes as large steps as before where a radian counts as a length that is so many times
    /// `longer`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, longer: f64) {
        self.step *= longer;
    }

    /// Begins, from the last force on.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn begin(&mut self) {
        self.is_on = true;
    }

    /// One tick: the force for the force `wanted`; `None` if the force had caught up before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, wanted: Vector<f64, 3>) -> Option<Vector<f64, 3>> {
        if !self.is_on {
            self.last = wanted;
            return None;
        }
        let change = shortened(wanted - self.last, self.step);
        match change.filter(|_| wanted != Vector::ZERO) {
            Some(change) => self.last += change,
            None => (self.last, self.is_on) = (wanted, false),
        }
        Some(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_goes_straight_to_the_wanted_one_and_is_free_then() {
        let mut approach = Approach::new(1.0);
        assert_eq!(approach.step(Vector([0.0, 1.0, 0.0])), None);
        approach.begin();
        let along = [0.6, 0.2].map(|x| Vector([x, 1.0, 0.0]));
        assert_eq!(approach.step(along[0]), Some(Vector([0.3, 1.0, 0.0])));
        assert_eq!(approach.step(along[1]), Some(along[1]));
        assert_eq!(approach.step(Vector([0.0, 9.0, 0.0])), None);
    }

    #[test]
    fn a_force_that_ends_ends_at_once() {
        let mut approach = Approach::new(0.5);
        assert_eq!(approach.step(Vector([0.0, 1.0, 0.0])), None);
        approach.begin();
        assert_eq!(approach.step(Vector([0.0, 2.0, 0.0])), Some(Vector([0.0, 1.15, 0.0])));
        assert_eq!(approach.step(Vector::ZERO), Some(Vector::ZERO));
        assert_eq!(approach.step(Vector([0.0, 2.0, 0.0])), None);
    }
}
