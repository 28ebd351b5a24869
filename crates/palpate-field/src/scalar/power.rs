// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Powers, exponentials and angles.
//!
//! The norms of fourth, sixth and eighth powers.
//!
//! Powers by products and roots by square roots alone, so that blocks vectorise and
//! every number takes part. The largest component is divided out first: powers of it
//! would leave the range of single precision at 10⁵ m.
//!
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

use super::{Float, Scalar};
use crate::vector::array;

/// Components smaller than this are not divided by [m]: its inverse is a number of
/// single precision, and it is far below the rounding of every length accepted.
pub(super) const TINY: f64 = 1e-36;

/// A norm in two factors, `largest · root`.
pub(super) struct Split<S, const N: usize> {
    /// `max |xᵢ|`.
    pub(super) largest: S,
    /// `(Σ sharesᵢ^P)^(1/P)`, from 1 to `N^(1/P)`.
    pub(super) root: S,
    /// `|xᵢ| / max |xⱼ|`: exactly one for the largest.
    shares: [S; N],
}

/// Splits the norm of the powers `P`, one of 4, 6 and 8.
#[inline(always)]
pub(super) fn split<S: Scalar, const P: u32, const N: usize>(x: [S; N]) -> Split<S, N> {
    const { assert!(P == 4 || P == 6 || P == 8, "the norm of another power") };
    let sizes = array!(i < N => x[i].abs());
    let mut largest = sizes[0];
    for size in &sizes[1..] {
        largest = largest.max(*size);
    }
    let divisor = largest.max(S::constant(TINY));
    let shares: [S; N] = array!(i < N => sizes[i] / divisor);
    let mut sum = even_power::<S, P>(shares[0]);
    for share in &shares[1..] {
        sum = sum + even_power::<S, P>(*share);
    }
    // Less than one only where nothing is larger than what is not divided by.
    let root = root::<S, P>(sum.max(S::constant(1.0)));
    Split { largest, root, shares }
}

/// The norm of the powers `P`: [`Scalar::power_norm`].
#[inline(always)]
pub(super) fn norm<S: Scalar, const P: u32, const N: usize>(x: [S; N]) -> S {
    let split = split::<S, P, N>(x);
    split.largest * split.root
}

/// The orthant with the norm of the powers `P`: [`Scalar::power_orthant`].
#[inline(always)]
pub(super) fn orthant<S: Scalar, const P: u32, const N: usize>(q: [S; N]) -> S {
    // Zero first in one and last in the other, so that on a face just one of the
    // two has a slope.
    let zero = S::constant(0.0);
    let mut largest = q[0];
    for component in &q[1..] {
        largest = largest.max(*component);
    }
    S::power_norm::<P, N>(array!(i < N => zero.max(q[i]))) + largest.min(zero)
}

impl<T: Float, const N: usize> Split<T, N> {
    /// The gradient `sign(xᵢ)·(|xᵢ|/n)^(P−1)`; at zero the first unit vector.
    ///
    /// Its Euclidean length is at most one: `|xᵢ|/n ≤ 1`, so the sum of their powers
    /// `2P − 2` is at most that of their powers `P`.
    #[inline(always)]
    pub(super) fn gradient<const P: u32>(&self, x: [T; N]) -> [T; N] {
        let (zero, tiny) = (T::constant(0.0), T::constant(TINY));
        array!(i < N => {
            let at_zero = T::constant(if i == 0 { 1.0 } else { 0.0 });
            let size = odd_power::<T, P>(self.shares[i] / self.root);
            let signed = T::select_less(x[i], zero, -size, size);
            T::select_less(self.largest, tiny, at_zero, signed)
        })
    }
}

/// `x^P`.
#[inline(always)]
fn even_power<S: Scalar, const P: u32>(x: S) -> S {
    let square = x.squared();
    match P {
        4 => square.squared(),
        6 => square.squared() * square,
        _ => square.squared().squared(),
    }
}

/// `x^(P−1)`.
#[inline(always)]
fn odd_power<S: Scalar, const P: u32>(x: S) -> S {
    let square = x.squared();
    match P {
        4 => square * x,
        6 => square.squared() * x,
        _ => square.squared() * square * x,
    }
}

/// `x^(1/P)` for `1 ≤ x ≤ 4`.
#[inline(always)]
fn root<S: Scalar, const P: u32>(x: S) -> S {
    match P {
        4 => x.sqrt().sqrt(),
        6 => cube_root(x.sqrt()),
        _ => x.sqrt().sqrt().sqrt(),
    }
}

/// `x^(1/3)` for `1 ≤ x ≤ 2`, to one ulp in single and double precision; exactly one
/// for one.
///
/// The line through (1, 1) is off by at most 1.9 % at 2, and 0.7 % up to √3. A step of
/// Halley's method leaves two thirds of the cube of the error: two leave 7·10⁻¹⁷ at 2,
/// and 10⁻²⁰ up to √3, which is as far as three components go.
#[inline(always)]
pub fn cube_root<S: Scalar>(x: S) -> S {
    let mut y = S::constant(1.0) + (x - S::constant(1.0)).scale(0.283);
    for _ in 0..2 {
        let cube = y.squared() * y;
        y = y - y * (cube - x) / (cube + cube + x);
    }
    y
}

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

/// π/2 in three parts of 33, 33 and 53 bits: the products with a quadrant up to
/// 2¹⁹ are exact in the first two.
const HALF_PI: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

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
