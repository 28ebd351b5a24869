// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How long each tick takes, without reading the clock.

use std::time::Instant;

use super::TICKS;
use crate::fields::Rows;

/// The fastest pass of each tick, and beside it of nothing.
pub(super) struct Times {
    ticks: Vec<u64>,
    nothing: Vec<u64>,
}

impl Times {
    pub(super) fn new() -> Self {
        Self { ticks: vec![u64::MAX; TICKS], nothing: vec![u64::MAX; TICKS] }
    }

    /// Times a tick of a pass; `None` is one that does not count.
    pub(super) fn time<T>(&mut self, tick: Option<usize>, run: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let answer = run();
        let time = start.elapsed();
        let nothing = Instant::now().elapsed();
        if let Some(tick) = tick {
            let least = |times: &mut u64, time: u128| *times = (*times).min(time as u64);
            least(&mut self.ticks[tick], time.as_nanos());
            least(&mut self.nothing[tick], nothing.as_nanos());
        }
        answer
    }

    /// Adds the rows of `key`: times less the median of what reading the clock takes.
    pub(super) fn insert(mut self, key: &str, rows: &mut Rows) {
        self.ticks.sort_unstable();
        self.nothing.sort_unstable();
        let clock = self.nothing[(TICKS - 1) / 2];
        let at = |part: f64| {
            self.ticks[((TICKS - 1) as f64 * part) as usize].saturating_sub(clock) as f64
        };
        rows.insert(format!("{key}.p50_ns"), at(0.5));
        rows.insert(format!("{key}.p99_ns"), at(0.99));
        rows.insert(format!("{key}.max_ns"), at(1.0));
        rows.insert(format!("{key}.clock_ns"), clock as f64);
    }
}
