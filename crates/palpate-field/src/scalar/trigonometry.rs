// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sine, cosine and angles as branch-free polynomials, so that blocks of them vectorise.
//!
//! The argument is reduced in double precision by the nearest multiple of π/2,
//! subtracted in three parts (Cody and Waite 1980). On `[−π/4, π/4]` the Taylor
//! polynomials of degree 17 and 16 stay within `2⁻⁵⁵` of the functions; in single
//! precision those of degree 9 and 10 within `2⁻²⁹`.
//!
//! An angle is reduced to the first eighth of a turn, whose tangent is a quotient of
//! coordinates, and from there by 0, 1/16 or 1/8 of a turn, with the rule for the tangent of
//! a difference. What is left has a tangent of at most tan(π/16), where the series of the
//! arc tangent up to the power 23 stays within `2⁻⁶⁰`, and up to 11 within `2⁻³¹`.

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

/// The tangents of 1/32, 1/16 and 3/32 of a turn.
const TANGENTS: [f64; 3] =
    [0.198_912_367_379_658, std::f64::consts::SQRT_2 - 1.0, 0.668_178_637_919_298_9];

/// (−1)ᵏ/(2k+1) from k = 11 down to 0.
const ARC_TANGENT: [f64; 12] = [
    -1.0 / 23.0,
    1.0 / 21.0,
    -1.0 / 19.0,
    1.0 / 17.0,
    -1.0 / 15.0,
    1.0 / 13.0,
    -1.0 / 11.0,
    1.0 / 9.0,
    -1.0 / 7.0,
    1.0 / 5.0,
    -1.0 / 3.0,
    1.0,
];

/// The angle of `(x, y)` as a part of a turn, in [−½, ½].
#[inline(always)]
pub(super) fn turn<T: Float>(x: T, y: T) -> T {
    let [zero, one] = [0.0, 1.0].map(T::constant);
    let (across, up) = (x.abs(), y.abs());
    let (longer, shorter) = (across.max(up), across.min(up));
    let longer = T::select_less(zero, longer, longer, one);
    let [first, second] =
        [TANGENTS[0], TANGENTS[2]].map(|tangent| longer * T::constant(tangent));
    // One of three values, by how far up the shorter side reaches.
    let of_three = |[low, middle, high]: [f64; 3]| {
        let above = T::select_less(second, shorter, T::constant(high), T::constant(middle));
        T::select_less(first, shorter, above, T::constant(low))
    };
    let tangent = of_three([0.0, TANGENTS[1], 1.0]);
    let rest = (shorter - longer * tangent) / (longer + shorter * tangent);
    let arc = rest * polynomial(rest * rest, &ARC_TANGENT, 6);
    let eighth =
        of_three([0.0, 1.0 / 16.0, 1.0 / 8.0]) + arc.scale(1.0 / std::f64::consts::TAU);
    let quarter = T::select_less(across, up, T::constant(0.25) - eighth, eighth);
    let half = T::select_less(x, zero, T::constant(0.5) - quarter, quarter);
    T::select_less(y, zero, -half, half)
}

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
fn polynomial<T: Float, const N: usize>(y: T, coefficients: &[f64; N], spared: usize) -> T {
    let first = if T::epsilon() > f64::EPSILON { spared } else { 0 };
    let mut sum = T::constant(coefficients[first]);
    for coefficient in &coefficients[first + 1..] {
        sum = sum * y + T::constant(*coefficient);
    }
    sum
}
