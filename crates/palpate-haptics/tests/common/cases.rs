// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Property tests on the same cases every time.

use arbitrary::Unstructured;

/// Bytes a case may draw from; past them it draws zeros.
const BYTES: usize = 1 << 14;

/// Checks a property on `count` cases. A case that cannot be drawn is skipped.
pub(crate) fn cases(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<()>,
) {
    let mut drawn = 0;
    for case in 0..count {
        let bytes: Vec<u8> = (0..BYTES as u64 / 8)
            .flat_map(|word| split_mix(case << 32 | word).to_le_bytes())
            .collect();
        let failure = FailureNote(case);
        drawn += u64::from(property(&mut Unstructured::new(&bytes)).is_ok());
        std::mem::forget(failure);
    }
    assert!(2 * drawn > count, "only {drawn} of {count} cases could be drawn");
}

/// Says which case it was when a property panics.
struct FailureNote(u64);

impl Drop for FailureNote {
    fn drop(&mut self) {
        eprintln!("failed in case {}", self.0);
    }
}

/// The bits of SplitMix64 (Steele, Lea and Flood 2014) for a seed.
fn split_mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
