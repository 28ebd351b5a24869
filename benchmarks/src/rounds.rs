// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Interleaved rounds: every subject once a round, so that what disturbs the
//! machine disturbs all alike.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Instant;

use crate::fields::Rows;
use crate::reference::{self, Reference};

/// Rounds; the median of them is reported.
const ROUNDS: usize = 21;

/// What a subject is repeated for in a round at least [ns].
const LONG_ENOUGH: f64 = 2e6;

/// Something to measure.
pub(crate) struct Subject<'a> {
    /// The key of its rows, without what they end in.
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

    /// How often it runs in a round.
    fn repeats(&mut self) -> usize {
        // Once to warm up, once to see how long it takes.
        black_box((self.run)());
        let once = time(|| (self.run)(), 1).max(1.0);
        ((LONG_ENOUGH / once).ceil() as usize).max(1)
    }

    /// The time of a unit in a round [ns].
    fn round(&mut self, repeats: usize) -> f64 {
        time(|| (self.run)(), repeats) / (repeats * self.units) as f64
    }
}

/// What a unit of a subject takes.
pub(crate) struct Measured {
    pub(crate) key: String,
    /// The median of all rounds [ns].
    pub(crate) ns: f64,
    /// Over the reference in the same round; the median of all rounds.
    over_s3: f64,
}

impl Measured {
    /// Adds its rows.
    pub(crate) fn insert(&self, rows: &mut Rows) {
        rows.insert(format!("{}.ns", self.key), self.ns);
        rows.insert(format!("{}{}", self.key, reference::OVER), self.over_s3);
    }
}

/// What each subject takes, in their order, with the reference in every round.
pub(crate) fn measure(subjects: &mut [Subject<'_>], reference: &Reference) -> Vec<Measured> {
    let mut beside = Subject::new(reference::KEY, reference::POINTS, || reference.pass());
    let repeats: Vec<usize> = subjects.iter_mut().map(Subject::repeats).collect();
    let repeats_beside = beside.repeats();
    let mut times = vec![Vec::with_capacity(ROUNDS); subjects.len()];
    let mut ratios = times.clone();
    for _ in 0..ROUNDS {
        let reference = beside.round(repeats_beside);
        let rounds = times.iter_mut().zip(&mut ratios);
        for ((subject, repeats), (times, ratios)) in
            subjects.iter_mut().zip(&repeats).zip(rounds)
        {
            let time = subject.round(*repeats);
            times.push(time);
            ratios.push(time / reference);
        }
    }
    let medians = times.into_iter().zip(ratios);
    subjects
        .iter()
        .zip(medians)
        .map(|(subject, (times, ratios))| Measured {
            key: subject.key.clone(),
            ns: median(times),
            over_s3: median(ratios),
        })
        .collect()
}

/// The median of each row over all runs of a suite.
pub(crate) fn medians(runs: Vec<Rows>) -> Rows {
    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (key, number) in runs.into_iter().flatten() {
        all.entry(key).or_default().push(number);
    }
    all.into_iter().map(|(key, numbers)| (key, median(numbers))).collect()
}

/// The middle of `numbers`, the upper one of two; not a number if there are none.
pub(crate) fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The time of `repeats` runs [ns].
fn time(mut run: impl FnMut() -> f64, repeats: usize) -> f64 {
    let start = Instant::now();
    for _ in 0..repeats {
        black_box(run());
    }
    start.elapsed().as_nanos() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_the_medians_of_their_runs() {
        let run = |number: f64| Rows::from([("a".to_owned(), number)]);
        let mut runs = vec![run(3.0), run(100.0), run(2.0)];
        runs[0].insert("b".into(), 7.0);
        assert_eq!(medians(runs), Rows::from([("a".into(), 3.0), ("b".into(), 7.0)]));
        assert!(median(Vec::new()).is_nan());
    }
}
