// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A disc with a bite.

use super::CutDisc;
use crate::bounds::Bounds;
use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;

/// A disc about the origin without another whose centre is on the +y axis.
///
/// # Derivation
///
/// Inside, the nearest point outside is outside the disc or in the bite: the nearer
/// of both circles counts. Outside, a point beyond the disc has its nearest point on
/// the disc's circle, if that is not bitten off; one in the bite has it on the bite's
/// circle, if that is in the disc. Else the nearest point is the corner where both
/// circles cross. Which part of a circle is kept shows in the angle about its centre.
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
        // Heron's formula, of which no factor is a difference of squares.
        let area = (r + s + d) * (s - d + r) * (s + d - r) * (r + d - s);
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
        let in_bite = S::select_less(within.min(bite), zero, corner, bite);
        let outside = S::select_less(kept.min(disc), zero, in_bite, disc);
        S::select_less(inside, zero, inside, outside)
    }

    /// The bounds when turned about y: those of the disc cut where the circles cross.
    pub(in crate::kernel) fn turned_bounds(&self) -> Bounds<3> {
        CutDisc::new(self.radius, self.corner[1].clamp(-self.radius, self.radius))
            .turned_bounds()
    }
}
