// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Each operation of models encloses what it bounds, rounding included.
//!
//! A model stands for every function between two parallel planes. Functions between
//! them are sampled, the operation is applied to them in twice the precision, and
//! the result must lie between the planes of the operation's model, without any
//! tolerance but for the rounding of twice the precision.

use arbitrary::{Result, Unstructured};
use palpate_field::scalar::{
    Circular, Cubic, Exponential, Model, Quadratic, Quartic, Root, Scalar,
};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;
use palpate_testkit::double::Double;

/// Random operands for each operation.
const CASES: u64 = 12_000;

/// Samples of each set of operands.
const SAMPLES: usize = 24;

/// The relative rounding of a few operations in twice the precision.
const TWICE: f64 = 1e-30;

/// A model of anything: values of zero and of many sizes; slopes and remainders
/// from nothing and a rounding to many times the value.
fn model(u: &mut Unstructured<'_>) -> Result<Model> {
    let size = 10.0_f64.powf(draw::within(u, -6.0, 6.0)?);
    let part = |u: &mut Unstructured<'_>| -> Result<f64> {
        Ok(match u.int_in_range(0..=4_u8)? {
            0 => 0.0,
            1 => size * 10.0_f64.powf(draw::within(u, -18.0, 1.0)?),
            _ => size * draw::unit(u)?,
        })
    };
    let signed = |u: &mut Unstructured<'_>, x: f64| -> Result<f64> {
        Ok(if u.arbitrary()? { x } else { -x })
    };
    let value = match u.int_in_range(0..=7_u8)? {
        0 => 0.0,
        1 => f64::from(u.int_in_range(-2..=2_i8)?),
        _ => {
            let x = size * draw::unit(u)?;
            signed(u, x)?
        }
    };
    let mut gradient = [0.0; 3];
    for slope in &mut gradient {
        let x = part(u)?;
        *slope = signed(u, x)?;
    }
    let exact = u.arbitrary()?;
    let (lower, upper) = if exact { (0.0, 0.0) } else { (part(u)?, part(u)?) };
    Ok(Model { value, gradient, lower, upper })
}

/// A model, at times next to another, so that neither is smaller everywhere.
fn near(u: &mut Unstructured<'_>, other: &Model) -> Result<Model> {
    let drawn = model(u)?;
    let size = other.deviation();
    Ok(match u.int_in_range(0..=3_u8)? {
        0 => Model { value: other.value, ..drawn },
        1 => Model { value: other.value + size * draw::within(u, -3.0, 3.0)?, ..drawn },
        2 => *other,
        _ => drawn,
    })
}

/// `value + gradient·u`, in twice the precision.
fn plane(model: &Model, u: &[f64; 3]) -> Double {
    let start = Double::constant(model.value);
    (0..3).fold(start, |sum, k| sum + Double::constant(model.gradient[k]).scale(u[k]))
}

/// The value at `u` of a function that `model` encloses: on its planes or between.
fn member(u: &mut Unstructured<'_>, model: &Model, at: &[f64; 3]) -> Result<Double> {
    let apart = match u.int_in_range(0..=3_u8)? {
        0 => -model.lower,
        1 => model.upper,
        2 => 0.0,
        _ => draw::within(u, -model.lower, model.upper)?,
    };
    Ok(plane(model, at) + Double::constant(apart))
}

/// Where a sample of the cell is: its corners, faces and inside.
fn place(u: &mut Unstructured<'_>) -> Result<[f64; 3]> {
    let mut at = [0.0; 3];
    for x in &mut at {
        *x = if u.arbitrary()? {
            f64::from(u.int_in_range(-1..=1_i8)?)
        } else {
            draw::within(u, -1.0, 1.0)?
        };
    }
    Ok(at)
}

/// What is wrong with a result of `result` that is `value` at `at`, of operands up to `size`:
/// in a difference of two, twice the precision is that of the two.
fn check(
    result: &Model,
    value: Double,
    at: &[f64; 3],
    size: f64,
) -> std::result::Result<(), String> {
    let numbers = [result.value, result.lower, result.upper];
    let sound = result.lower >= 0.0 && result.upper >= 0.0;
    if !sound || !numbers.iter().chain(&result.gradient).all(|x| x.is_finite()) {
        return Err(format!("{result:?}"));
    }
    let above = value - plane(result, at);
    let parts = numbers.iter().chain(&result.gradient);
    let slack = TWICE * parts.fold(size + value.to_f64().abs(), |sum, x| sum + x.abs());
    let below_low = (above + Double::constant(result.lower)).to_f64() + slack;
    let above_high = (above - Double::constant(result.upper)).to_f64() - slack;
    if below_low < 0.0 || above_high > 0.0 {
        let by = f64::max(-below_low, above_high);
        let ulp = by / (f64::EPSILON * f64::max(value.to_f64().abs(), result.value.abs()));
        return Err(format!(
            "{:e} at {at:?} is {by:e} ({ulp:.2} ulp) outside {result:?}",
            value.to_f64()
        ));
    }
    let minimum = (value - Double::constant(result.minimum())).to_f64();
    let maximum = (value - Double::constant(result.maximum())).to_f64();
    if minimum < 0.0 || maximum > 0.0 {
        return Err(format!("{:e} beyond the extremes of {result:?}", value.to_f64()));
    }
    Ok(())
}

