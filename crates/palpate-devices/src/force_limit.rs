// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a device does with a force that is too large for it.

use palpate_field::Vector;

/// The force that a motor holds: `force` shortened to `max_force`, its direction kept; zero if it
/// is not finite.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn held<const D: usize>(force: Vector<f64, D>, max_force: f64) -> Vector<f64, D> {
    if force.norm() <= max_force {
        force
    } else {
        force.normalized().map_or(Vector::ZERO, |direction| direction * max_force)
    }
}
