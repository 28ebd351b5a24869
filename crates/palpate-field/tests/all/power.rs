// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Norms of fourth, sixth and eighth powers, in every number.

use arbitrary::{Result, Unstructured};
use palpate_field::scalar::{Dual, Float, Model, Scalar};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;
use palpate_testkit::double::Double;

const CASES: u64 = 20_000;

/// Relative errors of the values, in ulp; the worst that was found is 1.5.
const ULP: f64 = 2.0;

/// Components of many sizes, at times zero, equal or nearly so.
fn components(u: &mut Unstructured<'_>) -> Result<[f64; 3]> {
    let size = 10.0_f64.powf(draw::within(u, -14.0, 14.0)?);
    let mut x = [0.0; 3];
    for i in 0..3 {
        x[i] = match u.int_in_range(0..=5_u8)? {
            0 => 0.0,
            1 => size,
            2 => -size * 10.0_f64.powf(draw::within(u, -5.0, 0.0)?),
            3 if i > 0 => x[i - 1] * (1.0 + f64::EPSILON * f64::from(u.arbitrary::<i8>()?)),
            _ => size * draw::within(u, -1.0, 1.0)?,
        };
    }
    Ok(x)
}

/// The norm by its definition in twice the precision; the root by Newton's method from
/// that of the library.
fn definition(x: [f64; 3], power: u32) -> Double {
    let largest = x.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    let raised = |x: Double| (0..power).fold(Double::constant(1.0), |y, _| y * x);
    let sum = x.iter().fold(Double::constant(0.0), |sum, x| {
        sum + raised(Double::constant(x.abs()) / Double::constant(largest))
    });
    let mut root = Double::constant(sum.to_f64().powf(1.0 / f64::from(power)));
    for _ in 0..2 {
        let slope = raised(root) / root * Double::constant(power.into());
        root = root - (raised(root) - sum) / slope;
    }
    root * Double::constant(largest)
}

/// The norms of 4, 6 and 8.
fn norms<S: Scalar>(x: [S; 3]) -> [S; 3] {
    [S::power_norm::<4, 3>(x), S::power_norm::<6, 3>(x), S::power_norm::<8, 3>(x)]
}

/// In `ulp` of `T` from the definition, between the largest component and the
/// Euclidean norm, and less for higher powers.
fn is_the_norm<T: Float>(x: [f64; 3]) -> std::result::Result<f64, String> {
    let x = x.map(T::constant);
    let exact = x.map(Float::to_f64);
    let largest = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let room = 1.0 + ULP * T::epsilon();
    let mut above = exact[0].hypot(exact[1]).hypot(exact[2]);
    let mut worst = 0.0_f64;
    for (norm, power) in norms(x).into_iter().zip([4, 6, 8]) {
        let norm = norm.to_f64();
        if !(largest <= norm && norm <= above * room) {
            return Err(format!("{norm:e} of {exact:?} to {power}, above {above:e}"));
        }
        let apart = (Double::constant(norm) - definition(exact, power)).to_f64().abs();
        let ulp = apart / (T::epsilon() * largest.max(f64::MIN_POSITIVE));
        if ulp > ULP {
            return Err(format!("{norm:e} of {exact:?} to {power}, off by {ulp:.2} ulp"));
        }
        worst = worst.max(ulp);
        above = norm;
    }
    Ok(worst)
}

#[test]
fn norms_of_powers_are_as_defined_in_both_precisions() {
    let mut worst = [0.0_f64; 2];
    cases::check(CASES, |u| {
        let x = components(u)?;
        let errors = is_the_norm::<f64>(x).and_then(|a| Ok([a, is_the_norm::<f32>(x)?]));
        Ok(errors.map(|errors| (0..2).for_each(|i| worst[i] = worst[i].max(errors[i]))))
    });
    println!("worst errors: {worst:.2?} ulp");
}

