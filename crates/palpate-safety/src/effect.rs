// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How often a stage acted, and how much.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::passivity::Directed;

/// What a stage of the safety chain did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Effect {
    /// Ticks in which it changed the force.
    pub ticks: u64,
    /// The largest change of the force [N], or of the torque [N·m], of those that are finite.
    pub largest: f64,
}

impl Effect {
    /// Counts what a stage made of a force, which is nothing if it let it pass; returns what
    /// is left of it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn count<V: Directed>(&mut self, before: V, changed: Option<V>) -> V {
        match changed {
            None => before,
            Some(after) => self.note(before, after),
        }
    }

    /// Apart from the way of a force that every stage lets pass.
    #[cold]
    fn note<V: Directed>(&mut self, before: V, after: V) -> V {
        // NaN differs from itself.
        if before != after {
            self.ticks += 1;
            let change = (before - after).norm();
            if change.is_finite() {
                self.largest = self.largest.max(change);
            }
        }
        after
    }
}
