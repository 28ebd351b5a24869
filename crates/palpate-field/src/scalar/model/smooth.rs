// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of smooth minima.

use super::{AffineModel, INFLATE, MaxOf, UNIT, choose};
use crate::scalar::{Blend, Scalar};
use crate::vector::array;

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