/// Checks an operation on `N` operands, which `operands` draws.
fn encloses<const N: usize>(
    operands: impl Fn(&mut Unstructured<'_>) -> Result<[Model; N]>,
    on_models: impl Fn([Model; N]) -> Model,
    on_numbers: impl Fn([Double; N]) -> Option<Double>,
) {
    cases::check(CASES, |u| {
        let models = operands(u)?;
        let result = on_models(models);
        for _ in 0..SAMPLES {
            let at = place(u)?;
            let mut numbers = [Double::constant(0.0); N];
            for (number, model) in numbers.iter_mut().zip(&models) {
                *number = member(u, model, &at)?;
            }
            let Some(value) = on_numbers(numbers) else { continue };
            let size = numbers.iter().map(|x| x.to_f64().abs()).sum();
            if let Err(complaint) = check(&result, value, &at, size) {
                return Ok(Err(format!("{complaint}\n  operands {models:?}")));
            }
        }
        Ok(Ok(()))
    });
}

fn one(u: &mut Unstructured<'_>) -> Result<[Model; 1]> {
    Ok([model(u)?])
}

fn two(u: &mut Unstructured<'_>) -> Result<[Model; 2]> {
    let first = model(u)?;
    Ok([first, near(u, &first)?])
}

/// Two whose values differ by about the reach of a blend, at times by far more.
fn in_reach(u: &mut Unstructured<'_>) -> Result<[Model; 2]> {
    let [a, b] = two(u)?;
    if u.ratio(1_u8, 4_u8)? {
        return Ok([a, b]);
    }
    let size = 10.0_f64.powf(draw::within(u, -3.0, 0.0)?);
    let shrink = |u: &mut Unstructured<'_>, x: Model| -> Result<Model> {
        let value = draw::within(u, -0.3, 0.3)?;
        Ok(Model { value, ..x.scale(size / x.deviation().max(1.0)) })
    };
    Ok([shrink(u, a)?, shrink(u, b)?])
}

fn three(u: &mut Unstructured<'_>) -> Result<[Model; 3]> {
    let first = model(u)?;
    Ok([first, near(u, &first)?, near(u, &first)?])
}

/// Tests `$name`: an operation written once, for models and for numbers.
macro_rules! operations {
    ($($name:ident: $operands:ident, |$x:ident| $operation:expr;)*) => {
        $(#[test]
        fn $name() {
            encloses($operands, |$x| $operation, |$x| Some($operation));
        })*
    };
}

