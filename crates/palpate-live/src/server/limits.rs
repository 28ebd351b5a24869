// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much clients may ask for.

use std::time::{Duration, Instant};

/// The most pages at once.
pub(super) const MOST_PAGES: usize = 64;

/// The most connections at once that have not named the token. A connection is closed for room only
/// after so many later ones: with fewer, a flood would close it before its request comes.
pub(super) const MOST_STRANGERS: usize = 256;

/// The most connections at once that have named it, beside pages.
pub(super) const MOST_KNOWN: usize = 32;

/// How long the server waits where the operating system gives it no more sockets.
pub(super) const ACCEPT_RETRY: Duration = Duration::from_millis(1);

/// The bytes that are read of a connection in a turn: at most so many frames of a socket come at once.
pub(super) const TURN: usize = 4 << 10;

/// The connections that may wait to be accepted: one that finds no room tries again after a second.
pub(super) const BACKLOG: i32 = 4096;

/// The connections that are accepted in a turn.
pub(super) const ACCEPTED: usize = 16;

/// The longest head of a request [bytes].
pub(super) const LONGEST_HEAD: usize = 16 << 10;

/// The requests that may wait to be answered: more are refused.
pub(super) const MOST_REQUESTS: usize = 256;

/// The most traces that come or go at once: each is up to 64 MiB of memory.
pub(super) const MOST_TRACES: usize = 4;

/// The largest trace to be replayed [bytes], and how long it may take to come.
pub(super) const LARGEST_TRACE: usize = 64 << 20;
pub(super) const TRACE_PATIENCE: Duration = Duration::from_secs(60);

/// The largest message of a page [bytes].
pub(super) const LARGEST_MESSAGE: usize = 1 << 20;

/// The bytes that are written to a connection at a time.
pub(super) const CHUNK: usize = 1 << 16;

/// How long a client may leave what is written unread, send no request, or go on sending what counts
/// for nothing.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);

/// Messages of a page a second, and how many may come at once.
const MESSAGES: Rate = Rate { each_second: 120.0, reserve: 60.0 };

/// Bytes of a page's messages a second, and how many may come at once.
const BYTES: Rate = Rate { each_second: 1e6, reserve: 4e6 };

#[derive(Clone, Copy, Debug)]
struct Rate {
    each_second: f64,
    reserve: f64,
}

/// Counts against a rate: a bucket that fills evenly.
#[derive(Debug)]
struct Bucket {
    rate: Rate,
    left: f64,
    at: Instant,
}

impl Bucket {
    fn full(rate: Rate, now: Instant) -> Self {
        Self { rate, left: rate.reserve, at: now }
    }

    /// Takes so much; `false` if there is less.
    fn take(&mut self, much: f64, now: Instant) -> bool {
        let passed = now.saturating_duration_since(self.at).as_secs_f64();
        self.at = now;
        self.left = (self.left + self.rate.each_second * passed).min(self.rate.reserve);
        let is_there = self.left >= much;
        if is_there {
            self.left -= much;
        }
        is_there
    }
}

/// What a page may still send.
#[derive(Debug)]
pub(super) struct Budget {
    messages: Bucket,
    bytes: Bucket,
}

impl Budget {
    pub(super) fn full(now: Instant) -> Self {
        Self { messages: Bucket::full(MESSAGES, now), bytes: Bucket::full(BYTES, now) }
    }

    /// Takes a message of so many bytes.
    ///
    /// # Errors
    ///
    /// Of what the page sent too much.
    pub(super) fn take(&mut self, bytes: usize, now: Instant) -> Result<(), &'static str> {
        if !self.messages.take(1.0, now) {
            return Err("the page sent more than 120 messages a second");
        }
        if !self.bytes.take(bytes as f64, now) {
            return Err("the page sent more than 1 MB a second");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_has_a_reserve_and_fills_evenly() {
        let start = Instant::now();
        let later = |seconds: f64| start + Duration::from_secs_f64(seconds);
        let taken = |budget: &mut Budget, bytes: usize, now| {
            (0..1000).take_while(|_| budget.take(bytes, now).is_ok()).count()
        };
        let mut budget = Budget::full(start);
        assert_eq!(taken(&mut budget, 10, start), 60);
        assert_eq!(taken(&mut budget, 10, later(0.25)), 30);
        assert_eq!(taken(&mut budget, 10, later(100.0)), 60);
        let mut budget = Budget::full(start);
        assert_eq!(taken(&mut budget, 1_000_000, start), 4);
        assert_eq!(taken(&mut budget, 250_000, later(0.5)), 2);
        let why = budget.take(1_000_000, later(0.6)).unwrap_err();
        assert!(why.contains("1 MB"), "{why}");
    }
}
