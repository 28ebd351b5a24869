// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Control values of a cell: the interpolation lies between the least and the largest of them, and is the control
//! value at each corner.

use crate::samples::{WIDE, strides};
use crate::spline::QUADRATIC;

/// The most samples of a cell, and the most control values.
pub(crate) const MOST_TAPS: usize = QUADRATIC.pow(3);

/// Writes a cell's samples, the first axis first.
#[inline]
pub(crate) fn gather<const K: usize, const D: usize>(
    samples: &[f64],
    place: usize,
    taps: &mut [f64],
) {
    let ways = strides([WIDE; D]);
    for row in 0..K.pow(D as u32 - 1) {
        let mut rest = row;
        let mut from = place;
        for way in ways.iter().skip(1) {
            from += (rest % K) * way;
            rest /= K;
        }
        taps[row * K..][..K].copy_from_slice(&samples[from..from + K]);
    }
}

/// Replaces samples along an axis by their shares in control values.
#[inline]
pub(crate) fn apply<const K: usize, const D: usize>(
    numbers: &mut [f64],
    axis: usize,
    shares: &[[f64; K]; K],
) {
    let way = K.pow(axis as u32);
    for line in 0..K.pow(D as u32 - 1) {
        let first = line % way + (line / way) * way * K;
        let old: [f64; K] = std::array::from_fn(|tap| numbers[first + tap * way]);
        for (tap, shares) in shares.iter().enumerate() {
            numbers[first + tap * way] = (0..K).map(|i| shares[i] * old[i]).sum();
        }
    }
}
