// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Runs a property a fixed number of times.

use std::str::FromStr;

use arbitrary::Unstructured;
use palpate_field::Shape;

use crate::arbitrary::{self as draw, Turn};
use crate::kernels::Space;
use crate::tree::{Solid, Tree};

/// Bytes of entropy a case may draw.
const ENTROPY: usize = 1 << 16;

/// The share of the seeds that run unless `PALPATE_SEEDS` says otherwise; `cargo xtask test --thorough`
/// runs all.
pub const USUAL: f64 = 0.1;

/// The most complaints shown; complaints that differ only in numbers count as one.
const SHOWN: usize = 12;

/// Checks `property` for `count` seeds. Two environment variables change this. `PALPATE_FIRST_SEED`
/// is the first seed; the default is 0. `PALPATE_SEEDS` multiplies the count; the default is
/// [`USUAL`]. At least one seed runs.
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
    numbered(count, |_, u| property(u));
}

/// As [`check`], for a property that takes things in turn: by its seed, so that a seed alone
/// repeats its case.
///
/// # Panics
///
/// As [`check`].
pub fn numbered(
    count: u64,
    property: impl FnMut(usize, &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    run(self::count(count), property);
}

/// As [`check`], with no fewer seeds than `count`: for a test of how often something happens.
///
/// # Panics
///
/// As [`check`].
pub fn in_full(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    run(self::count(count).max(count), |_, u| property(u));
}

/// As [`check`], for these seeds alone: of cases that once failed. They are other cases once a property draws
/// otherwise.
///
/// # Panics
///
/// As [`check`].
pub fn these(
    seeds: &[u64],
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    run_seeds(seeds.iter().copied(), |_, u| property(u));
}

fn run(
    count: u64,
    property: impl FnMut(usize, &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    let first = number_in("PALPATE_FIRST_SEED").unwrap_or(0);
    run_seeds(first..first + count, property);
}

fn run_seeds(
    seeds: impl Iterator<Item = u64>,
    mut property: impl FnMut(usize, &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    let mut failures = Vec::new();
    let mut count = 0;
    for seed in seeds {
        count += 1;
        let bytes = entropy(seed);
        let guard = Seed(seed);
        let mut input = Unstructured::new(&bytes);
        let outcome = property(seed as usize, &mut input);
        // Past its end an input draws zeros: the same case again and again.
        assert!(!input.is_empty(), "{ENTROPY} bytes are too few");
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

/// Checks `property` on `count` random trees and their shapes; their depths go from 1 to `deepest`
/// in turn. Complaints name their tree.
///
/// # Panics
///
/// As [`check`]; also if a tree makes no shape.
pub fn on_trees<const D: usize>(
    count: u64,
    deepest: usize,
    mut property: impl FnMut(
        &mut Unstructured<'_>,
        &Tree<D>,
        &Shape<D>,
    ) -> arbitrary::Result<Result<(), String>>,
) where
    Space: Solid<D> + Turn<D>,
{
    numbered(count, |seed, u| {
        let tree = draw::tree(u, 1 + seed % deepest)?;
        let outcome = match tree.shape() {
            Ok(shape) => property(u, &tree, &shape)?,
            Err(error) => Err(error.to_string()),
        };
        Ok(outcome.map_err(|complaint| format!("{complaint}\n  {tree:?}")))
    });
}

/// Makes two tests of each law, in the plane and in space, by the `on_trees` of the module.
#[macro_export]
macro_rules! in_both_dimensions {
    ($($name:ident: $law:ident, $count:literal, $points:literal;)*) => {
        $(mod $name {
            #[test]
            fn in_the_plane() {
                super::on_trees::<2>($count, $points, super::$law);
            }

            #[test]
            fn in_space() {
                super::on_trees::<3>($count, $points, super::$law);
            }
        })*
    };
}

/// Checks a `property` that panics if it fails, for the seeds of [`check`]. Cases that cannot be
/// drawn are skipped.
///
/// # Panics
///
/// If the property panics, or at least half of the cases cannot be drawn.
pub fn each(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<()>,
) {
    let (mut drawn, mut tried) = (0, 0);
    check(count, |u| {
        tried += 1;
        property(u)?;
        drawn += 1;
        Ok(Ok(()))
    });
    assert!(2 * drawn > tried, "only {drawn} of {tried} cases could be drawn");
}

/// The number of seeds that [`check`] runs for a count of `usual`. A test that counts cases
/// compares its count with this number.
///
/// # Panics
///
/// If `PALPATE_SEEDS` holds no positive number.
#[must_use]
pub fn count(usual: u64) -> u64 {
    multiplied(usual, number_in("PALPATE_SEEDS").unwrap_or(USUAL))
}

fn multiplied(count: u64, factor: f64) -> u64 {
    assert!(factor > 0.0 && factor.is_finite(), "PALPATE_SEEDS must be positive, got {factor}");
    ((count as f64 * factor).round() as u64).max(1)
}

/// The number in a variable of the environment; `None` if it is not set.
///
/// # Panics
///
/// If the variable holds anything else.
fn number_in<T: FromStr>(variable: &str) -> Option<T> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable} must be a number, got {text}")))
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
