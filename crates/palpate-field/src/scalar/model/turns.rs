// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of angles.

use std::f64::consts::TAU;

use super::{AffineModel, INFLATE, MaxOf, UNIT, choose};
use crate::scalar::Scalar;
use crate::vector::array;

/// Roundings of the value, which is at most a half, and of each slope, relatively.
const ROUNDINGS: f64 = 8.0;

/// The angle is the imaginary part of a logarithm: with the cell's centre as the complex
/// number `z` and a point of the cell as `z(1 + w)`, it grows by that of
/// `ln(1 + w) = w − w²/2 + …`, of which all but the first term is at most
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
