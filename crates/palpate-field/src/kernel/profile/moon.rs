// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A disc with a bite.

use super::bounds_of_zone;
use crate::bounds::Bounds;
use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;

/// A disc about the origin without another whose centre is on the +y axis.
///
/// # Derivation
///
/// The boundary is an arc of either circle, between the corner where both cross and the
/// y axis. An arc is as far away as its circle, where the angle about its centre is on
/// the arc's side of the corner, else as the corner. Inside, what is outside is beyond
/// the disc or in the bite: there the nearer of both circles counts, arc or not.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Moon {
    radius: f64,
    cut_radius: f64,
    distance: f64,
    /// Where the circles cross.
    corner: [f64; 2],
}

impl Moon {
    /// A disc of `radius` without one of `cut_radius`, their centres `distance` apart
    /// [m]; the circles cross.
    pub(in crate::kernel) fn new(radius: f64, cut_radius: f64, distance: f64) -> Self {
        let (r, s, d) = (radius, cut_radius, distance);
        let height = ((r - s) * (r + s) + d * d) / (2.0 * d);
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
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: [S; 2]) -> S {
        let zero = S::constant(0.0);
        let from_bite = [p[0], p[1] - S::constant(self.distance)];
        let disc = S::norm(p) - S::constant(self.radius);
        let bite = S::constant(self.cut_radius) - S::norm(from_bite);
        let inside = disc.max(bite);
        // How far past the corner's angle, from +y about each centre.
        let [x, y] = self.corner;
        let kept = S::weighted_sum(p, &[y / self.radius, -x / self.radius]);
        let below = y - self.distance;
        let within =
            S::weighted_sum(from_bite, &[below / self.cut_radius, -x / self.cut_radius]);
        let corner = S::norm([p[0] - S::constant(x), p[1] - S::constant(y)]);
        let corner = face_if_on_it(corner, inside, self.radius);
        let of_disc = S::select_less(kept, zero, corner, disc.abs());
        let of_bite = S::select_less(within, zero, corner, bite.abs());
        let outside = of_disc.min(of_bite);
        S::select_less(inside, zero, inside, outside)
    }

    /// The bounds when turned about y: those of the disc cut where the circles cross.
    pub(in crate::kernel) fn turned_bounds(&self) -> Bounds<3> {
        let top = self.corner[1].clamp(-self.radius, self.radius);
        bounds_of_zone(self.radius, [-self.radius, top])
    }
}
