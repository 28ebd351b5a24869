// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A quarter of a rhombus.

use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;

/// A rhombus with its corners on the axes, where both coordinates are not negative,
/// its edges moved inwards.
///
/// # Derivation
///
/// With the corners `(a, 0)` and `(0, b)` the edge has the normal `(b, a)/‖(a, b)‖`.
/// Inside, the edge is nearest; outside, it is where `p` is beside it, else one of the
/// corners. Moved inwards by `r`, the rhombus is smaller by `r` over the radius of the
/// circle in it; the normal stays, even where nothing but the centre is left.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Rhombus {
    /// From the centre to the corners on x and y.
    corners: [f64; 2],
    /// The normal of the edge.
    normal: [f64; 2],
    /// The length of the edge [m].
    edge: f64,
}

/// The radius of the circle that fits into a rhombus with half diagonals `a` and `b`.
pub(in crate::kernel) fn inner_radius([a, b]: [f64; 2]) -> f64 {
    a.min(b) * (a.max(b) / a.hypot(b))
}

impl Rhombus {
    /// A rhombus with the given half diagonals, its edges moved inwards by `inset` [m],
    /// at most its [`inner_radius`].
    pub(in crate::kernel) fn new(half_diagonals: [f64; 2], inset: f64) -> Self {
        let [a, b] = half_diagonals;
        let edge = a.hypot(b);
        let rest = (1.0 - inset / inner_radius(half_diagonals)).max(0.0);
        Self { corners: [a * rest, b * rest], normal: [b / edge, a / edge], edge: edge * rest }
    }

    /// From the centre to the corners on x and y [m].
    pub(in crate::kernel) fn corners(&self) -> [f64; 2] {
        self.corners
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, [x, y]: [S; 2]) -> S {
        let [a, b] = self.corners;
        let [nx, ny] = self.normal;
        let from_corner = [x - S::constant(a), y];
        let out = S::weighted_sum(from_corner, &[nx, ny]);
        let along = S::weighted_sum(from_corner, &[-ny, nx]);
        let low = face_if_on_it(S::norm(from_corner), out, self.edge);
        let high = face_if_on_it(S::norm([x, y - S::constant(b)]), out, self.edge);
        let not_low = S::select_less(S::constant(self.edge), along, high, out);
        S::select_less(along, S::constant(0.0), low, not_low)
    }
}
