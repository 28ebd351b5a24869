// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The pull of magnets on a contact point.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;
use palpate_safety::{Approach, Change};

/// The pull of magnets, which follows step by step where a body jumps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Magnetism {
    approach: Approach,
    pull: Vector<f64, 3>,
}

impl Magnetism {
    /// No pull.
    pub(crate) fn new() -> Self {
        Self { approach: Approach::new(1.0), pull: Vector::ZERO }
    }

    /// The pull of the last tick [N].
    pub(crate) fn pull(&self) -> Vector<f64, 3> {
        self.pull
    }

    /// The pull of a tick for the `whole` one [N]. After a jump it comes and goes by 0.3 N a tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn follow(&mut self, whole: Vector<f64, 3>, has_jumped: bool) -> Vector<f64, 3> {
        if has_jumped {
            self.approach.begin(Change::HandedOver);
        }
        self.pull = self.approach.step(whole, 0.0).unwrap_or(whole);
        self.pull
    }
}
