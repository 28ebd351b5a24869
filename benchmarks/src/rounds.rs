// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Interleaved rounds: every subject once a round, so that what disturbs the
//! machine disturbs all alike.

use std::hint::black_box;
use std::time::Instant;

/// Rounds; the median of them is reported.
const ROUNDS: usize = 21;

/// What a subject is repeated for in a round at least [ns].
const LONG_ENOUGH: f64 = 2e6;

/// Something to measure.
pub(crate) struct Subject<'a> {
    /// The key of its row, without `.ns`.
    pub(crate) key: String,
    /// Points, or other units, of one run.
    pub(crate) units: usize,
    /// One run. What it returns keeps the work from being dropped.
    pub(crate) run: Box<dyn FnMut() -> f64 + 'a>,
}

impl<'a> Subject<'a> {
    pub(crate) fn new(
        key: impl Into<String>,
        units: usize,
        run: impl FnMut() -> f64 + 'a,
    ) -> Self {
        Self { key: key.into(), units, run: Box::new(run) }
    }
}

/// The median time of each subject a unit [ns], in their order.
pub(crate) fn measure(subjects: &mut [Subject<'_>]) -> Vec<(String, f64)> {
    let repeats: Vec<usize> = subjects
        .iter_mut()
        .map(|subject| {
            // Once to warm up, once to see how long it takes.
            black_box((subject.run)());
            let once = time(|| (subject.run)(), 1).max(1.0);
            ((LONG_ENOUGH / once).ceil() as usize).max(1)
        })
        .collect();
    let mut times = vec![Vec::with_capacity(ROUNDS); subjects.len()];
    for _ in 0..ROUNDS {
        for ((subject, repeats), times) in subjects.iter_mut().zip(&repeats).zip(&mut times) {
            let run = time(|| (subject.run)(), *repeats);
            times.push(run / (*repeats * subject.units) as f64);
        }
    }
    subjects
        .iter()
        .zip(times)
        .map(|(subject, mut times)| {
            times.sort_by(f64::total_cmp);
            (subject.key.clone(), times[ROUNDS / 2])
        })
        .collect()
}

/// The time of `repeats` runs [ns].
fn time(mut run: impl FnMut() -> f64, repeats: usize) -> f64 {
    let start = Instant::now();
    for _ in 0..repeats {
        black_box(run());
    }
    start.elapsed().as_nanos() as f64
}
