// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The convex hull of two discs.

use crate::scalar::Scalar;

/// The convex hull of two discs with their centres on the y axis, the origin half-way
/// between them. Neither holds the other.
///
/// # Derivation
///
/// The straight edge touches both discs: its normal is `(cos, sin)` with
/// `sin = (r − s)/d`, for the radii `r` below and `s` above and the distance `d` of
/// the centres. From the lower centre, the edge spans the places from `0` to `d·cos`
/// along it. There the nearest point is on the edge, below and above on the discs,
/// inside as outside: the normals of the outline meet nowhere but on the axis.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct TwoDiscs {
    bottom_radius: f64,
    top_radius: f64,
    half_distance: f64,
    /// The normal of the edge.
    normal: [f64; 2],
    /// The length of the edge [m].
    edge: f64,
}

impl TwoDiscs {
    /// Discs of two radii, their centres `distance` apart [m], which exceeds the difference of
    /// the radii.
    pub(in crate::kernel) fn new(bottom_radius: f64, top_radius: f64, distance: f64) -> Self {
        let taper = bottom_radius - top_radius;
        let edge = ((distance - taper) * (distance + taper)).sqrt();
        Self {
            bottom_radius,
            top_radius,
            half_distance: 0.5 * distance,
            normal: [edge / distance, taper / distance],
            edge,
        }
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, [x, y]: [S; 2]) -> S {
        let [cos, sin] = self.normal;
        let from_bottom = [x, y + S::constant(self.half_distance)];
        let from_top = [x, y - S::constant(self.half_distance)];
        let along = S::weighted_sum(from_bottom, &[-sin, cos]);
        let bottom = S::norm(from_bottom) - S::constant(self.bottom_radius);
        let top = S::norm(from_top) - S::constant(self.top_radius);
        let edge = S::weighted_sum(from_bottom, &[cos, sin]) - S::constant(self.bottom_radius);
        let not_below = S::select_less(S::constant(self.edge), along, top, edge);
        S::select_less(along, S::constant(0.0), bottom, not_below)
    }

    /// Half the distance between the centres [m].
    pub(in crate::kernel) fn half_distance(&self) -> f64 {
        self.half_distance
    }

    /// The radii of the discs at the bottom and top [m].
    pub(in crate::kernel) fn radii(&self) -> [f64; 2] {
        [self.bottom_radius, self.top_radius]
    }

    /// The sum of all lengths [m].
    pub(in crate::kernel) fn size(&self) -> f64 {
        2.0 * self.half_distance + self.bottom_radius + self.top_radius
    }
}
