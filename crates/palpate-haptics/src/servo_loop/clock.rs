// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Clocks: reading the time and waiting for a deadline.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::priority::Priority;

/// A monotonic clock.
///
/// The servo loop reads the clock twice a tick. A test can pass a [`VirtualClock`] and advance
/// it.
pub trait Clock {
    /// The time since a fixed moment before the run.
    fn now(&mut self) -> Duration;

    /// Returns at `deadline`, or at once if `deadline` has passed.
    fn wait_until(&mut self, deadline: Duration);
}

/// How long before a deadline the wall clock stops sleeping and starts to spin. A sleep
/// overruns by 0.1 ms on an idle desktop system; spinning longer would only heat a core.
const SPIN: Duration = Duration::from_micros(200);

/// The same for a thread of raised priority, which wakes sooner. Shorter than a period at 10
/// kHz: Linux suspends a raised thread for 50 ms if it did not sleep for 950 ms.
const RAISED_SPIN: Duration = Duration::from_micros(70);

/// The monotonic clock of the machine; sleeps, then spins up to the deadline.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    start: Instant,
    spin: Duration,
}

impl WallClock {
    /// A clock that starts at zero now, and spins for the last 0.2 ms before a deadline.
    #[must_use]
    pub fn new() -> Self {
        Self::spinning_for(SPIN)
    }

    /// A clock for a thread of this priority: a thread of raised priority wakes sooner and
    /// spins only for the last 0.07 ms.
    #[must_use]
    pub fn suited_to(priority: &Priority) -> Self {
        Self::spinning_for(if *priority == Priority::Raised { RAISED_SPIN } else { SPIN })
    }

    /// A clock that starts at zero now, and spins for the last `spin` before a deadline. With
    /// zero it only sleeps; with a time longer than any wait it never sleeps.
    ///
    /// ```
    /// use std::time::Duration;
    /// use palpate_haptics::servo_loop::{Clock, WallClock};
    ///
    /// let mut never_asleep = WallClock::spinning_for(Duration::MAX);
    /// never_asleep.wait_until(Duration::from_micros(50));
    /// assert!(never_asleep.now() >= Duration::from_micros(50));
    /// ```
    #[must_use]
    pub fn spinning_for(spin: Duration) -> Self {
        Self { start: Instant::now(), spin }
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
        if early > self.spin {
            std::thread::sleep(early - self.spin);
        }
        while self.start.elapsed() < deadline {
            std::hint::spin_loop();
        }
    }
}

/// A clock on which waiting takes no real time, or ends when a [driver](ClockDriver) advances
/// the clock; runs do not depend on the machine's speed.
///
/// ```
/// use std::time::Duration;
/// use palpate_haptics::servo_loop::{Clock, VirtualClock};
///
/// let mut clock = VirtualClock::new();
/// clock.wait_until(Duration::from_secs(3600));
/// assert_eq!(clock.now(), Duration::from_secs(3600));
/// ```
#[derive(Debug, Default)]
pub struct VirtualClock {
    now: Duration,
    gate: Option<Arc<Gate>>,
}

impl VirtualClock {
    /// A clock at zero that jumps to every deadline at once.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A clock at zero that another thread advances. When its driver is dropped, the clock
    /// jumps to every deadline at once.
    ///
    /// ```
    /// use std::time::Duration;
    /// use palpate_haptics::servo_loop::{Clock, VirtualClock};
    ///
    /// let (mut clock, mut driver) = VirtualClock::driven();
    /// let sleeper = std::thread::spawn(move || clock.wait_until(Duration::from_secs(2)));
    /// driver.advance(Duration::from_secs(1));
    /// assert!(!sleeper.is_finished());
    /// driver.advance(Duration::from_secs(1));
    /// sleeper.join().unwrap();
    /// ```
    #[must_use]
    pub fn driven() -> (Self, ClockDriver) {
        let gate = Arc::new(Gate::default());
        (Self { now: Duration::ZERO, gate: Some(gate.clone()) }, ClockDriver { gate })
    }
}

impl Clock for VirtualClock {
    fn now(&mut self) -> Duration {
        self.now
    }

    fn wait_until(&mut self, deadline: Duration) {
        if let Some(gate) = &self.gate {
            let mut state = gate.state();
            while state.allowed < deadline && !state.has_lost_driver {
                state.waits_for = Some(deadline);
                gate.changed.notify_all();
                state = gate.wait(state);
            }
            state.waits_for = None;
        }
        self.now = self.now.max(deadline);
    }
}

impl Drop for VirtualClock {
    fn drop(&mut self) {
        if let Some(gate) = &self.gate {
            gate.state().has_lost_clock = true;
            gate.changed.notify_all();
        }
    }
}

/// Advances a [`VirtualClock`] on which another thread waits.
#[derive(Debug)]
pub struct ClockDriver {
    gate: Arc<Gate>,
}

impl ClockDriver {
    /// Advances the clock by `time`. Returns when the other thread has reached that time: it
    /// waits for a later deadline, or has dropped the clock.
    pub fn advance(&mut self, time: Duration) {
        let mut state = self.gate.state();
        state.allowed += time;
        self.gate.changed.notify_all();
        let is_busy = |state: &GateState| {
            let waits = state.waits_for.is_some_and(|deadline| deadline > state.allowed);
            !(waits || state.has_lost_clock)
        };
        while is_busy(&state) {
            state = self.gate.wait(state);
        }
    }
}

impl Drop for ClockDriver {
    fn drop(&mut self) {
        self.gate.state().has_lost_driver = true;
        self.gate.changed.notify_all();
    }
}

/// The state on which the thread of a virtual clock and its driver wait for each other.
#[derive(Debug, Default)]
struct Gate {
    state: Mutex<GateState>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct GateState {
    /// The latest time that the clock may show.
    allowed: Duration,
    waits_for: Option<Duration>,
    has_lost_clock: bool,
    has_lost_driver: bool,
}

impl Gate {
    // The state is valid even if a thread panicked while it held the lock.
    fn state(&self) -> MutexGuard<'_, GateState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, GateState>) -> MutexGuard<'a, GateState> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }
}
