// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Limits on the length of a force.

use palpate_field::Vector;

/// Shortens `force` to `max_force` [N], keeping its direction; zero if it is not finite, whatever
/// the limit, and zero if the limit is negative or NaN.
///
/// ```
/// use palpate_field::Vector;
///
/// let force = palpate_device::limited(Vector([3.0, -4.0, 0.0]), 2.5);
/// assert_eq!(force, Vector([1.5, -2.0, 0.0]));
/// ```
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
#[must_use]
pub fn limited(force: Vector<f64, 3>, max_force: f64) -> Vector<f64, 3> {
    shortened(force, max_force).unwrap_or(force)
}

/// `force` shortened to `max_force` [N]; `None` if it is no longer than that.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
#[must_use]
#[inline]
pub fn shortened(force: Vector<f64, 3>, max_force: f64) -> Option<Vector<f64, 3>> {
    // The force is finite even if the limit is not. Written so that NaN is shortened.
    let most = if max_force > 0.0 { max_force.min(f64::MAX) } else { 0.0 };
    let passes = force.norm() <= most;
    (!passes).then(|| of_length(force, most))
}

/// A vector of length `length` along `force`; zero if `force` is not finite.
#[cold]
fn of_length(force: Vector<f64, 3>, length: f64) -> Vector<f64, 3> {
    // The norm of a huge but finite force overflows; its direction does not.
    force.normalized().map_or(Vector::ZERO, |direction| direction * length)
}

/// The factor in [0, 1] that shortens a force of size `from` to the size `to`; one if `from`
/// is no larger.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
#[must_use]
pub fn shortening(from: f64, to: f64) -> f64 {
    if from > to { to / from } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_keeps_the_direction() {
        assert_eq!(limited(Vector([3.0, -4.0, 0.0]), 2.5), Vector([1.5, -2.0, 0.0]));
        assert_eq!(limited(Vector([3.0, -4.0, 0.0]), 5.0), Vector([3.0, -4.0, 0.0]));
        assert_eq!(limited(Vector([0.0, 1e300, 0.0]), 2.0), Vector([0.0, 2.0, 0.0]));
    }

    /// A negative limit turned a force around, with its own length; NaN was no limit.
    #[test]
    fn a_limit_that_is_no_length_lets_nothing_pass() {
        for limit in [-1e9, -0.0, 0.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(limited(Vector([3.0, -4.0, 0.0]), limit), Vector::ZERO, "{limit}");
        }
    }

    #[test]
    fn a_force_that_is_not_finite_is_none() {
        assert_eq!(limited(Vector([f64::NAN, 1.0, 0.0]), 2.0), Vector::ZERO);
        assert_eq!(limited(Vector([f64::INFINITY, 1.0, 0.0]), 2.0), Vector::ZERO);
        // An infinite force is zero even without a limit. Found by fuzzing.
        assert_eq!(limited(Vector([f64::INFINITY, 1.0, 0.0]), f64::INFINITY), Vector::ZERO);
        let huge = Vector([f64::MAX, -f64::MAX, 0.0]);
        assert!(limited(huge, f64::INFINITY).is_finite());
    }
}
