// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Runs a property a fixed number of times.

use arbitrary::Unstructured;

/// Bytes of entropy a case may draw.
const ENTROPY: usize = 1 << 14;

/// The most complaints shown; complaints that differ only in numbers count as one.
const SHOWN: usize = 12;

/// Checks `property` for the seeds `0..count`.
///
/// A property draws its input from [`Unstructured`] and returns what is wrong
/// with it. The same seed draws the same input on every machine.
///
/// # Panics
///
/// If the property fails; the message has the simplest complaints and their seeds.
pub fn check(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    let mut failures = Vec::new();
    for seed in 0..count {
        let bytes = entropy(seed);
        let guard = Seed(seed);
        let outcome = property(&mut Unstructured::new(&bytes));
        std::mem::forget(guard);
        if let Ok(Err(complaint)) = outcome {
            failures.push((seed, complaint));
        }
    }
    if failures.is_empty() {
        return;
    }
    // The shortest complaints come from the simplest cases.
    failures.sort_by_key(|(_, complaint)| complaint.len());
    let mut kinds = Vec::new();
    let mut shown = Vec::new();
    for (seed, complaint) in &failures {
        let kind: String = complaint.chars().filter(|c| c.is_alphabetic()).collect();
        if !kinds.contains(&kind) && shown.len() < SHOWN {
            shown.push(format!("seed {seed}: {complaint}"));
            kinds.push(kind);
        }
    }
    panic!("{} of {count} cases fail\n{}", failures.len(), shown.join("\n"));
}

/// Checks a `property` that panics if it fails, for the seeds `0..count`. Cases that cannot be
/// drawn are skipped.
///
/// # Panics
///
/// If the property panics, or at least half of the cases cannot be drawn.
pub fn each(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<()>,
) {
    let mut drawn = 0;
    check(count, |u| {
        property(u)?;
        drawn += 1;
        Ok(Ok(()))
    });
    assert!(2 * drawn > count, "only {drawn} of {count} cases could be drawn");
}

/// The bytes of a seed, by SplitMix64 (Steele, Lea and Flood 2014).
#[must_use]
pub fn entropy(seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (0..ENTROPY / 8).flat_map(|_| next().to_le_bytes()).collect()
}

/// Names the seed when a property panics.
struct Seed(u64);

impl Drop for Seed {
    fn drop(&mut self) {
        eprintln!("seed {} panicked", self.0);
    }
}
