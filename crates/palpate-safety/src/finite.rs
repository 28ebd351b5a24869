// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The last number that is not one.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use crate::PortState;

/// `true` if forces, position and velocity are numbers.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn is_sound<const D: usize>(wanted: Vector<f64, D>, state: &PortState<D>) -> bool {
    // Zero times a number is zero; times what is none, NaN.
    let vectors = [state.position, state.velocity, state.free_force];
    let nothing = vectors.into_iter().fold(wanted * 0.0, |sum, vector| sum + vector * 0.0);
    nothing == Vector::ZERO
}

/// No force, unless what led to `force` was sound and it is finite.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn guarded<const D: usize>(
    force: Vector<f64, D>,
    sound: bool,
) -> Option<Vector<f64, D>> {
    (!(sound && force.is_finite())).then_some(Vector::ZERO)
}
