// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The guard against numbers that are not finite.

use palpate_field::Vector;

use crate::PortState;

/// `true` if forces, position, velocity and the motion of bodies are finite.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn is_sound(wanted: Vector<f64, 3>, state: &PortState) -> bool {
    // Zero times a finite number is zero; zero times infinity or NaN is NaN.
    let vectors = [state.position, state.velocity, state.free_force];
    let nothing = vectors.into_iter().fold(wanted * 0.0, |sum, vector| sum + vector * 0.0);
    nothing == Vector::ZERO && state.bodies.is_finite()
}

/// `force`, or zero if an input or `force` is not finite.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn guarded(force: Vector<f64, 3>, sound: bool) -> Option<Vector<f64, 3>> {
    (!(sound && force.is_finite())).then_some(Vector::ZERO)
}

/// The time `measured` between two positions [s]; `otherwise`, if it is none or cannot be one.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn elapsed(measured: Option<f64>, otherwise: f64) -> f64 {
    measured.filter(|time| *time > 0.0 && *time <= f64::MAX).unwrap_or(otherwise)
}
