// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sine and cosine as branch-free polynomials, so that blocks of them vectorise.
//!
//! The argument is reduced in double precision by the nearest multiple of π/2,
//! subtracted in three parts (Cody and Waite 1980). On `[−π/4, π/4]` the Taylor
//! polynomials of degree 17 and 16 stay within `2⁻⁵⁵` of the functions; in single
//! precision those of degree 9 and 10 within `2⁻²⁹`.

use super::Float;

/// π/2 in three parts of 33, 33 and 53 bits: the products with a quadrant up to
/// 2¹⁹ are exact in the first two.
const HALF_PI: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Adding and subtracting 1.5·2⁵² rounds to the nearest integer without a call
/// into a library, which would stop vectorisation, and leaves the integer in the
/// lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// (−1)ᵏ/(2k+1)! from k = 8 down to 1.
const SINE: [f64; 8] = [
    1.0 / 355_687_428_096_000.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    -1.0 / 5_040.0,
    1.0 / 120.0,
    -1.0 / 6.0,
];

/// (−1)ᵏ/(2k)! from k = 8 down to 1.
const COSINE: [f64; 8] = [
    1.0 / 20_922_789_888_000.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 479_001_600.0,
    -1.0 / 3_628_800.0,
    1.0 / 40_320.0,
    -1.0 / 720.0,
    1.0 / 24.0,
    -0.5,
];

#[inline(always)]
pub(super) fn sin<T: Float>(angle: T) -> T {
    turned(angle, 0)
}

#[inline(always)]
pub(super) fn cos<T: Float>(angle: T) -> T {
    turned(angle, 1)
}

/// `sin(angle + quarters·π/2)`.
#[inline(always)]
fn turned<T: Float>(angle: T, quarters: u32) -> T {
    let angle = angle.to_f64();
    let shifted = angle * std::f64::consts::FRAC_2_PI + ROUND;
    let nearest = shifted - ROUND;
    let rest = ((angle - nearest * HALF_PI[0]) - nearest * HALF_PI[1]) - nearest * HALF_PI[2];
    let quadrant = (shifted.to_bits() as u32).wrapping_add(quarters);
    let x = T::constant(rest);
    let y = x * x;
    let sine = x + x * (y * polynomial(y, &SINE, 4));
    let cosine = T::constant(1.0) + y * polynomial(y, &COSINE, 3);
    let value = if quadrant & 1 == 0 { sine } else { cosine };
    if quadrant & 2 == 0 { value } else { -value }
}

/// The polynomial with these coefficients, that of the highest power first; the
/// first ones are `spared` in single precision.
#[inline(always)]
fn polynomial<T: Float>(y: T, coefficients: &[f64; 8], spared: usize) -> T {
    let first = if T::EPSILON > f64::EPSILON { spared } else { 0 };
    let mut sum = T::constant(coefficients[first]);
    for coefficient in &coefficients[first + 1..] {
        sum = sum * y + T::constant(*coefficient);
    }
    sum
}
