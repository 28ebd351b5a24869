// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What time it is, and waiting for a later one.

use std::time::{Duration, Instant};

/// Time that only moves on.
///
/// The servo loop asks it twice a tick. A test gives one that it moves itself.
pub trait Clock {
    /// The time since some moment before the run.
    fn now(&mut self) -> Duration;

    /// Returns at `deadline`, or at once if that has passed.
    fn wait_until(&mut self, deadline: Duration);
}

/// How long before a deadline the wall clock stops sleeping and starts to spin. Sleeping
/// oversleeps by 0.1 ms on an idle desktop system; spinning longer would heat a core in vain.
const SPIN: Duration = Duration::from_micros(200);

/// The monotonic clock of the machine; sleeps, then spins up to the deadline.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    start: Instant,
}

impl WallClock {
    /// A clock that starts at zero now.
    #[must_use]
    pub fn new() -> Self {
        Self { start: Instant::now() }
    }
}

impl Default for WallClock {
    fn default() -> Self {
        Self::new()
    }
}

impl Clock for WallClock {
    fn now(&mut self) -> Duration {
        self.start.elapsed()
    }

    fn wait_until(&mut self, deadline: Duration) {
        let early = deadline.saturating_sub(self.start.elapsed());
        if early > SPIN {
            std::thread::sleep(early - SPIN);
        }
        while self.start.elapsed() < deadline {
            std::hint::spin_loop();
        }
    }
}
