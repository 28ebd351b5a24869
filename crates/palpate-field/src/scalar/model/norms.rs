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

/// How far the roundings of a value and of each component of its gradient leave them
/// off, relative to what is computed.
#[derive(Clone, Copy)]
struct Roundings {
    value: f64,
    gradient: f64,
}

/// Those of a norm of squares, with room.
const OF_SQUARES: Roundings = Roundings { value: 8.0 * UNIT, gradient: 8.0 * UNIT };

/// Those of a norm of the powers `P`.
///
/// The value is off by five roundings. A root has up to 4, its share of a component 6,
/// the gradient is a power `P − 1` of that by up to 4 products, and summing up takes 3.
const fn of_powers<const P: u32>() -> Roundings {
    Roundings { value: 8.0 * UNIT, gradient: (6 * (P - 1) + 7) as f64 * UNIT }
}

/// A function of `x` that nowhere lies below its tangent plane: `value` and
/// `gradient` at the centre, at most `above` over the plane, off by `roundings` of
/// numbers up to `size`.
///
/// A component's rounding is relative: of a remainder that lifts the plane, it takes
/// nothing that the remainder does not bring. So it counts over what may lower it alone.
#[inline(always)]
fn convex<const N: usize>(
    value: f64,
    gradient: [f64; N],
    x: &[Model; N],
    above: f64,
    (roundings, size): (Roundings, f64),
) -> Model {
    let mut slopes = [0.0; 3];
    let (mut lower, mut upper, mut reach) = (0.0, 0.0, 0.0);
    unrolled!(i < N => {
        let size = f64::abs(gradient[i]);
        let positive = gradient[i] > 0.0;
        unrolled!(k < 3 => slopes[k] += gradient[i] * x[i].gradient[k]);
        lower += size * choose(positive, x[i].lower, x[i].upper);
        upper += size * choose(positive, x[i].upper, x[i].lower);
        reach += size * x[i].slope();
    });
    let fixed = roundings.value * size + roundings.gradient * reach;
    Model {
        value,
        gradient: slopes,
        lower: lower + roundings.gradient * lower + fixed,
        upper: upper + roundings.gradient * upper + fixed + above,
    }
}

/// Below: `‖x‖ ≥ û·x` for every unit `û`, so no second-order term.
#[inline(always)]
pub(super) fn norm<const N: usize>(x: [Model; N]) -> Model {
    let n = <f64 as Scalar>::norm(array!(i < N => x[i].value));
    let inverse = choose(n > 0.0, 1.0 / choose(n > 0.0, n, 1.0), 0.0);
    let d = Model::radius(&x);
    let unit = array!(i < N => x[i].value * inverse);
    convex(n, unit, &x, excess(n, d, 1.0), (OF_SQUARES, n))
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
    convex(n, split.gradient::<P>(values), &x, above, (of_powers::<P>(), n + TINY / UNIT))
}

#[inline(always)]
pub(super) fn orthant<const N: usize>(q: [Model; N]) -> Model {
    let positive = array!(i < N => q[i].value.max_of(0.0));
    let n = <f64 as Scalar>::norm(positive);
    let inverse = 1.0 / choose(n > 0.0, n, 1.0);
    let outside = array!(i < N => positive[i] * inverse);
    to_orthant((n, outside), &q, 1.0, OF_SQUARES)
}

#[inline(always)]
pub(super) fn power_orthant<const P: u32, const N: usize>(q: [Model; N]) -> Model {
    let positive = array!(i < N => q[i].value.max_of(0.0));
    let split = power::split::<f64, P, N>(positive);
    let outside = (split.largest * split.root, split.gradient::<P>(positive));
    to_orthant(outside, &q, f64::from(P) - 1.0, of_powers::<P>())
}

/// An orthant distance is convex and grows with each `qᵢ`: below, its subgradient is
/// a bound. Above, nothing is added where one face rules the whole cell.
///
/// Given are the value and gradient where some `qᵢ` is positive, and how much the norm
/// is curved, as for [`excess`].
#[inline(always)]
fn to_orthant<const N: usize>(
    (n, outside): (f64, [f64; N]),
    q: &[Model; N],
    curvature: f64,
    roundings: Roundings,
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
    let d = Model::radius(q);
    let one_face = second + d < 0.0 && largest - second > d + d;
    let above = choose(one_face, 0.0, excess(n, d, curvature));
    let size = n + f64::abs(largest) + TINY / UNIT;
    convex(n + Scalar::min(largest, 0.0), gradient, q, above, (roundings, size))
}
