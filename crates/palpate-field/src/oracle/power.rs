// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Norms of higher powers.

use super::{Definition, Outside};
use crate::vector::Point;

/// `(Σ|xᵢ|^e)^(1/e)`, computed as written.
pub(crate) fn norm<const D: usize>(x: Point<D>, exponent: f64) -> f64 {
    x.0.iter().map(|x| x.abs().powf(exponent)).sum::<f64>().powf(1.0 / exponent)
}

/// The point of the unit ball's surface in a direction of length one.
pub(crate) fn on_ball<const D: usize>(direction: Point<D>, exponent: f64) -> Point<D> {
    direction * (1.0 / norm(direction, exponent))
}

/// The largest ratio of the motion of the point on the ball to that of its direction.
///
/// With the norm `n` of the direction, the point moves `1/n` times as far across the direction.
/// Along it the ratio is `√(1 − n²)/n²`, because the gradient of the norm is at most one long
/// and its part along the direction is `n`. Together this is `1/n²`, which is largest where all
/// components are equal.
pub(crate) fn speed<const D: usize>(exponent: f64) -> f64 {
    (D as f64).powf(1.0 - 2.0 / exponent)
}

pub(crate) fn bound<const D: usize>(definition: Definition<D>) -> Definition<D> {
    Definition { outside: Outside::Bound, ..definition }
}
