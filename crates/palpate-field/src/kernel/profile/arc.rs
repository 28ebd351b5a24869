// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An arc of a circle.

use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::scalar::Scalar;
use crate::vector::{Vector, array};

/// An arc of a circle about the origin, from the +y axis to an angle from it.
///
/// # Derivation
///
/// With φ the angle from the y axis, the nearest point is on the arc at φ if φ is at most that
/// of the end, else it is the end. Whether φ is larger follows from the sign of the offset from
/// the line through the end and the origin, without an inverse function.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Curve {
    radius: f64,
    /// The direction of the end: sine and cosine of the angle.
    end: [f64; 2],
    /// The radius of the largest tube around the arc and its mirror image that does
    /// not meet itself [m].
    room: f64,
}

impl Curve {
    /// An arc of `radius` [m] to `angle` [rad], at most π.
    ///
    /// A thick tube about the arc fills the centre. If the arc spans more than a quarter turn,
    /// a thinner tube may already meet its mirror image past the ends.
    pub(in crate::kernel) fn to_angle(radius: f64, angle: f64) -> Self {
        let end = [libm::sin(angle), libm::cos(angle)];
        let whole = angle >= std::f64::consts::PI;
        let room = if end[1] < 0.0 && !whole { radius * end[0] } else { radius };
        Self { radius, end, room }
    }

    /// Half the arc of a tube: of a circle of `ring_radius` [m], `angle` [rad] of it, the
    /// tube with `radius` [m].
    ///
    /// # Errors
    ///
    /// If the circle's radius is not positive, the tube's negative, or the angle not
    /// in (0, 2π].
    pub(in crate::kernel) fn of_tube(
        ring_radius: f64,
        angle: f64,
        radius: f64,
    ) -> Result<Self, ShapeError> {
        positive("ring_radius", ring_radius, Unit::Metre)?;
        not_negative("radius", radius, Unit::Metre)?;
        if !(angle > 0.0 && angle <= std::f64::consts::TAU) {
            let rule = "in (0, 2π], a full turn at most";
            return Err(ShapeError::number("angle", rule, angle, Unit::Radian));
        }
        Ok(Self::to_angle(ring_radius, 0.5 * angle))
    }

    /// The part of a circle of `radius` that is above `height` [m], which is between
    /// them.
    pub(in crate::kernel) fn above(radius: f64, height: f64) -> Self {
        let half_width = half_chord(radius, height);
        let room = if height < 0.0 { half_width } else { radius };
        Self { radius, end: [half_width / radius, height / radius], room }
    }

    /// The direction of the end: sine and cosine of its angle.
    pub(in crate::kernel) fn end(&self) -> [f64; 2] {
        self.end
    }

    /// The radius of the largest tube that does not meet itself [m].
    pub(in crate::kernel) fn room(&self) -> f64 {
        self.room
    }

    /// The distance to the arc, which has no inside.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: [S; 2]) -> S {
        let [sin, cos] = self.end;
        let past_end = S::weighted_sum(p, &[cos, -sin]);
        let end = Vector(self.end) * self.radius;
        // y first: at the centre the first component decides the gradient, and every arc has a
        // point on the +y axis.
        let from_centre = S::norm([p[1], p[0]]);
        let to_arc = (from_centre - S::constant(self.radius)).abs();
        let to_end = S::norm(array!(i < 2 => p[i] - S::constant(end.0[i])));
        S::select_less(S::constant(0.0), past_end, to_end, to_arc)
    }
}

/// Half the chord of a circle of `radius` at `height` from its centre [m].
pub(in crate::kernel) fn half_chord(radius: f64, height: f64) -> f64 {
    ((radius - height) * (radius + height)).sqrt()
}
