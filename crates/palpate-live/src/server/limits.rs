// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much a page may ask for.

use std::time::{Duration, Instant};

/// The most pages at once.
pub(super) const MOST_PAGES: usize = 64;

/// The most connections at once, before they become sockets of pages.
pub(super) const MOST_CONNECTIONS: usize = 256;

/// How long the server waits where the operating system gives it no more sockets.
pub(super) const RECOVERY: Duration = Duration::from_millis(50);

/// The most traces that come or go at once: each is up to 64 MiB of memory.
pub(super) const MOST_TRACES: usize = 4;

/// The largest trace to be replayed [bytes], and how long it may take to come.
pub(super) const LARGEST_TRACE: usize = 64 << 20;
pub(super) const TRACE_PATIENCE: Duration = Duration::from_secs(60);

/// The largest message of a page [bytes].
pub(super) const LARGEST_MESSAGE: usize = 1 << 20;

/// The largest answer, a grid of samples: so much may wait to be written to a socket [bytes].
pub(super) const LARGEST_ANSWER: usize = 20 << 20;

/// The most messages that cannot be read.
pub(super) const MOST_UNREADABLE: u32 = 10;

/// How long a page may take no message, and a connection may send no request.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);

/// Messages a second, and how many may come at once.
const RATE: f64 = 120.0;
const RESERVE: f64 = 60.0;

/// Counts messages against a rate: a bucket that fills evenly, from which each message takes one.
#[derive(Debug)]
pub(super) struct Bucket {
    left: f64,
    at: Instant,
}

impl Bucket {
    pub(super) fn full(now: Instant) -> Self {
        Self { left: RESERVE, at: now }
    }

    /// Takes one; `false` if there is none.
    pub(super) fn take(&mut self, now: Instant) -> bool {
        let passed = now.saturating_duration_since(self.at).as_secs_f64();
        self.at = now;
        self.left = (self.left + RATE * passed).min(RESERVE);
        let has_one = self.left >= 1.0;
        if has_one {
            self.left -= 1.0;
        }
        has_one
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_has_a_reserve_and_fills_evenly() {
        let start = Instant::now();
        let mut bucket = Bucket::full(start);
        let taken =
            |bucket: &mut Bucket, now| (0..1000).take_while(|_| bucket.take(now)).count();
        assert_eq!(taken(&mut bucket, start), 60);
        assert_eq!(taken(&mut bucket, start + Duration::from_millis(250)), 30);
        assert_eq!(taken(&mut bucket, start + Duration::from_secs(100)), 60);
    }
}
