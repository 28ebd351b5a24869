// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a limit takes from a force.

use palpate_device::shortened;
use palpate_field::Vector;

/// A force that a limit shortened.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    /// What is left of it [N].
    pub(crate) force: Vector<f64, 3>,
    /// What was taken from its length [N].
    pub(crate) taken: f64,
}

/// `force` shortened to `max_force` [N]; what is not finite becomes zero, and counts as nothing taken.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
#[inline]
pub(crate) fn cut(force: Vector<f64, 3>, max_force: f64) -> Cut {
    match shortened(force, max_force) {
        None => Cut { force, taken: 0.0 },
        Some(short) => {
            let taken = force.norm() - short.norm();
            Cut { force: short, taken: if taken <= f64::MAX { taken } else { 0.0 } }
        }
    }
}

/// A wanted force before the stages of a chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted<V> {
    /// What is left of it [N].
    pub(crate) force: V,
    /// Its size before anything was taken [N].
    pub(crate) effort: f64,
    /// What was taken from its length [N].
    pub(crate) cut: f64,
}
