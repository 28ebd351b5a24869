// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Straight edges of planar shapes.

use crate::scalar::Scalar;
use crate::vector::{Point, Vector};

/// A segment in the plane, by its middle, direction and half length.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Edge {
    middle: [f64; 2],
    along: [f64; 2],
    across: [f64; 2],
    half_length: f64,
}

impl Edge {
    /// From `from` to `to`; its `across` points to the right.
    pub(in crate::kernel) fn new(from: Point<2>, to: Point<2>) -> Self {
        let along = (to - from).normalized().unwrap_or(Vector([1.0, 0.0]));
        Self {
            middle: ((from + to) * 0.5).0,
            along: along.0,
            across: [along[1], -along[0]],
            half_length: 0.5 * (to - from).norm(),
        }
    }

    /// The unit vector to the right of the edge.
    pub(in crate::kernel) fn across(&self) -> [f64; 2] {
        self.across
    }

    /// How far `p` is to the right of the edge's line, and how far it is past
    /// the nearer end; zero beside the edge.
    #[inline(always)]
    pub(in crate::kernel) fn offsets<S: Scalar>(&self, p: Vector<S, 2>) -> [S; 2] {
        let q = p - Vector::of(&self.middle);
        let past = q.dot_constant(&self.along).abs() - S::constant(self.half_length);
        [q.dot_constant(&self.across), past.max(S::constant(0.0))]
    }

    /// The distance to the edge.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        S::norm(self.offsets(p))
    }

    /// The distance to the edge, negative to its left.
    ///
    /// Beside the edge this is the signed offset from its line, which has a gradient on the
    /// line too.
    #[inline(always)]
    pub(in crate::kernel) fn signed_distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let [across, past] = self.offsets(p);
        let distance = S::norm([across, past]);
        let beyond = S::select_less(across, zero, -distance, distance);
        S::select_less(zero, past, beyond, across)
    }
}
