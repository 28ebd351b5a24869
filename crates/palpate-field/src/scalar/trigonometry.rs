// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sine and cosine as branch-free polynomials, so that blocks of them vectorise.
//!
//! The argument is reduced by the nearest multiple of π/2, subtracted in three
//! parts (Cody and Waite 1980); on `[−π/4, π/4]` the Taylor polynomials of
//! degree 17 and 16 stay within `2⁻⁵⁵` of the functions.

use super::Float;

/// π/2 in three parts of 33, 33 and 53 bits: the products with a quadrant up to
/// 2¹⁹ are exact in the first two.
const HALF_PI: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Adding and subtracting 1.5·2⁵² rounds to the nearest integer without a call
/// into a library, which would stop vectorisation.
const ROUND: f64 = 6_755_399_441_055_744.0;

#[inline(always)]
pub(super) fn sin<T: Float>(angle: T) -> T {
    T::constant(turned(angle.to_f64(), 0.0))
}

#[inline(always)]
pub(super) fn cos<T: Float>(angle: T) -> T {
    T::constant(turned(angle.to_f64(), 1.0))
}

/// `sin(angle + quarters·π/2)`.
#[inline(always)]
fn turned(angle: f64, quarters: f64) -> f64 {
    let nearest = (angle * std::f64::consts::FRAC_2_PI + ROUND) - ROUND;
    let rest = ((angle - nearest * HALF_PI[0]) - nearest * HALF_PI[1]) - nearest * HALF_PI[2];
    let quadrant = nearest + quarters;
    // `quadrant mod 4` in [−2, 2], then which function and which sign.
    let half = quadrant * 0.5;
    let half_turns = (half + ROUND) - ROUND;
    let odd = quadrant - 2.0 * half_turns; // −1, 0 or 1: a quarter turn remains
    let full_turns = (half_turns * 0.5 + ROUND) - ROUND;
    let flip = half_turns - 2.0 * full_turns; // −1, 0 or 1: half a turn remains
    let sign = 1.0 - 2.0 * flip * flip;
    let value = if odd == 0.0 { sine_polynomial(rest) } else { odd * cosine_polynomial(rest) };
    sign * value
}

/// Σ (−1)ᵏ x²ᵏ⁺¹ / (2k+1)! up to x¹⁷.
#[inline(always)]
fn sine_polynomial(x: f64) -> f64 {
    let y = x * x;
    let mut sum = 1.0 / 355_687_428_096_000.0;
    for factor in [
        -1.0 / 1_307_674_368_000.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
    ] {
        sum = sum * y + factor;
    }
    x + x * (y * sum)
}

/// Σ (−1)ᵏ x²ᵏ / (2k)! up to x¹⁶.
#[inline(always)]
fn cosine_polynomial(x: f64) -> f64 {
    let y = x * x;
    let mut sum = 1.0 / 20_922_789_888_000.0;
    for factor in [
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
        -0.5,
    ] {
        sum = sum * y + factor;
    }
    1.0 + y * sum
}

#[cfg(test)]
mod tests {
    use crate::scalar::Scalar;

    #[test]
    fn sine_and_cosine_agree_with_the_libm_crate() {
        let mut worst = 0.0_f64;
        for i in -200_000..200_000 {
            let angle = f64::from(i) * 0.327_68 / 1.0_f64;
            worst = worst
                .max((Scalar::sin(angle) - libm::sin(angle)).abs())
                .max((Scalar::cos(angle) - libm::cos(angle)).abs());
        }
        assert!(worst <= 4.0 * f64::EPSILON, "worst error {worst:e}");
    }

    #[test]
    fn multiples_of_a_quarter_turn_come_out_exact() {
        use std::f64::consts::{FRAC_PI_2, PI};
        assert_eq!(Scalar::sin(0.0_f64), 0.0);
        assert_eq!(Scalar::cos(0.0_f64), 1.0);
        assert_eq!(Scalar::sin(FRAC_PI_2), 1.0);
        assert_eq!(Scalar::cos(PI), -1.0);
        assert_eq!(Scalar::sin(-FRAC_PI_2), -1.0);
        assert_eq!(Scalar::cos(1.0_f32), 1.0_f32.cos());
    }
}
