// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Powers of one half and logarithms as branch-free polynomials, so that blocks of
//! them vectorise; in double precision for both numbers.

use super::{Float, Scalar};

/// Adding and subtracting 1.5·2⁵² rounds to the nearest integer without a call into
/// a library, and leaves the integer in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Powers below this one are zero for every use: `2⁻¹⁰²²` is the smallest normal number.
const LARGEST_EXPONENT: f64 = 1022.0;

/// `2⁻ᵗ` for `t ≥ 0`, with a relative error of at most 2 ulp.
///
/// `t = n − r` with an integer `n` and `|r| ≤ ½`; the Taylor polynomial of `2ʳ` of
/// degree 13 stays within `2⁻⁵⁶`.
#[inline(always)]
pub fn power_of_half<T: Float>(t: T) -> T {
    let t = Scalar::min(t.to_f64(), LARGEST_EXPONENT);
    let shifted = t + ROUND;
    let rest = ((shifted - ROUND) - t) * std::f64::consts::LN_2;
    let mut sum = 1.0 / 6_227_020_800.0;
    for factor in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = sum * rest + factor;
    }
    // 1023 − n in the place of the exponent.
    let exponent = 1023_u64.wrapping_sub(shifted.to_bits()) << 52;
    T::constant(sum * f64::from_bits(exponent))
}

/// `log₂(1 + y)` for `0 ≤ y ≤ 1`, with a relative error of at most 4 ulp.
///
/// `ln(1 + y) = 2·artanh(z)` with `z = y/(2 + y) ≤ ⅓`; the series of odd powers up
/// to `z³³` stays within `2⁻⁵⁶`.
#[inline(always)]
pub fn log2_of_one_plus<T: Float>(y: T) -> T {
    let y = y.to_f64();
    let z = y / (2.0 + y);
    let square = z * z;
    let mut sum = 1.0 / 33.0;
    for odd in [
        31.0, 29.0, 27.0, 25.0, 23.0, 21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0,
        1.0,
    ] {
        sum = sum * square + 1.0 / odd;
    }
    T::constant(2.0 * std::f64::consts::LOG2_E * z * sum)
}
