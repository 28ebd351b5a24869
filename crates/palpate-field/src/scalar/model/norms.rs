// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of norms, and of distances to an orthant in them: convex, so that below
//! they are bounded by a tangent plane, and above by their curvature.

use super::{INFLATE, MaxOf, Model, UNBOUNDED, UNIT, choose};
use crate::scalar::power;
use crate::scalar::{Scalar, power::TINY};
use crate::vector::{array, unrolled};

/// How far a norm or orthant distance of value `n` may exceed its tangent plane
/// when its arguments move by at most `d`: `c·d²/2(n − d)` where its second derivative
/// is at most `c` over its value, or `2d`, since neither is steeper than one.
#[inline(always)]
fn excess(n: f64, d: f64, curvature: f64) -> f64 {
    let far = n > 1.25 * d;
    let curved = 0.5 * curvature * d * d / choose(far, n - d, 1.0);
    choose(far, Scalar::min(curved, d + d), d + d) * INFLATE
}

/// A function of `x` that nowhere lies below its tangent plane: `value` and
/// `gradient` at the centre, at most `above` over the plane, both off by `error`.
#[inline(always)]
fn convex<const N: usize>(
    value: f64,
    gradient: [f64; N],
    x: &[Model; N],
    above: f64,
    error: f64,
) -> Model {
    let mut slopes = [0.0; 3];
    let (mut lower, mut upper) = (0.0, 0.0);
    unrolled!(i < N => {
        let size = f64::abs(gradient[i]);
        let positive = gradient[i] > 0.0;
        unrolled!(k < 3 => slopes[k] += gradient[i] * x[i].gradient[k]);
        lower += size * choose(positive, x[i].lower, x[i].upper);
        upper += size * choose(positive, x[i].upper, x[i].lower);
    });
    Model { value, gradient: slopes, lower: lower + error, upper: upper + above + error }
}

/// Below: `‖x‖ ≥ û·x` for every unit `û`, so no second-order term.
#[inline(always)]
pub(super) fn norm<const N: usize>(x: [Model; N]) -> Model {
    let n = <f64 as Scalar>::norm(array!(i < N => x[i].value));
    let inverse = choose(n > 0.0, 1.0 / choose(n > 0.0, n, 1.0), 0.0);
    let d = Model::radius(&x);
    let unit = array!(i < N => x[i].value * inverse);
    convex(n, unit, &x, excess(n, d, 1.0), 8.0 * UNIT * (n + d))
}

/// The rounding of a norm of the powers `P`, at a change of its arguments by `d`.
///
/// That of the value is five roundings. A root has up to 4, its share of a component 6,
/// and the gradient is a power `P − 1` of that, but the shorter the more components
/// share: 14, 23 and 28 roundings of a length of one. Summing up takes 3 more.
#[inline(always)]
fn error_of_powers<const P: u32>(n: f64, d: f64) -> f64 {
    UNIT * (8.0 * n + (4.0 * f64::from(P) + 4.0) * d) + 4.0 * TINY
}

/// The second derivative is `(P − 1)/n` times the diagonal of `(|xᵢ|/n)^(P−2) ≤ 1`, less
/// the square of the gradient.
#[inline(always)]
pub(super) fn power_norm<const P: u32, const N: usize>(x: [Model; N]) -> Model {
    let values = array!(i < N => x[i].value);
    let split = power::split::<f64, P, N>(values);
    let n = split.largest * split.root;
    let d = Model::radius(&x);
    let above = excess(n, d, f64::from(P) - 1.0);
    convex(n, split.gradient::<P>(values), &x, above, error_of_powers::<P>(n, d))
}

#[inline(always)]
pub(super) fn orthant<const N: usize>(q: [Model; N]) -> Model {
    let positive = array!(i < N => q[i].value.max_of(0.0));
    let n = <f64 as Scalar>::norm(positive);
    let inverse = 1.0 / choose(n > 0.0, n, 1.0);
    let d = Model::radius(&q);
    let outside = array!(i < N => positive[i] * inverse);
    to_orthant(n, outside, &q, d, excess(n, d, 1.0), 8.0 * UNIT * (n + d))
}

#[inline(always)]
pub(super) fn power_orthant<const P: u32, const N: usize>(q: [Model; N]) -> Model {
    let positive = array!(i < N => q[i].value.max_of(0.0));
    let split = power::split::<f64, P, N>(positive);
    let n = split.largest * split.root;
    let d = Model::radius(&q);
    let above = excess(n, d, f64::from(P) - 1.0);
    to_orthant(n, split.gradient::<P>(positive), &q, d, above, error_of_powers::<P>(n, d))
}

/// An orthant distance is convex and grows with each `qᵢ`: below, its subgradient is
/// a bound. Above, nothing is added where one face rules the whole cell.
///
/// `n` and `outside` are the value and gradient where some `qᵢ` is positive.
#[inline(always)]
fn to_orthant<const N: usize>(
    n: f64,
    outside: [f64; N],
    q: &[Model; N],
    d: f64,
    above: f64,
    error: f64,
) -> Model {
    let (mut largest, mut second) = (q[0].value, -UNBOUNDED);
    unrolled!(i < N => {
        if i > 0 {
            second = choose(q[i].value > largest, largest, second.max_of(q[i].value));
            largest = largest.max_of(q[i].value);
        }
    });
    let mut free = 1.0;
    let gradient = array!(i < N => {
        let face = choose(q[i].value < largest, 0.0, free);
        free -= face;
        choose(n > 0.0, outside[i], face)
    });
    debug_assert!(free <= 0.0, "some face has the largest value");
    let one_face = second + d < 0.0 && largest - second > d + d;
    let value = n + Scalar::min(largest, 0.0);
    let error = error + 8.0 * UNIT * f64::abs(largest);
    convex(value, gradient, q, choose(one_face, 0.0, above), error)
}
