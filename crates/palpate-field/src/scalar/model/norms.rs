// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Norms, smooth minima and turns of models.

use std::f64::consts::TAU;

use super::super::power::{self, TINY};
use super::super::{Blend, Scalar};
use super::{AffineModel, INFLATE, MaxOf, NONE, UNBOUNDED, UNIT, choose};
use crate::vector::{array, unrolled};

/// How far the arguments of a function move over a cell.
struct Moves<const M: usize> {
    /// Each by at most this.
    each: [f64; M],
    /// `Σ eachᵢ`: no less than the length of the whole move.
    sum: f64,
    /// `Σ eachᵢ²`.
    squares: f64,
}

impl<const M: usize> Moves<M> {
    #[inline(always)]
    fn of<const N: usize>(x: &[AffineModel<N>; M]) -> Self {
        let each = array!(i < M => x[i].deviation());
        let (mut sum, mut squares) = (NONE, NONE);
        unrolled!(i < M => {
            sum += each[i];
            squares += each[i] * each[i];
        });
        Self { each, sum, squares }
    }

    /// How far a norm of value `n`, or a distance to an orthant in it, may exceed its
    /// tangent plane: `c·‖δ‖²/2n`, if the second derivative of half the norm's square is at
    /// most `c`.
    ///
    /// For then `‖x + δ‖² ≤ n² + 2n ∇·δ + c‖δ‖²`, of which the root lies below its tangent
    /// at `n²`. Of an orthant the negative `xᵢ` count as zero: no `xᵢ + δᵢ` has a positive
    /// part larger than `δᵢ` on top of that.
    #[inline(always)]
    fn curved(&self, n: f64, inverse: f64, curvature: f64) -> f64 {
        let curved = self.squares * inverse * (0.5 * curvature * INFLATE * INFLATE);
        // The inverse of a smaller norm may be no number.
        choose(n > TINY, curved, UNBOUNDED)
    }
}

/// How far the roundings of a value and of each component of its gradient leave them
/// off, relative to what is computed.
#[derive(Clone, Copy)]
struct Roundings {
    value: f64,
    gradient: f64,
}

impl Roundings {
    /// These, with that of the value absolute, for numbers up to `size`.
    #[inline(always)]
    fn of_size(self, size: f64) -> Self {
        Self { value: self.value * size, ..self }
    }
}

/// How far a function may exceed its tangent plane.
struct Above {
    /// How far the components move over the cell, all together.
    moves: f64,
    /// By its curvature.
    plane: f64,
}

