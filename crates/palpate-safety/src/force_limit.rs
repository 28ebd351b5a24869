// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The limit on the largest force.

use palpate_field::Vector;

use palpate_device::shortened;

/// Shortens a force to a largest length, keeping its direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForceLimit {
    max_force: f64,
}

impl ForceLimit {
    /// A limit of `max_force` [N].
    pub(crate) fn new(max_force: f64) -> Self {
        Self { max_force }
    }

    /// Lowers the limit; never raises it. A negative one counts as zero, NaN as no limit.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn lower(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.max_force = self.max_force.min(max_force).max(0.0);
    }

    /// The limited force; `None` if it is unchanged.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit(&self, force: Vector<f64, 3>) -> Option<Vector<f64, 3>> {
        shortened(force, self.max_force)
    }
}
