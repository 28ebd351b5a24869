// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether the program is alive, as its frames show it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Pulse;

/// Between two beats: several come before a page says that it hears nothing.
const BEAT: Duration = Duration::from_millis(100);

/// How long the thread that reads sockets, or a servo, may stand still.
const SILENCE: Duration = Duration::from_millis(300);

/// The ticks that a servo may be late before it counts as frozen.
const LATE_TICKS: f64 = 5.0;

/// Counts while the thread that reads sockets goes on, and the servo as its clock says: if one of them
/// hangs, or the servo takes no stop, a frame still comes, but its count stays.
#[derive(Debug)]
pub(super) struct Heartbeat {
    pulse: Arc<Pulse>,
    count: u16,
    beaten: Option<Instant>,
    /// The pulse, and when it was seen to change.
    reading: Option<(u64, Instant)>,
    /// The ticks of the servo, and when they were seen to change.
    servo: Option<(u64, Instant)>,
    /// How long the servo may take for its next tick; `None` while its clock is held.
    patience: Option<Duration>,
    /// When the servo last had heeded the emergency stop; `None` before it was watched.
    heeded: Option<Instant>,
}

impl Heartbeat {
    pub(super) fn new(pulse: Arc<Pulse>) -> Self {
        Self {
            pulse,
            count: 0,
            beaten: None,
            reading: None,
            servo: None,
            patience: None,
            heeded: None,
        }
    }

    /// Takes note of the servo's ticks, which should come at `pace` [Hz]; `None` while its clock is held.
    pub(super) fn watch_servo(&mut self, ticks: u64, pace: Option<f64>, now: Instant) {
        renew(&mut self.servo, ticks, now);
        let late = |pace: f64| Duration::try_from_secs_f64(LATE_TICKS / pace);
        self.patience = pace.map(|pace| late(pace).unwrap_or(Duration::MAX).max(SILENCE));
    }

    /// Takes note of whether the servo has heeded the emergency stop.
    pub(super) fn watch_stop(&mut self, is_heeded: bool, now: Instant) {
        if is_heeded || self.heeded.is_none() {
            self.heeded = Some(now);
        }
    }

    /// Takes note that there is no servo.
    pub(super) fn without_servo(&mut self) {
        (self.servo, self.patience, self.heeded) = (None, None, None);
    }

    /// The count for a frame that is sent now.
    pub(super) fn beat(&mut self, now: Instant) -> u16 {
        renew(&mut self.reading, self.pulse.count(), now);
        let is_reading = self.reading.is_some_and(|(_, at)| now - at <= SILENCE);
        let is_ticking = match (self.servo, self.patience) {
            (Some((_, at)), Some(patience)) => now - at <= patience,
            _ => true,
        };
        let is_heeded = self.heeded.is_none_or(|at| now - at <= SILENCE);
        let is_due = self.beaten.is_none_or(|at| now - at >= BEAT);
        if is_reading && is_ticking && is_heeded && is_due {
            self.count = self.count.wrapping_add(1);
            self.beaten = Some(now);
        }
        self.count
    }
}

/// Keeps when a number was seen to change.
fn renew(seen: &mut Option<(u64, Instant)>, number: u64, now: Instant) {
    if seen.is_none_or(|(before, _)| before != number) {
        *seen = Some((number, now));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Duration = Duration::from_millis(16);

    /// The beats in a second of frames: `reads` and `ticks` say what goes on.
    fn beats(reads: bool, ticks: bool, pace: Option<f64>) -> u16 {
        let pulse = Arc::<Pulse>::default();
        let mut heartbeat = Heartbeat::new(Arc::clone(&pulse));
        let mut now = Instant::now();
        let mut tick = 7;
        heartbeat.watch_servo(tick, pace, now);
        heartbeat.beat(now);
        // What stood still before this second began counts as frozen.
        now += SILENCE + FRAME;
        let before = heartbeat.beat(now);
        for _ in 0..63 {
            now += FRAME;
            if reads {
                pulse.beat();
            }
            tick += u64::from(ticks);
            heartbeat.watch_servo(tick, pace, now);
            heartbeat.beat(now);
        }
        heartbeat.count - before
    }

    #[test]
    fn it_beats_while_all_goes_on() {
        assert!((8..=10).contains(&beats(true, true, Some(1000.0))));
        assert_eq!(beats(false, true, Some(1000.0)), 0, "nobody reads");
        assert_eq!(beats(true, false, Some(1000.0)), 0, "the servo is frozen");
        // A clock that is held has no ticks; a slow one has few.
        assert!(beats(true, false, None) >= 8);
        // A servo that does not take a stop is frozen, also where its clock is held.
        let (pulse, now) = (Arc::<Pulse>::default(), Instant::now());
        let mut heartbeat = Heartbeat::new(Arc::clone(&pulse));
        heartbeat.watch_stop(true, now);
        let before = heartbeat.beat(now);
        for frame in 1..63 {
            pulse.beat();
            heartbeat.watch_stop(false, now + frame * FRAME);
            heartbeat.beat(now + frame * FRAME);
        }
        assert!(heartbeat.count - before <= 3, "it beats for {SILENCE:?} and no longer");
        assert!(beats(true, false, Some(1.0)) >= 8);
    }
}
