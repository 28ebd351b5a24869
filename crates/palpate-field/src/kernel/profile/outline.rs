// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Outlines from their pieces.

use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;

/// The distance of a shape of `size` [m] that is the intersection of sides
/// (half-planes, discs, what is outside a disc): inside the largest distance to a side,
/// `sides`; outside that to the nearest piece of the outline, `pieces`.
#[inline(always)]
pub(in crate::kernel) fn intersection<S: Scalar>(sides: S, pieces: S, size: f64) -> S {
    let outside = face_if_on_it(pieces, sides, size);
    S::select_less(sides, S::constant(0.0), sides, outside)
}

/// The distance to one piece of an outline, or to the others, which are `otherwise` away.
/// `out` is the offset from the piece's line or circle, negative inside.
///
/// A point on or out of it that is not `past` the piece's ends is beside the piece, which
/// then is the nearest. The smaller of both would not do: next to an end they differ by
/// less than their rounding, and the direction from the end is only nearly the normal.
#[inline(always)]
pub(in crate::kernel) fn beside<S: Scalar>(out: S, past: S, otherwise: S) -> S {
    let zero = S::constant(0.0);
    // Behind the piece, seen through the shape: so that models over cells on the outline
    // do not have to choose between far apart numbers.
    let behind = otherwise.min(out.abs());
    S::select_less(zero, past, otherwise, S::select_less(out, zero, behind, out))
}
