// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What outlines in the plane share.

use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, finite, positive};
use crate::field::Placement;
use crate::kernel::face_if_on_it;
use crate::pose::{Pose, Rotation};
use crate::scalar::Scalar;
use crate::vector::{Point, Vector};

/// The distance of a shape of `size` [m] that is the intersection of sides
/// (half-planes, discs, what is outside a disc): inside the largest distance to a side,
/// `sides`; outside that to the nearest piece of the outline, `pieces`.
#[inline(always)]
pub(super) fn intersection<S: Scalar>(sides: S, pieces: S, size: f64) -> S {
    let outside = face_if_on_it(pieces, sides, size);
    S::select_less(sides, S::constant(0.0), sides, outside)
}

/// The distance to one piece of an outline, or to the others, which are `otherwise` away.
/// `out` is the offset from the piece's line or circle, negative inside.
///
/// A point on or out of it that is not `past` the piece's ends is beside the piece, which
/// then is the nearest. The smaller of both would not do: next to an end they differ by
/// less than their rounding, and the direction from the end is only nearly the normal.
#[inline(always)]
pub(super) fn beside<S: Scalar>(out: S, past: S, otherwise: S) -> S {
    let zero = S::constant(0.0);
    // Behind the piece, seen through the shape: so that models over cells on the outline
    // do not have to choose between far apart numbers.
    let behind = otherwise.min(out.abs());
    S::select_less(zero, past, otherwise, S::select_less(out, zero, behind, out))
}

/// The box `aabb`, and of the ball of `radius` about (0, `height`) and the one
/// around the box the smaller.
pub(super) fn bounds_about(aabb: Aabb<2>, height: f64, radius: f64) -> Bounds<2> {
    let centre = Vector([0.0, height]);
    let ball = BoundingBall { centre, radius: radius * (1.0 + 8.0 * f64::EPSILON) };
    let around = Bounds::of_box(aabb);
    if around.ball.radius < ball.radius { around } else { Bounds { aabb, ball } }
}

/// A frame whose origin is half-way between two points, its y axis towards `to`,
/// and half their distance [m].
pub(super) fn frame_between(
    from: Point<2>,
    to: Point<2>,
) -> Result<(Placement<2>, f64), ShapeError> {
    for (name, point) in [("from", from), ("to", to)] {
        for x in point.0 {
            finite(name, x, Unit::Metre)?;
        }
    }
    let apart = (to - from).norm();
    let away = || ShapeError::number("to", "away from `from`", apart, Unit::Metre);
    positive("to", apart, Unit::Metre).map_err(|_| away())?;
    let [x, y] = (to - from).normalized().ok_or_else(away)?.0;
    let rotation = Rotation::from_matrix([[y, x], [-x, y]])?;
    Ok((Placement::new(Pose::new(rotation, (from + to) * 0.5)), 0.5 * apart))
}

/// Half of an angle in (0, 2π) [rad].
pub(super) fn half_of_less_than_a_turn(angle: f64) -> Result<f64, ShapeError> {
    // Written so that NaN fails.
    if angle > 0.0 && angle < std::f64::consts::TAU {
        return Ok(0.5 * angle);
    }
    let rule = "in (0, 2π), less than a full turn";
    Err(ShapeError::number("angle", rule, angle, Unit::Radian))
}
