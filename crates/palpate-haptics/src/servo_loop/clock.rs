// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Clocks.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use palpate_device::NumberError;

use super::pacer::Priority;
use crate::StopSwitch;

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

/// How often a clock that is held looks whether it goes on.
const LOOK: Duration = Duration::from_millis(1);

/// The longest sleep of a clock: a change of speed is seen that soon.
const LONGEST_SLEEP: Duration = Duration::from_millis(5);

/// The least speed of a clock that is not held.
const SLOWEST: f64 = 0.001;

/// The clock of the machine at a speed that a [`ClockSpeed`] sets: for servos with simulated
/// devices, to look closely at what they do.
///
/// A real device feels its forces in real time, whatever a clock says: forces of a slow servo
/// would be late on it, and those of a held one would stay. Run it on a [`WallClock`].
///
/// # Examples
///
/// ```
/// use std::time::Duration;
///
/// use palpate_haptics::servo_loop::{Clock, Priority, ScaledClock};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (mut clock, speed) = ScaledClock::new(&Priority::Normal);
/// speed.set(0.0)?; // held
/// speed.step(2);
/// let from = clock.now();
/// clock.wait_until(from + Duration::from_secs(60)); // the first step
/// clock.wait_until(from + Duration::from_secs(120)); // the second
/// assert_eq!(clock.now(), from + Duration::from_secs(120));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct ScaledClock {
    wall: WallClock,
    shared: Arc<Shared>,
    /// The time of this clock at the time `since` of the machine's.
    time: Duration,
    since: Duration,
    speed: f64,
    /// The emergency stop that lets a tick come, and its state at the last look.
    stop: Option<(StopSwitch, StopState)>,
}

/// The number of stops, and whether the last one holds.
type StopState = (u64, bool);

/// What clock and handle share.
#[derive(Debug)]
struct Shared {
    /// The bits of the speed.
    speed: AtomicU64,
    /// Waits that end at once while the clock is held.
    steps: AtomicU64,
}

/// Sets the speed of a [`ScaledClock`], from any thread. When it is dropped, the clock runs in real
/// time.
#[derive(Debug)]
pub struct ClockSpeed {
    shared: Arc<Shared>,
}

impl ScaledClock {
    /// A clock for a thread of this priority, in real time until its speed is set.
    #[must_use]
    pub fn new(priority: &Priority) -> (Self, ClockSpeed) {
        let shared = Arc::new(Shared {
            speed: AtomicU64::new(1.0_f64.to_bits()),
            steps: AtomicU64::new(0),
        });
        let clock = Self {
            wall: WallClock::suited_to(priority),
            shared: Arc::clone(&shared),
            time: Duration::ZERO,
            since: Duration::ZERO,
            speed: 1.0,
            stop: None,
        };
        (clock, ClockSpeed { shared })
    }

    /// The same clock, which lets a tick come when this switch is pressed or released, however slow it
    /// is: a servo heeds its emergency stop in a tick alone.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use palpate_haptics::StopSwitch;
    /// use palpate_haptics::servo_loop::{Clock, Priority, ScaledClock};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let switch = StopSwitch::new();
    /// let (clock, speed) = ScaledClock::new(&Priority::Normal);
    /// let mut clock = clock.heeding(switch.clone());
    /// speed.set(0.0)?; // held
    /// let next = clock.now() + Duration::from_secs(60);
    /// switch.stop();
    /// clock.wait_until(next); // does not wait
    /// assert_eq!(clock.now(), next);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn heeding(self, stop: StopSwitch) -> Self {
        let state = state_of(&stop);
        Self { stop: Some((stop, state)), ..self }
    }

    /// Whether the emergency stop was pressed or released since the last look.
    fn has_new_stop(&mut self) -> bool {
        let Some((stop, seen)) = &mut self.stop else { return false };
        let now = state_of(stop);
        std::mem::replace(seen, now) != now
    }

    /// Goes on to the present with the speed until now, and takes the new one.
    fn catch_up(&mut self) {
        let wall = self.wall.now();
        self.time += wall.saturating_sub(self.since).mul_f64(self.speed);
        self.since = wall;
        self.speed = f64::from_bits(self.shared.speed.load(Ordering::Relaxed));
    }

    fn takes_step(&self) -> bool {
        let one_less = |steps: u64| steps.checked_sub(1);
        let steps = &self.shared.steps;
        steps.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less).is_ok()
    }
}

