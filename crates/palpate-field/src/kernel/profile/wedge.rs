// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sectors of discs and rings.

use crate::error::{ShapeError, Unit};
use crate::scalar::Scalar;

/// The angle between the +y axis and a ray from the origin, and the straight piece of an
/// outline on the ray.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Wedge {
    /// The angle from the axis to the ray.
    half_angle: f64,
    /// Its sine and cosine: the direction of the ray.
    end: [f64; 2],
    /// Where the piece on the ray begins and ends, from the origin.
    inner: f64,
    outer: f64,
}

impl Wedge {
    /// Half of a wedge that spans `angle` [rad] about the +y axis, with a piece on its ray from
    /// `inner` to `outer` [m].
    ///
    /// # Errors
    ///
    /// If the angle is not in (0, 2π).
    pub(in crate::kernel) fn new(
        angle: f64,
        inner: f64,
        outer: f64,
    ) -> Result<Self, ShapeError> {
        let half_angle = half_of_less_than_a_turn(angle)?;
        let end = [libm::sin(half_angle), libm::cos(half_angle)];
        Ok(Self { half_angle, end, inner, outer })
    }

    /// The signed distance of the intersection of the wedge with `round`, a disc or ring
    /// whose distance is given.
    ///
    /// Outside the wedge, the nearest point is on the straight piece. In the wedge and outside
    /// `round`, the nearest point of `round` lies on the same ray from the origin, so it is in
    /// the wedge too. Inside both, the nearer boundary decides; points of the ray off the piece
    /// are outside `round`, whose boundary is nearer.
    #[inline(always)]
    pub(in crate::kernel) fn cut<S: Scalar>(&self, p: [S; 2], round: S) -> S {
        let zero = S::constant(0.0);
        let [sin, cos] = self.end;
        let out = S::weighted_sum(p, &[cos, -sin]);
        let along = S::weighted_sum(p, &[sin, cos]);
        let before = S::constant(self.inner) - along;
        let past = before.max(along - S::constant(self.outer)).max(zero);
        let to_piece = S::norm([out, past]);
        // Beside the piece the signed offset, which has a gradient on the piece too.
        let inside = S::select_less(zero, past, -to_piece, out);
        S::select_less(zero, out, to_piece, round.max(inside))
    }

    /// The signed distance of the sector of a disc whose radius is the end of the piece.
    #[inline(always)]
    pub(in crate::kernel) fn sector<S: Scalar>(&self, p: [S; 2]) -> S {
        self.cut(p, S::norm(p) - S::constant(self.outer))
    }

    /// `true` if the wedge is convex: if it spans at most half a turn.
    pub(in crate::kernel) fn is_convex(&self) -> bool {
        self.half_angle <= std::f64::consts::FRAC_PI_2
    }

    /// The full angle, to both sides of the axis [rad].
    pub(in crate::kernel) fn angle(&self) -> f64 {
        2.0 * self.half_angle
    }

    /// Sine and cosine of the angle from the axis to the ray.
    pub(in crate::kernel) fn end(&self) -> [f64; 2] {
        self.end
    }

    /// Where the piece on the ray begins, from the origin [m].
    pub(in crate::kernel) fn inner(&self) -> f64 {
        self.inner
    }

    /// Where it ends [m].
    pub(in crate::kernel) fn outer(&self) -> f64 {
        self.outer
    }
}

/// Half of an angle in (0, 2π) [rad].
pub(in crate::kernel) fn half_of_less_than_a_turn(angle: f64) -> Result<f64, ShapeError> {
    // Written so that NaN fails.
    if angle > 0.0 && angle < std::f64::consts::TAU {
        return Ok(0.5 * angle);
    }
    let rule = "in (0, 2π), less than a full turn";
    Err(ShapeError::number("angle", rule, angle, Unit::Radian))
}
