// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How often a stage acted, and how much.

use crate::passivity::InnerProduct;

/// What a stage of the safety chain did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Effect {
    /// Ticks in which the stage changed the force.
    pub ticks: u64,
    /// The largest finite change of the force [N] or of the torque [N·m].
    pub largest: f64,
}

impl Effect {
    /// Counts the action of a stage; `changed` is `None` if the force passed unchanged. Returns
    /// the force after the stage.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn count<V: InnerProduct>(&mut self, before: V, changed: Option<V>) -> V {
        match changed {
            None => before,
            Some(after) => self.note(before, after),
        }
    }

    /// Counts an action that was taken before, by its size.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn count_size(&mut self, change: f64) {
        self.ticks += 1;
        self.largest = self.largest.max(change);
    }

    /// Adds the actions of the same stage in another chain.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn add(&mut self, other: Self) {
        self.ticks += other.ticks;
        self.largest = self.largest.max(other.largest);
    }

    /// Out of line, because forces usually pass unchanged.
    #[cold]
    fn note<V: InnerProduct>(&mut self, before: V, after: V) -> V {
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
