// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A disc cut by a line.

use super::arc::half_chord;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The part of a disc about the origin below a height.
///
/// # Derivation
///
/// Two convex sets meet, so inside and where only one of them is left, the larger of
/// their distances is the distance. Its nearest point on the circle is kept where the
/// angle from the +y axis is larger than that of the corner, which is the end of the
/// cut. Else the nearest point is on the cut where `p` is above it, or the corner.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct CutDisc {
    radius: f64,
    height: f64,
    half_width: f64,
}

impl CutDisc {
    /// The part of a disc of `radius` [m] below `height` [m], of less than that
    /// size.
    pub(in crate::kernel) fn new(radius: f64, height: f64) -> Self {
        Self { radius, height, half_width: half_chord(radius, height) }
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: [S; 2]) -> S {
        let zero = S::constant(0.0);
        let above = p[1] - S::constant(self.height);
        let across = p[0] - S::constant(self.half_width);
        let inside = (S::norm(p) - S::constant(self.radius)).max(above);
        let corner = face_if_on_it(S::norm([across, above]), inside, self.radius);
        let cut = S::select_less(across, zero, above, corner);
        let [x, y] = [self.half_width / self.radius, self.height / self.radius];
        let past_corner = S::weighted_sum(p, &[y, -x]);
        let outside = S::select_less(zero, past_corner, inside, cut);
        S::select_less(inside, zero, inside, outside)
    }

    /// The bounds when turned about y.
    pub(in crate::kernel) fn turned_bounds(&self) -> Bounds<3> {
        let more_than_half = self.height >= 0.0;
        let widest = if more_than_half { self.radius } else { self.half_width };
        let centre = if more_than_half { 0.0 } else { self.height };
        let aabb = Aabb {
            min: Vector([-widest, -self.radius, -widest]),
            max: Vector([widest, self.height, widest]),
        };
        let radius = widest * (1.0 + 4.0 * f64::EPSILON);
        Bounds { aabb, ball: BoundingBall { centre: Vector([0.0, centre, 0.0]), radius } }
    }
}
