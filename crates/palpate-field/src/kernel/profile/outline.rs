// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Outlines from their pieces.

use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;

/// The distance of a shape of `size` [m] that is the intersection of sides: half-planes, discs,
/// or complements of discs. Inside it is `sides`, the largest distance to a side; outside it is
/// `pieces`, the distance to the nearest piece of the outline.
#[inline(always)]
pub(in crate::kernel) fn intersection<S: Scalar>(sides: S, pieces: S, size: f64) -> S {
    let outside = face_if_on_it(pieces, sides, size);
    S::select_less(sides, S::constant(0.0), sides, outside)
}

/// The distance to one piece of an outline if it is the nearest, else `otherwise`, the distance
/// to the others. `out` is the offset from the piece's line or circle, negative inside.
///
/// If `out` is not negative and the point is not `past` the piece's ends, the piece is the
/// nearest. The smaller of both distances would give wrong gradients: next to an end they
/// differ by less than their rounding, and the direction from the end is only nearly the
/// normal.
#[inline(always)]
pub(in crate::kernel) fn beside<S: Scalar>(out: S, past: S, otherwise: S) -> S {
    let zero = S::constant(0.0);
    // From inside, the distance through the shape, which `intersection` ignores. With it,
    // models over cells on the outline need not choose between distant numbers.
    let behind = otherwise.min(out.abs());
    S::select_less(zero, past, otherwise, S::select_less(out, zero, behind, out))
}
