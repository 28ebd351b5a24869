// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The limit on a guide's force, which keeps it passive.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use palpate_device::limited;

/// The two parts of a force [N].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// The part that depends on the position alone.
    pub(crate) spring: Vector<f64, 3>,
    /// The part that dissipates energy.
    pub(crate) damper: Vector<f64, 3>,
}

/// The sum of spring and damper, at most `max_force`: the spring is limited first, then the
/// damper is scaled to what the limit leaves.
///
/// Limiting the sum instead would make the spring force depend on the speed: a spring that is
/// compressed slowly and released fast would give back more energy than it took.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn damped(motion: &Motion, max_force: f64) -> Vector<f64, 3> {
    let spring = limited(motion.spring, max_force);
    let damper = motion.damper;
    let whole = spring + damper;
    if whole.norm() <= max_force {
        return whole;
    }
    // The larger root of ‖spring + λ damper‖² = max_force².
    let (a, b) = (damper.dot(damper), spring.dot(damper));
    let room = (max_force * max_force - spring.dot(spring)).max(0.0);
    let part = ((b * b + a * room).sqrt() - b) / a;
    // Written so that NaN from overflow leaves the damper out; the upper limit corrects
    // rounding.
    let part = if part > 0.0 { part.min(1.0) } else { 0.0 };
    limited(spring + damper * part, max_force)
}
