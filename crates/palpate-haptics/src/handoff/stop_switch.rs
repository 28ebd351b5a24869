// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The emergency stop.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The emergency stop of running servos, for any thread: it sets all forces to zero and releases
/// them again. Clones are the same switch, and so are those of all servos that it was handed to.
///
/// Stops are numbered from 1. [`release_of`](Self::release_of) releases one stop and no later one, so
/// that a release which was meant for an earlier stop cannot lift a new one.
///
/// # Examples
///
/// ```
/// use palpate_haptics::StopSwitch;
///
/// let switch = StopSwitch::new();
/// let first = switch.stop();
/// let second = switch.stop();
/// assert_eq!((first, second, switch.stops()), (1, 2, 2));
/// assert!(!switch.release_of(first) && switch.is_stopped());
/// assert!(switch.release_of(second) && !switch.is_stopped());
/// ```
#[derive(Clone, Debug, Default)]
pub struct StopSwitch {
    /// Twice the number of stops, plus 1 while forces are stopped.
    state: Arc<AtomicU64>,
}

impl StopSwitch {
    /// A switch that stops nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// From the next tick on, all written forces are zero. Returns the number of this stop.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&self) -> u64 {
        // One atomic operation, so that no release comes between.
        let next = |state: u64| (state & !1).wrapping_add(3);
        let before = self
            .state
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, |state| Some(next(state)));
        // The update always succeeds.
        next(before.unwrap_or_default()) / 2
    }

    /// Ends the emergency stop; forces rise from zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release(&self) {
        self.state.fetch_and(!1, Ordering::AcqRel);
    }

    /// Ends the emergency stop of this number; `false`, and nothing changes, if it was released or
    /// another stop came since.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release_of(&self, number: u64) -> bool {
        let (stopped, released) = (2 * number + 1, 2 * number);
        let exchanged =
            self.state.compare_exchange(stopped, released, Ordering::AcqRel, Ordering::Acquire);
        exchanged.is_ok()
    }

    /// The number of stops so far, which is the number of the last one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn stops(&self) -> u64 {
        self.state.load(Ordering::Acquire) / 2
    }

    /// Whether forces are held at zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.state.load(Ordering::Acquire) & 1 == 1
    }
}
