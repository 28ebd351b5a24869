// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The horseshoe.

use super::outline::bounds_about;
use std::f64::consts::FRAC_PI_2;

use crate::bounds::Aabb;
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, turned};
use crate::kernel::profile::half_of_less_than_a_turn;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 6.0;

/// A band along an arc about the origin and its tangents at both ends, with flat
/// ends, open downwards. Exact.
///
/// # Derivation
///
/// Fold to `x ≥ 0`. With `along` the place along the leg's axis and `out` the offset from it,
/// the leg is `|out| ≤ w`, `0 ≤ along ≤ l`. The line `along = 0` through the origin separates
/// the leg from the arc's sector. Beyond the line, the leg is nearer than the ring, which bends
/// away, and its distance is that of an orthant. Before the line and outside, the leg's nearest
/// point is on the line and belongs to the ring too, so the ring decides. Inside, the flat end
/// may be nearer than the ring.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Horseshoe};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let magnet = Shape::from_kernel(Horseshoe::new(4.0, std::f64::consts::PI, 3.0, 2.0)?);
/// assert_eq!(magnet.distance(Vector([3.0, 6.0])), 45.0_f64.sqrt() - 5.0); // above
/// assert!((magnet.distance(Vector([1.0, -2.0])) - 2.0).abs() < 1e-15); // between legs
/// assert!((magnet.distance(Vector([-4.0, -5.0])) - 2.0).abs() < 1e-15); // below
/// assert!((magnet.distance(Vector([8.0, -7.0])) - 5.0).abs() < 1e-15); // 3-4-5
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Horseshoe {
    ring_radius: f64,
    angle: f64,
    length: f64,
    half_width: f64,
    /// Sine and cosine of half the angle: from the origin to the right leg.
    end: [f64; 2],
}

impl Horseshoe {
    /// A band of full `width` along an arc of `ring_radius` [m] that spans `angle`
    /// [rad] about the +y axis, with straight legs of `length` [m].
    ///
    /// # Errors
    ///
    /// If the radius or width is not positive, the length negative or the angle not
    /// in (0, 2π); if the width is not less than twice the radius; or if the legs
    /// meet.
    pub fn new(
        ring_radius: f64,
        angle: f64,
        length: f64,
        width: f64,
    ) -> Result<Self, ShapeError> {
        positive("ring_radius", ring_radius, Unit::Metre)?;
        let half_angle = half_of_less_than_a_turn(angle)?;
        not_negative("length", length, Unit::Metre)?;
        let half_width = 0.5 * positive("width", width, Unit::Metre)?;
        if half_width >= ring_radius {
            let rule = format!("less than twice the ring radius, {} m", 2.0 * ring_radius);
            return Err(ShapeError::number("width", rule, width, Unit::Metre));
        }
        let [sin, cos] = [libm::sin(half_angle), libm::cos(half_angle)];
        // The length at which the inner edges of converging legs meet.
        let longest = (ring_radius - half_width) * sin;
        if length * -cos > longest {
            let rule = format!("at most {} m, where the legs meet", longest / -cos);
            return Err(ShapeError::number("length", rule, length, Unit::Metre));
        }
        Ok(Self { ring_radius, angle, length, half_width, end: [sin, cos] })
    }

    fn size(&self) -> f64 {
        self.ring_radius + self.half_width + self.length
    }
}