fn state_of(stop: &StopSwitch) -> StopState {
    (stop.stops(), stop.is_stopped())
}

impl Clock for ScaledClock {
    fn now(&mut self) -> Duration {
        self.catch_up();
        self.time
    }

    fn wait_until(&mut self, deadline: Duration) {
        loop {
            self.catch_up();
            if self.time >= deadline {
                return;
            }
            if self.has_new_stop() {
                self.time = deadline;
                return;
            }
            if self.speed == 0.0 {
                if self.takes_step() {
                    self.time = deadline;
                    return;
                }
                std::thread::sleep(LOOK);
                continue;
            }
            let left = (deadline - self.time).div_f64(self.speed);
            let wall = self.wall.now();
            self.wall.wait_until(wall + left.min(LONGEST_SLEEP));
        }
    }
}

impl ClockSpeed {
    /// Sets the speed: 1 is real time, a half is half as fast, 0 holds the clock.
    ///
    /// # Errors
    ///
    /// If the speed is neither 0 nor from 0.001 to 1.
    pub fn set(&self, speed: f64) -> Result<(), NumberError> {
        if speed != 0.0 && !(SLOWEST..=1.0).contains(&speed) {
            return Err(NumberError::new("the speed", "0, or from 0.001 to 1", speed, ""));
        }
        self.shared.steps.store(0, Ordering::Relaxed);
        self.shared.speed.store(speed.to_bits(), Ordering::Relaxed);
        Ok(())
    }

    /// The speed.
    #[must_use]
    pub fn get(&self) -> f64 {
        f64::from_bits(self.shared.speed.load(Ordering::Relaxed))
    }

    /// Lets so many waits of a held clock end: a servo that does not rehearse waits once for each
    /// tick.
    pub fn step(&self, ticks: u64) {
        self.shared.steps.fetch_add(ticks, Ordering::Relaxed);
    }
}

impl Drop for ClockSpeed {
    fn drop(&mut self) {
        self.shared.speed.store(1.0_f64.to_bits(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod scaled_clock_tests {
    use super::*;

    #[test]
    fn a_slow_clock_shows_a_part_of_the_time() {
        let (mut clock, speed) = ScaledClock::new(&Priority::Normal);
        let mut wall = WallClock::new();
        speed.set(0.25).unwrap();
        let (from, start) = (clock.now(), wall.now());
        clock.wait_until(from + Duration::from_millis(5));
        let (passed, real) = (clock.now() - from, wall.now() - start);
        assert!(passed >= Duration::from_millis(5));
        // Nothing is as late as to make a fast clock of it.
        assert!(real.as_secs_f64() >= 0.019, "{real:?}");
    }

    #[test]
    fn a_held_clock_goes_on_when_its_handle_is_dropped() {
        let (mut clock, speed) = ScaledClock::new(&Priority::Normal);
        speed.set(0.0).unwrap();
        let held = clock.now();
        assert_eq!((clock.now(), speed.get()), (held, 0.0));
        let waits = std::thread::spawn(move || {
            clock.wait_until(held + Duration::from_millis(1));
            clock.now()
        });
        drop(speed);
        assert!(waits.join().unwrap() > held);
    }

    /// A stop under a slow clock once waited for the next tick: up to a second.
    #[test]
    fn a_stop_lets_a_tick_come_and_so_does_its_release() {
        let switch = StopSwitch::new();
        let (clock, speed) = ScaledClock::new(&Priority::Normal);
        let mut clock = clock.heeding(switch.clone());
        for slow in [0.001, 0.0] {
            speed.set(slow).unwrap();
            for _ in 0..2 {
                let (number, next) = (switch.stop(), clock.now() + Duration::from_secs(600));
                // What takes steps back does not take this one.
                speed.set(slow).unwrap();
                clock.wait_until(next);
                assert!(switch.release_of(number) && clock.now() >= next);
                let next = clock.now() + Duration::from_secs(600);
                clock.wait_until(next);
            }
        }
    }

    #[test]
    fn a_speed_is_from_zero_to_one() {
        let (_clock, speed) = ScaledClock::new(&Priority::Normal);
        for wrong in [-0.5, 1.5, 1e-300, f64::NAN] {
            assert!(speed.set(wrong).is_err(), "{wrong}");
        }
        let error = speed.set(2.0).unwrap_err().to_string();
        assert_eq!(error, "the speed must be 0, or from 0.001 to 1, got 2");
    }
}