/// The norm of the positive parts, its inverse, and its gradient where it is positive.
struct Outside<const M: usize> {
    norm: f64,
    inverse: f64,
    gradient: [f64; M],
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

/// A function of `x` that nowhere lies below its tangent plane and is nowhere steeper
/// than one: `value` and `gradient` at the centre, at most `above` over the plane, the value off
/// by the one of the `roundings`, the gradient relatively by the other.
///
/// A component's rounding is relative: of a remainder that lifts the plane, it takes
/// nothing that the remainder does not bring. So it counts over what may lower it alone.
#[inline(always)]
fn convex<const M: usize, const N: usize>(
    value: f64,
    gradient: [f64; M],
    x: &[AffineModel<N>; M],
    above: Above,
    roundings: Roundings,
) -> AffineModel<N> {
    let mut slopes = [NONE; N];
    let (mut lower, mut upper, mut reach) = (NONE, NONE, NONE);
    unrolled!(i < M => {
        let size = f64::abs(gradient[i]);
        let positive = gradient[i] > 0.0;
        unrolled!(k < N => slopes[k] += gradient[i] * x[i].gradient[k]);
        lower += size * choose(positive, x[i].lower, x[i].upper);
        upper += size * choose(positive, x[i].upper, x[i].lower);
        reach += size * x[i].slope();
    });
    let steepest = (above.moves + (reach + lower.max_of(upper))) * INFLATE;
    let above = Scalar::min(above.plane, steepest);
    let fixed = roundings.value + roundings.gradient * reach;
    AffineModel {
        value,
        gradient: slopes,
        lower: lower + roundings.gradient * lower + fixed,
        upper: upper + roundings.gradient * upper + fixed + above,
    }
}

/// Below: `‖x‖ ≥ û·x` for every unit `û`, so no second-order term.
#[inline(always)]
pub(super) fn norm<const M: usize, const N: usize>(x: [AffineModel<N>; M]) -> AffineModel<N> {
    let n = <f64 as Scalar>::norm(array!(i < M => x[i].value));
    let inverse = choose(n > 0.0, 1.0 / choose(n > 0.0, n, 1.0), 0.0);
    let moves = Moves::of(&x);
    let unit = array!(i < M => x[i].value * inverse);
    let above = Above { moves: moves.sum, plane: moves.curved(n, inverse, 1.0) };
    convex(n, unit, &x, above, OF_SQUARES.of_size(n))
}

/// Half the square of a norm of the powers `P ≥ 2` has a second derivative of at most
/// `P − 1` in that norm (Ball, Carlen and Lieb, 1994), which is no longer than the
/// Euclidean one.
#[inline(always)]
pub(super) fn power_norm<const P: u32, const M: usize, const N: usize>(
    x: [AffineModel<N>; M],
) -> AffineModel<N> {
    let values = array!(i < M => x[i].value);
    let split = power::split::<f64, P, M>(values);
    let n = split.largest * split.root;
    let moves = Moves::of(&x);
    let curved = moves.curved(n, 1.0 / choose(n > 0.0, n, 1.0), f64::from(P) - 1.0);
    let above = Above { moves: moves.sum, plane: curved };
    let gradient = split.gradient::<P>(values);
    convex(n, gradient, &x, above, of_powers::<P>().of_size(n + TINY / UNIT))
}

#[inline(always)]
pub(super) fn orthant<const M: usize, const N: usize>(
    q: [AffineModel<N>; M],
) -> AffineModel<N> {
    let positive = array!(i < M => q[i].value.max_of(0.0));
    let n = <f64 as Scalar>::norm(positive);
    let inverse = 1.0 / choose(n > 0.0, n, 1.0);
    let outside = array!(i < M => positive[i] * inverse);
    to_orthant(Outside { norm: n, inverse, gradient: outside }, &q, 1.0, OF_SQUARES)
}

#[inline(always)]
pub(super) fn power_orthant<const P: u32, const M: usize, const N: usize>(
    q: [AffineModel<N>; M],
) -> AffineModel<N> {
    let positive = array!(i < M => q[i].value.max_of(0.0));
    let split = power::split::<f64, P, M>(positive);
    let n = split.largest * split.root;
    let inverse = 1.0 / choose(n > 0.0, n, 1.0);
    let outside = split.gradient::<P>(positive);
    let outside = Outside { norm: n, inverse, gradient: outside };
    to_orthant(outside, &q, f64::from(P) - 1.0, of_powers::<P>())
}

/// An orthant distance is convex and grows with each `qᵢ`: below, its subgradient is
/// a bound.
///
/// Given is how much the norm is curved, as for [`Moves::curved`].
///
/// Above, while the largest `qᵢ` alone may be positive, the plane is that `qᵢ` itself. Where
/// it goes down to `low`, the others up to `other`, the distance exceeds it by at most
/// `other − low`, or nothing; if they become positive, by no more than the sum of their
/// positive parts on top of what `low` lacks to zero.
#[inline(always)]
fn to_orthant<const M: usize, const N: usize>(
    Outside { norm: n, inverse, gradient: outside }: Outside<M>,
    q: &[AffineModel<N>; M],
    curvature: f64,
    roundings: Roundings,
) -> AffineModel<N> {
    let (mut largest, mut second) = (q[0].value, -UNBOUNDED);
    unrolled!(i < M => {
        if i > 0 {
            second = choose(q[i].value > largest, largest, second.max_of(q[i].value));
            largest = largest.max_of(q[i].value);
        }
    });
    let moves = Moves::of(q);
    let mut free = 1.0;
    let (mut low, mut other, mut beyond) = (NONE, -UNBOUNDED, NONE);
    let gradient = array!(i < M => {
        let face = choose(q[i].value < largest, 0.0, free);
        free -= face;
        let top = q[i].value + moves.each[i];
        low = choose(face > 0.0, q[i].value - moves.each[i], low);
        other = choose(face > 0.0, other, other.max_of(top));
        beyond += choose(face > 0.0, 0.0, top.max_of(0.0));
        choose(n > 0.0, outside[i], face)
    });
    debug_assert!(free <= 0.0, "some face has the largest value");
    let over_others = choose(other > 0.0, beyond - Scalar::min(low, 0.0), other - low);
    let rounding = 8.0 * UNIT * (f64::abs(largest) + moves.sum);
    let over_face = ((over_others + rounding) * INFLATE).max_of(0.0);
    let over_plane = moves.curved(n, inverse, curvature);
    let above = choose(second > 0.0, over_plane, Scalar::min(over_plane, over_face));
    let size = n + f64::abs(largest) + TINY / UNIT;
    let above = Above { moves: moves.sum, plane: above };
    convex(n + Scalar::min(largest, 0.0), gradient, q, above, roundings.of_size(size))
}

/// Concave in `(a, b)`: above, the tangent plane is a bound; below, the
/// second derivative of the fill over the range of `a − b`, or all of the fill.
#[inline(always)]
pub(super) fn minimum<B: Blend, const N: usize>(
    a: AffineModel<N>,
    b: AffineModel<N>,
    unit: f64,
) -> AffineModel<N> {
    let apart = f64::abs(a.value - b.value);
    let t = apart / unit;
    let larger = B::weight(t);
    let weight = choose(b.value < a.value, larger, 1.0 - larger);
    let rest = 1.0 - weight;
    let spread =
        (a.slope_between(&b) + (a.lower + b.upper).max_of(a.upper + b.lower)) * INFLATE;
    let nearest = ((apart - spread) / unit * (1.0 - 4.0 * UNIT)).max_of(0.0);
    let below = 0.5 * B::curvature(nearest) / unit * spread * spread * INFLATE;
    let lower = weight * a.lower + rest * b.lower + below;
    // At least the smaller of both less the whole fill: else nested unions with
    // cells larger than their reach would square the remainder again and again.
    let coarse =
        (apart + a.slope_between(&b) + unit * B::fill(0.0) + a.lower.max_of(b.lower)) * INFLATE;
    AffineModel {
        value: <f64 as Scalar>::smooth_min::<B>(a.value, b.value, unit),
        gradient: array!(k < N => {
            weight * a.gradient[k] + rest * b.gradient[k]
        }),
        lower: Scalar::min(lower, coarse),
        upper: weight * a.upper + rest * b.upper,
    }
    // The operands and the fill, whose argument is rounded, may cancel in the value.
    .rounded_with(8.0, spread + f64::abs(a.value) + f64::abs(b.value) + 2.0 * larger * unit)
}

/// Roundings of the value, which is at most a half, and of each slope, relatively.
const ROUNDINGS: f64 = 8.0;

/// The angle is the imaginary part of a logarithm: with the cell's centre as the complex
/// number `z` and a point of the cell as `z(1 + w)`, it grows by that of
/// `ln(1 + w) = w − w²/2 + …`. All terms but the first together are at most
/// `|w|²/2(1 − |w|)`. A cell that reaches the origin has all angles.
#[inline(always)]
pub(super) fn turn<const N: usize>(x: AffineModel<N>, y: AffineModel<N>) -> AffineModel<N> {
    let value = f64::turn(x.value, y.value);
    let radius = f64::norm([x.value, y.value]);
    let moved = f64::norm([x.deviation(), y.deviation()]) * INFLATE;
    let nearest = radius * (1.0 - 8.0 * UNIT) - moved;
    let bounded = nearest > 0.0;
    let inverse = 1.0 / choose(bounded, radius, 1.0);
    let curved = moved * moved * inverse / (2.0 * TAU * choose(bounded, nearest, 1.0));
    let by_x = -(y.value * inverse) * inverse / TAU;
    let by_y = x.value * inverse * inverse / TAU;
    let (size_x, size_y) = (f64::abs(by_x), f64::abs(by_y));
    let tangent = AffineModel {
        value,
        gradient: array!(k < N => by_x * x.gradient[k] + by_y * y.gradient[k]),
        lower: size_x * choose(by_x > 0.0, x.lower, x.upper)
            + size_y * choose(by_y > 0.0, y.lower, y.upper)
            + curved * INFLATE,
        upper: size_x * choose(by_x > 0.0, x.upper, x.lower)
            + size_y * choose(by_y > 0.0, y.upper, y.lower)
            + curved * INFLATE,
    }
    .rounded_with(ROUNDINGS, 1.0 + size_x * x.slope() + size_y * y.slope());
    let any = AffineModel {
        value,
        gradient: [0.0; N],
        lower: (0.5 + value).max_of(0.0) + UNIT,
        upper: (0.5 - value).max_of(0.0) + UNIT,
    };
    AffineModel::choose(bounded, tangent, any)
}
