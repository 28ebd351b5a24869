// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points that are the same in every run.

/// Marsaglia's 64-bit xorshift generator (2003).
pub(crate) struct Random(u64);

impl Random {
    /// Any seed but zero.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in `[low, high)`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        // The upper 53 bits fill a double.
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// A point of the box `centre ± half`.
    pub(crate) fn point<const D: usize>(&mut self, centre: [f64; D], half: f64) -> [f64; D] {
        centre.map(|c| self.between(c - half, c + half))
    }
}
