// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Helpers that outlines in the plane share.

use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, finite, positive};
use crate::pose::Placement;
use crate::pose::{Pose, Rotation};
use crate::vector::{Point, Vector};

/// The box `aabb`, and the smaller of two balls: that of `radius` about (0, `height`), and the
/// one around the box.
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
