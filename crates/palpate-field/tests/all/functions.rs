// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Functions of numbers, beside those of the libm crate.

use palpate_field::internal::{cube_root, log2_of_one_plus, power_of_half};
use palpate_field::scalar::Scalar;

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
fn single_precision_agrees_with_double() {
    let mut worst = 0.0_f64;
    for i in -200_000..200_000 {
        let angle = i as f32 * 0.327_68;
        let double = f64::from(angle);
        worst = worst
            .max((f64::from(Scalar::sin(angle)) - libm::sin(double)).abs())
            .max((f64::from(Scalar::cos(angle)) - libm::cos(double)).abs());
    }
    assert!(worst <= f64::from(f32::EPSILON), "worst error {worst:e}");
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

/// Points on circles of several sizes, in no order.
fn around() -> impl Iterator<Item = [f64; 2]> {
    (0..200_000).map(|i| {
        let angle = f64::from(i) * 0.618_033_988_749_895;
        let size = 10.0_f64.powi(i % 7 - 3);
        [size * angle.cos(), size * angle.sin()]
    })
}

#[test]
fn turns_agree_with_the_libm_crate() {
    let (mut worst, mut worst_single) = (0.0_f64, 0.0_f64);
    for [x, y] in around() {
        let expected = libm::atan2(y, x) / std::f64::consts::TAU;
        worst = worst.max((Scalar::turn(x, y) - expected).abs());
        let (x, y) = (x as f32, y as f32);
        let expected = libm::atan2(f64::from(y), f64::from(x)) / std::f64::consts::TAU;
        worst_single = worst_single.max((f64::from(Scalar::turn(x, y)) - expected).abs());
    }
    assert!(worst <= 0.5 * f64::EPSILON, "worst error {worst:e}");
    assert!(worst_single <= 0.5 * f64::from(f32::EPSILON), "worst error {worst_single:e}");
}

#[test]
fn eighths_of_a_turn_come_out_exact() {
    let corners = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0]];
    for (eighths, [x, y]) in [0, 1, 2, 3, 4, -3].into_iter().zip(corners) {
        let expected = f64::from(eighths) / 8.0;
        assert_eq!(Scalar::turn(0.3 * x, 0.3 * y), expected);
        assert_eq!(Scalar::turn(7.0 * x as f32, 7.0 * y as f32), expected as f32);
    }
    assert_eq!(Scalar::turn(0.0, 0.0), 0.0);
    assert_eq!(Scalar::turn(-0.0_f32, 0.0), 0.0);
}

#[test]
fn cube_roots_are_right_to_an_ulp() {
    for i in 0..=100_000_i32 {
        let x = 1.0 + f64::from(i) * 1e-5;
        let apart = (cube_root(x) - libm::cbrt(x)).abs();
        assert!(apart <= f64::EPSILON, "{x}: {apart:e}");
        let single = x as f32;
        let apart = (cube_root(single) - libm::cbrtf(single)).abs();
        assert!(apart <= f32::EPSILON, "{single}: {apart:e}");
    }
    assert_eq!(cube_root(1.0), 1.0);
    assert_eq!(cube_root(1.0_f32), 1.0);
}

#[test]
fn powers_and_logarithms_are_those_of_the_library() {
    for i in 0..=20_000_i32 {
        let t = f64::from(i) * 1e-3 + f64::from(i % 7) * 41.0;
        let power = power_of_half(t);
        let expected = libm::exp2(-t);
        assert!((power - expected).abs() <= 4.0 * f64::EPSILON * expected, "2^-{t}");
        let y = f64::from(i) / 20_000.0;
        let logarithm = log2_of_one_plus(y);
        let expected = libm::log1p(y) * std::f64::consts::LOG2_E;
        assert!((logarithm - expected).abs() <= 6.0 * f64::EPSILON * expected, "{y}");
    }
    assert_eq!(power_of_half(0.0), 1.0);
    assert_eq!(power_of_half(3.0), 0.125);
    assert!(power_of_half(f64::INFINITY) < 1e-300);
    assert!((log2_of_one_plus(1.0_f64) - 1.0).abs() <= f64::EPSILON);
}
