// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When a force that the passivity controller took comes back to a hand at rest.

use crate::passivity::InnerProduct;

/// A hand rests while it stays within this way [m].
const RESTING: f64 = 1e-4;

/// The time for which it must rest before the first lift in a contact [s].
const RESTED: f64 = 0.25;

/// The longest time for which it must rest [s].
const LONGEST: f64 = 8.0;

/// Tells when to lift a force that the passivity controller took.
///
/// What the controller took from a wall stays taken while nothing moves, because a resting hand
/// puts no energy in. So once a hand has rested in a wall for a quarter of a second, the force is
/// lifted. If the controller acts again meanwhile, the next lift waits twice as long, until the
/// hand leaves the wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift<V> {
    /// Where the hand began to rest.
    place: Option<V>,
    /// The time for which it has rested [s].
    rested: f64,
    /// The time for which it must rest [s].
    patience: f64,
    is_on: bool,
}

impl<V: InnerProduct> Lift<V> {
    pub(crate) fn new() -> Self {
        Self { place: None, rested: 0.0, patience: RESTED, is_on: false }
    }

    /// One tick in which the hand is at `position`, after a time `elapsed` [s], and something `is
    /// taken` from the force; `None` outside of all bodies. `true` if the force is to be lifted.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self, position: V, elapsed: f64, is_taken: Option<bool>) -> bool {
        let Some(is_taken) = is_taken else {
            *self = Self::new();
            return false;
        };
        let is_resting = self.place.is_some_and(|place| (position - place).norm() <= RESTING);
        if is_resting {
            self.rested += elapsed;
        } else {
            (self.place, self.rested) = (Some(position), 0.0);
        }
        self.is_on &= is_taken;
        if is_taken && !self.is_on && self.rested >= self.patience {
            self.is_on = true;
            self.patience = (2.0 * self.patience).min(LONGEST);
        }
        self.is_on
    }

    /// Ends the lift, because the controller acts.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn end(&mut self) {
        (self.is_on, self.rested) = (false, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Vector;

    use super::*;

    #[test]
    fn a_lift_waits_for_rest_and_twice_as_long_the_next_time() {
        let mut lift = Lift::new();
        let ticks = |lift: &mut Lift<_>, x: f64| {
            let begins = (0..).find(|_| lift.step(Vector([x, 0.0, 0.0]), 0.125, Some(true)));
            begins.unwrap_or_default()
        };
        assert_eq!(ticks(&mut lift, 0.0), 2);
        // It goes on while the hand is moved.
        assert!(lift.step(Vector([0.01, 0.0, 0.0]), 0.125, Some(true)));
        lift.end();
        assert_eq!(ticks(&mut lift, 0.02), 4);
        assert!(!lift.step(Vector([0.02, 0.0, 0.0]), 0.125, Some(false)));
        assert!(!lift.step(Vector([0.02, 0.0, 0.0]), 0.125, None));
        assert_eq!(ticks(&mut lift, 0.02), 2);
    }
}