#[test]
fn gradients_of_powers_are_as_defined() {
    cases::check(CASES, |u| {
        let x = components(u)?;
        for (dual, power) in norms(Dual::variables(x)).into_iter().zip([4, 6, 8]) {
            let n = definition(x, power);
            let plain = norms(x)[power as usize / 2 - 2];
            let at_zero = [1.0, 0.0, 0.0];
            for i in 0..3 {
                let share = Double::constant(x[i].abs()) / n;
                let size = (1..power).fold(1.0, |y, _| y * share.to_f64());
                let expected = if plain > 0.0 { size * x[i].signum() } else { at_zero[i] };
                if (dual.gradient[i] - expected).abs() > 32.0 * f64::EPSILON {
                    return Ok(Err(format!("{dual:?} of {x:?} to {power}, not {expected:e}")));
                }
            }
            let [a, b, c] = dual.gradient;
            let longest = 1.0 + 2.0 * f64::EPSILON;
            if dual.value.to_bits() != plain.to_bits() || a.hypot(b).hypot(c) > longest {
                return Ok(Err(format!("{dual:?} of {x:?} to {power}, {plain:e} alone")));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn single_numbers_are_their_own_norms() {
    for x in [0.0, 5e-324, 1e-40, 1e-15, 0.1, 0.3, 1.0, 3.0, 1e15] {
        for axis in 0..3 {
            let mut along = [0.0; 3];
            along[axis] = -x;
            assert_eq!(norms(along), [x; 3]);
            let single = x as f32;
            assert_eq!(norms(along.map(|x| x as f32)), [single; 3]);
            for dual in norms(Dual::variables(along)) {
                // At zero the first coordinate decides, from its positive side.
                let expected = if x < 1e-36 {
                    [1.0, 0.0, 0.0]
                } else {
                    std::array::from_fn(|k| if k == axis { -1.0 } else { 0.0 })
                };
                assert_eq!(dual.gradient, expected);
                assert_eq!(dual.value, x);
            }
        }
    }
}

/// Sums of powers that are powers: Frye's, and those of equal numbers.
#[test]
fn norms_that_are_known() {
    let cube_root_of_two = 1.259_921_049_894_873_2_f64;
    assert_eq!(f64::power_norm::<4, 3>([217_519.0, -414_560.0, 95_800.0]), 422_481.0);
    assert_eq!(f64::power_norm::<6, 2>([3.0, -3.0]), 3.0 * cube_root_of_two.sqrt());
    assert_eq!(f64::power_norm::<4, 2>([2.0, 2.0]), 2.0 * 2.0_f64.sqrt().sqrt());
    assert_eq!(f64::power_norm::<8, 2>([5.0, 5.0]), 5.0 * 2.0_f64.sqrt().sqrt().sqrt());
}

#[test]
fn orthants_of_powers_are_norms_outside_and_faces_inside() {
    for [value, expected] in [
        [f64::power_orthant::<4, 3>([-3.0, -0.5, -2.0]), -0.5],
        [f64::power_orthant::<6, 3>([-3.0, 0.75, -2.0]), 0.75],
        [f64::power_orthant::<8, 3>([-3.0, 0.0, -2.0]), 0.0],
        [f64::power_orthant::<4, 3>([-3.0, 2.0, 2.0]), 2.0 * 2.0_f64.sqrt().sqrt()],
    ] {
        assert_eq!(value, expected);
    }
    for q in [[-1.0, 0.0], [0.0, 0.0], [0.0, -0.5], [0.5, -0.0], [-0.0, -0.0]] {
        let dual = Dual::<f64, 2>::power_orthant::<8, 2>(Dual::variables(q));
        let length = dual.gradient[0].hypot(dual.gradient[1]);
        assert_eq!(length, 1.0, "{dual:?} at {q:?}");
    }
}

/// One side of the other norms: nothing is added below but rounding, and above what
/// the curvature gives.
#[test]
fn models_of_powers_are_tight() {
    let cell = Model::cell([1.0, 1.0], [0.01, 0.01]);
    for (model, power) in [
        (Model::power_norm::<4, 2>(cell), 4.0),
        (Model::power_norm::<6, 2>(cell), 6.0),
        (Model::power_norm::<8, 2>(cell), 8.0),
        (Model::power_orthant::<8, 2>(cell), 8.0),
    ] {
        let curved = 0.5 * (power - 1.0) * 2e-4 / (model.value - 0.015);
        assert!(model.lower < 1e-14 && model.upper < curved, "{model:?}");
    }
    let face = Model::power_orthant::<8, 2>(Model::cell([1.0, -1.0], [0.1, 0.1]));
    assert!(face.upper < 1e-14, "{face:?}");
    assert_eq!(face.gradient, [0.1, 0.0, 0.0]);
}
