// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The deadline watchdog.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::num::NonZeroU32;

use crate::ramp::Ramp;

/// Lowers the force to zero while ticks are late.
///
/// A force that is held for too long is stale. After a number of consecutive late ticks the
/// force falls to zero; after as many ticks in time it rises again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watchdog {
    limit: u32,
    /// Consecutive ticks that contradict the present state.
    contrary: u32,
    tripped: bool,
    ramp: Ramp,
    trips: u64,
}

impl Watchdog {
    pub(crate) fn new(limit: NonZeroU32, ramp: Ramp) -> Self {
        Self { limit: limit.get(), contrary: 0, tripped: false, ramp, trips: 0 }
    }

    /// The factor on the force in this tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self, is_late: bool) -> f64 {
        self.contrary = if is_late == self.tripped { 0 } else { self.contrary + 1 };
        if self.contrary >= self.limit {
            self.tripped = is_late;
            self.contrary = 0;
            self.trips += u64::from(is_late);
        }
        self.ramp.step(!self.tripped)
    }

    /// The number of times the watchdog tripped.
    pub(crate) fn trips(&self) -> u64 {
        self.trips
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_trips_after_late_ticks_in_a_row_and_recovers() {
        let ramp = Ramp::new(1.0, 2.0, 2.0, 1.0);
        let mut dog = Watchdog::new(NonZeroU32::new(2).unwrap(), ramp);
        let late = [true, false, true, true, false, true, false, false, false, false];
        let parts = late.map(|is_late| dog.step(is_late));
        assert_eq!(parts, [1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0]);
        assert_eq!(dog.trips(), 1);
    }
}