operations! {
    add: two, |x| x[0] + x[1];
    sub: two, |x| x[0] - x[1];
    mul: two, |x| x[0] * x[1];
    neg: one, |x| -x[0];
    abs: one, |x| Scalar::abs(x[0]);
    squared: one, |x| x[0].squared();
    min: two, |x| Scalar::min(x[0], x[1]);
    max: two, |x| Scalar::max(x[0], x[1]);
    clamp: one, |x| Scalar::clamp(x[0], -1.0, 0.5);
    norm_of_one: one, |x| Scalar::norm(x);
    norm_of_two: two, |x| Scalar::norm(x);
    norm_of_three: three, |x| Scalar::norm(x);
    power_norm_of_one: one, |x| Scalar::power_norm::<8, 1>(x);
    fourth_power_norm_of_two: two, |x| Scalar::power_norm::<4, 2>(x);
    sixth_power_norm_of_two: two, |x| Scalar::power_norm::<6, 2>(x);
    fourth_power_norm_of_three: three, |x| Scalar::power_norm::<4, 3>(x);
    sixth_power_norm_of_three: three, |x| Scalar::power_norm::<6, 3>(x);
    eighth_power_norm_of_three: three, |x| Scalar::power_norm::<8, 3>(x);
    power_orthant_of_one: one, |x| Scalar::power_orthant::<4, 1>(x);
    fourth_power_orthant_of_three: three, |x| Scalar::power_orthant::<4, 3>(x);
    sixth_power_orthant_of_three: three, |x| Scalar::power_orthant::<6, 3>(x);
    eighth_power_orthant_of_two: two, |x| Scalar::power_orthant::<8, 2>(x);
    eighth_power_orthant_of_three: three, |x| Scalar::power_orthant::<8, 3>(x);
    orthant_of_one: one, |x| Scalar::orthant(x);
    orthant_of_two: two, |x| Scalar::orthant(x);
    orthant_of_three: three, |x| Scalar::orthant(x);
    smooth_min_quadratic: in_reach, |x| x[0].smooth_min::<Quadratic>(x[1], 0.3);
    smooth_min_cubic: in_reach, |x| x[0].smooth_min::<Cubic>(x[1], 0.3);
    smooth_min_quartic: in_reach, |x| x[0].smooth_min::<Quartic>(x[1], 0.3);
    smooth_min_circular: in_reach, |x| x[0].smooth_min::<Circular>(x[1], 0.3);
    smooth_min_root: in_reach, |x| x[0].smooth_min::<Root>(x[1], 0.1);
    smooth_min_exponential: in_reach, |x| x[0].smooth_min::<Exponential>(x[1], 0.1);
    smooth_max_cubic: in_reach, |x| x[0].smooth_max::<Cubic>(x[1], 0.3);
    scale_up: one, |x| x[0].scale(1.0 / 3.0e-5);
    scale_down: one, |x| x[0].scale(-0.1);
    scale_to_nothing: one, |x| x[0].scale(0.0);
    weighted_sum: three, |x| Scalar::weighted_sum(x, &[0.6, -0.48, 0.64]);
    weighted_sum_of_one: three, |x| Scalar::weighted_sum(x, &[0.0, 1.0, 0.0]);
}

/// Undefined at zero.
#[test]
fn div() {
    let defined = |[a, b]: [Double; 2]| (b.to_f64() != 0.0).then(|| a / b);
    encloses(two, |[a, b]| a / b, defined);
}

/// Undefined below zero.
#[test]
fn sqrt() {
    let defined = |[x]: [Double; 1]| (x.to_f64() >= 0.0).then(|| x.sqrt());
    encloses(one, |[x]| x.sqrt(), defined);
    // With the cell on the side where it is defined.
    let positive = |u: &mut Unstructured<'_>| {
        let x = model(u)?;
        Ok([Model { value: x.value.abs() + x.deviation(), ..x }])
    };
    encloses(positive, |[x]| x.sqrt(), defined);
}

/// Within the angles that the polynomials promise their accuracy for.
#[test]
fn sin_and_cos() {
    let angle = |u: &mut Unstructured<'_>| {
        let x = model(u)?;
        Ok([if x.value.abs() + x.deviation() < 65_536.0 { x } else { Model::constant(1.0) }])
    };
    encloses(angle, |[x]| x.sin(), |[x]| Some(x.sin()));
    encloses(angle, |[x]| x.cos(), |[x]| Some(x.cos()));
}

/// On the side without a cut, and where a cell away from the origin crosses it.
#[test]
fn turn() {
    let right = |u: &mut Unstructured<'_>| {
        let [x, y] = two(u)?;
        Ok([Model { value: x.value.abs() + x.deviation(), ..x }, y])
    };
    encloses(right, |[x, y]| Model::turn(x, y), |[x, y]| Some(Double::turn(x, y)));
    let left = |u: &mut Unstructured<'_>| {
        let [x, y] = two(u)?;
        let away = x.value.abs() + 2.0 * (x.deviation() + y.deviation()) + 1e-9;
        Ok([Model { value: -away, ..x }, Model { value: y.value.abs(), ..y }])
    };
    encloses(
        left,
        |[x, y]| Model::turn(x, y),
        |[x, y]| {
            let turn = Double::turn(x, y);
            Some(if turn.to_f64() < 0.0 { turn + Double::constant(1.0) } else { turn })
        },
    );
}

/// Continuous across the choice, as all formulas are.
#[test]
fn select_less_that_is_continuous() {
    encloses(
        three,
        |[a, b, c]| Model::select_less(a, b, c + a, c + b),
        |[a, b, c]| Some(Double::select_less(a, b, c + a, c + b)),
    );
}

/// Between any two, since a rule that holds only for some is a trap.
#[test]
fn select_less_between_any() {
    let four = |u: &mut Unstructured<'_>| {
        let [a, b] = two(u)?;
        let [c, d] = two(u)?;
        Ok([a, b, c, d])
    };
    encloses(
        four,
        |[a, b, c, d]| Model::select_less(a, b, c, d),
        |[a, b, c, d]| Some(Double::select_less(a, b, c, d)),
    );
}
