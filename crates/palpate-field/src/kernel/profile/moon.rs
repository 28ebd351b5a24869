// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A disc with a bite.

use super::{beside, bounds_of_zone, intersection};
use crate::bounds::Bounds;
use crate::scalar::Scalar;

/// A disc about the origin without another whose centre is on the +y axis.
///
/// # Derivation
///
/// The boundary is an arc of either circle, between the corner where both cross and the y axis.
/// From inside, the exterior is beyond the disc or in the bite, so the nearer of both circles
/// decides, even where it is not an arc. Outside, the nearest point is on an arc, if the
/// direction from its centre is one of the arc's, or it is the corner. Whether a direction is
/// past the end of an arc follows from the sign of the offset from the line through the centre
/// and the corner.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Moon {
    pub(in crate::kernel) radius: f64,
    pub(in crate::kernel) cut_radius: f64,
    pub(in crate::kernel) distance: f64,
    /// Where the circles cross.
    corner: [f64; 2],
}

impl Moon {
    /// A disc of `radius` without one of `cut_radius`, their centres `distance` apart
    /// [m]; the circles cross.
    pub(in crate::kernel) fn new(radius: f64, cut_radius: f64, distance: f64) -> Self {
        let (r, s, d) = (radius, cut_radius, distance);
        // How far along the line between the centres the circles cross: (r² − R² + d²)/2d from
        // the centre of the smaller circle, where less cancels.
        let (small, large) = (r.min(s), r.max(s));
        let along = 0.5 * (((d - large) / d) * (d + large) + small * (small / d));
        let along = along.clamp(-small, small);
        let height = if r <= s { along } else { d - along };
        // Heron's formula in Kahan's order, in which nothing cancels ("Miscalculating
        // area and angles of a needle-like triangle", 2014).
        let mut sides = [r, s, d];
        sides.sort_by(|a, b| b.total_cmp(a));
        let [a, b, c] = sides;
        let area = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
        let corner = [area.max(0.0).sqrt() / (2.0 * d), height];
        Self { radius, cut_radius, distance, corner }
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, [x, y]: [S; 2]) -> S {
        let below = S::constant(self.distance) - y;
        let disc = S::norm([x, y]) - S::constant(self.radius);
        // `below` first: at the bite's centre the first component decides the gradient, and the
        // arc has a point straight below.
        let bite = S::constant(self.cut_radius) - S::norm([below, x]);
        let [corner_x, corner_y] = self.corner;
        let corner = S::norm([x - S::constant(corner_x), y - S::constant(corner_y)]);
        let across = [-corner_y / self.radius, corner_x / self.radius];
        let past_disc = S::weighted_sum([x, y], &across);
        let across =
            [(self.distance - corner_y) / self.cut_radius, -corner_x / self.cut_radius];
        let past_bite = S::weighted_sum([x, below], &across);
        let pieces = beside(disc, past_disc, beside(bite, past_bite, corner));
        intersection(disc.max(bite), pieces, self.size())
    }

    /// Where the circles cross.
    pub(in crate::kernel) fn corner(&self) -> [f64; 2] {
        self.corner
    }

    /// The larger radius and the distance of the centres [m].
    #[inline(always)]
    pub(in crate::kernel) fn size(&self) -> f64 {
        self.radius.max(self.cut_radius) + self.distance
    }

    /// The bounds when turned about y: those of the disc cut where the circles cross.
    pub(in crate::kernel) fn turned_bounds(&self) -> Bounds<3> {
        let top = self.corner[1].clamp(-self.radius, self.radius);
        bounds_of_zone(self.radius, [-self.radius, top])
    }
}