impl Kernel<2> for Horseshoe {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let [sin, cos] = self.end;
        let [radius, width] = [self.ring_radius, self.half_width].map(S::constant);
        let folded = Vector([p.0[0].abs(), p.0[1]]);
        let along = folded.dot_constant(&[cos, -sin]);
        let out = folded.dot_constant(&[sin, cos]) - radius;
        let (side, end) = (out.abs() - width, along - S::constant(self.length));
        // y first: from the centre, the +y axis leads to the ring.
        let ring = (S::norm([p.0[1], p.0[0]]) - radius).abs() - width;
        let arc = ring.max(-S::norm([-end, side.max(zero)]));
        S::select_less(zero, along, S::orthant([side, end]), arc)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.size() })
    }

    fn promise(&self) -> Promise<2> {
        let [sin, cos] = self.end;
        let at = |radius: f64, along: f64| {
            Vector([radius * sin + along * cos, radius * cos - along * sin])
        };
        let (inner, outer) =
            (self.ring_radius - self.half_width, self.ring_radius + self.half_width);
        let tip = self.length;
        let corners = [at(inner, 0.0), at(outer, 0.0), at(inner, tip), at(outer, tip)];
        let start = if cos < 0.0 { outer } else { 0.0 };
        let widest = corners.iter().fold(start, |m, c| m.max(c[0]));
        let lowest = corners.iter().fold(f64::INFINITY, |m, c| m.min(c[1]));
        let margin = 8.0 * f64::EPSILON * self.size();
        let aabb = Aabb { min: Vector([-widest, lowest]), max: Vector([widest, outer]) };
        let reach = outer.hypot(self.length) + margin;
        let bounds = bounds_about(aabb.grown(margin), 0.0, reach);
        Promise {
            symmetric: [true, false],
            ..Promise::exact(Some(bounds), OPERATIONS, self.size())
        }
    }
}

primitive! {
    Horseshoe, horseshoe, 2,
    about: "A band along an arc and its tangents at both ends, open downwards.",
    origin: "at the centre of its arc; open downwards",
    parameters: {
        ring_radius: Length = "the radius of the arc, to the middle of the band",
        angle: Angle = "how much of the circle, about the +y axis",
        length: LengthOrZero = "the length of each straight leg",
        width: Length = "the full width of the band" => |kernel| 2.0 * kernel.half_width,
    },
    marks: |kernel| {
        let (ring, half) = (kernel.ring_radius(), 0.5 * kernel.width());
        let place = |share: f64, radius: f64| turned(share * kernel.angle(), radius);
        let start: Vector<f64, 2> = place(0.5, ring + half);
        let along = turned(0.5 * kernel.angle() + FRAC_PI_2, kernel.length());
        vec![
            Mark::from_origin("ring_radius", place(0.2, ring)),
            Mark::angle("angle", |share| place(share, 0.4 * ring)),
            Mark::length_between("length", start, start + along)
                .beside(place(0.5, 1.0)),
            Mark::length_between("width", place(-0.2, ring - half), place(-0.2, ring + half)),
        ]
    },
    example: (0.7, 3.7, 0.55, 0.3),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, arc, both_sides};

    impl Evidence<2> for Horseshoe {
        const SAMPLE: &'static str =
            r#"{ "ring_radius": 0.035, "angle_degrees": 200, "length": 0.03, "width": 0.015 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Horseshoe", "`ring_radius`, `angle`, `length`, `width`", "exact")];

        fn definition(&self) -> Definition<2> {
            horseshoe(self.ring_radius(), self.angle(), self.length(), self.width())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 1.0, 0.25, 1.0), Self::new(0.5, 5.0, 0.75, 0.25)]
        }
    }

    fn horseshoe(ring: f64, angle: f64, length: f64, width: f64) -> Definition<2> {
        let half = 0.5 * angle;
        let (inner, outer) = (ring - 0.5 * width, ring + 0.5 * width);
        let angles = [FRAC_PI_2 - half, FRAC_PI_2];
        let (out, along) =
            (Vector([half.sin(), half.cos()]), Vector([half.cos(), -half.sin()]));
        let at = |r: f64, t: f64| out * r + along * t;
        let mut right = vec![Patch::segment(at(inner, length), at(outer, length))];
        for r in [inner, outer] {
            right.push(arc([0.0; 2], r, angles));
            right.push(Patch::segment(at(r, 0.0), at(r, length)));
        }
        both_sides(right, move |p| {
            let p = Vector([p[0].abs(), p[1]]);
            let r = if p[0].atan2(p[1]) < half { p.norm() } else { p.dot(out) };
            inner < r && r < outer && p.dot(along) < length
        })
    }
}
