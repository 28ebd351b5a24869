// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A disc cut by a line.

use super::arc::half_chord;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The part of a disc about the origin above a height.
///
/// # Derivation
///
/// The shape is the intersection of two convex sets, a disc and a half-plane. Inside, and where
/// the nearest point of the disc or of the half-plane is on the shape, the larger of their
/// distances is the distance. The nearest point on the circle remains where the angle from the
/// +y axis is less than that of the corner, which is the end of the cut. Else the nearest point
/// is on the cut where `p` is below it, or the corner.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct CutDiskProfile {
    radius: f64,
    height: f64,
    half_width: f64,
}

impl CutDiskProfile {
    /// The part of a disc of `radius` [m] above `height` [m], with `|height| < radius`.
    pub(in crate::kernel) fn new(radius: f64, height: f64) -> Self {
        Self { radius, height, half_width: half_chord(radius, height) }
    }

    /// Half the straight edge [m].
    pub(in crate::kernel) fn half_width(&self) -> f64 {
        self.half_width
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: [S; 2]) -> S {
        let zero = S::constant(0.0);
        let below = S::constant(self.height) - p[1];
        let across = p[0] - S::constant(self.half_width);
        let inside = (S::norm(p) - S::constant(self.radius)).max(below);
        let corner = face_if_on_it(S::norm([across, below]), inside, self.radius);
        let cut = S::select_less(across, zero, below, corner);
        let [x, y] = [self.half_width / self.radius, self.height / self.radius];
        let before_corner = S::weighted_sum(p, &[-y, x]);
        let outside = S::select_less(zero, before_corner, inside, cut);
        S::select_less(inside, zero, inside, outside)
    }
}

/// The bounds of a ball's part between two heights, of which one may be an end of the
/// ball.
pub(in crate::kernel) fn bounds_of_zone(radius: f64, [low, high]: [f64; 2]) -> Bounds<3> {
    let widest_at = 0.0_f64.max(low).min(high);
    let widest = half_chord(radius, widest_at);
    let aabb =
        Aabb { min: Vector([-widest, low, -widest]), max: Vector([widest, high, widest]) };
    let slack = 8.0 * f64::EPSILON * radius;
    let ball = BoundingBall { centre: Vector([0.0, widest_at, 0.0]), radius: widest + slack };
    Bounds { aabb: aabb.grown(slack), ball }
}
