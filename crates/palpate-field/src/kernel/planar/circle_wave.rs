// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Waves of circular arcs.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{at, sets};
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::{Promise, Quality};
use crate::scalar::Scalar;
use crate::vector::Vector;

/// Folds of the x axis: as many as a double has digits. Farther out than they reach, the
/// rounding of a coordinate exceeds a wave.
const FOLDS: i32 = 54;

/// The largest opening of an arc: at more, neighbours would cross.
const LARGEST_ANGLE: f64 = 5.0 / 3.0 * PI;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 5.0;

/// All points within `radius` of an endless line of equal arcs, up and down in turn,
/// along the x axis, which they meet where they continue each other. A crest is at
/// x = 0.
///
/// Exact; inside a bound where the tube meets itself. With a radius of zero it has no
/// inside.
///
/// # Derivation
///
/// With R the radius of the arcs and 2h their opening, an arc is `2w = 2R sin h` wide. The line
/// is its own mirror image about x = 0, the middle of a crest, and x = 2w, that of a trough, so
/// x folds to `[0, 2w]`: `|x|` first, then, from the largest power of two down,
/// `min(x, 2m − x)` at each mirror m; no fold rounds, since it subtracts numbers within a
/// factor of two of each other. The strip holds half a crest and half a trough. The nearest
/// point of each is on its arc or at its end, as for [`Arc`](crate::kernel::Arc).
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CircleWave};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // Half circles of radius 5: crests at x = 0, 20, 40.
/// let wave = CircleWave::new(5.0, std::f64::consts::PI, 0.5)?;
/// let wave = Shape::from_kernel(wave);
/// assert!((wave.distance(Vector([40.0, 7.0])) - 1.5).abs() < 1e-14); // above a crest
/// assert!((wave.distance(Vector([-10.0, -1.0])) - 3.5).abs() < 1e-14); // in a trough
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CircleWave {
    ring_radius: f64,
    radius: f64,
    half_angle: f64,
    /// Sine and cosine of half the angle.
    end: [f64; 2],
}

impl CircleWave {
    /// A line of arcs of `ring_radius` [m] that span `angle` [rad] each, with a tube of
    /// `radius` [m].
    ///
    /// # Errors
    ///
    /// If the arcs' radius is not positive, the tube's negative, or the angle not in
    /// (0, 5π/3].
    pub fn new(ring_radius: f64, angle: f64, radius: f64) -> Result<Self, ShapeError> {
        positive("ring_radius", ring_radius, Unit::Metre)?;
        not_negative("radius", radius, Unit::Metre)?;
        if !(angle > 0.0 && angle <= LARGEST_ANGLE) {
            let rule = "in (0, 5π/3], where neighbours touch";
            return Err(ShapeError::number("angle", rule, angle, Unit::Radian));
        }
        let half_angle = 0.5 * angle;
        let end = [libm::sin(half_angle), libm::cos(half_angle)];
        Ok(Self { ring_radius, radius, half_angle, end })
    }

    /// From the middle of a crest to that of a trough.
    fn half_wave(&self) -> f64 {
        2.0 * self.ring_radius * self.end[0]
    }

    /// x, folded to between the middle of a crest and that of the next trough.
    #[inline(always)]
    fn folded<S: Scalar>(&self, x: S) -> S {
        let mut x = x.abs();
        for fold in (1..=FOLDS).rev() {
            // Twice the mirror; a power of two does not round.
            let twice = (1_u64 << fold) as f64 * self.half_wave();
            x = x.min(S::constant(twice) - x);
        }
        x.clamp(0.0, self.half_wave())
    }

    /// The distance to half an arc about the +y axis, for `x ≥ 0`.
    #[inline(always)]
    fn to_arc<S: Scalar>(&self, x: S, y: S) -> S {
        let [sin, cos] = self.end;
        let q = Vector([x, y]);
        let past_end = q.dot_constant(&[cos, -sin]);
        let end = Vector([sin, cos]).scale(self.ring_radius);
        let to_end = (q - Vector::of(&end.0)).norm();
        let to_circle = (q.norm() - S::constant(self.ring_radius)).abs();
        S::select_less(S::constant(0.0), past_end, to_end, to_circle)
    }
}

impl Kernel<2> for CircleWave {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let x = self.folded(p.0[0]);
        let across = S::constant(self.half_wave()) - x;
        let below = S::constant(self.ring_radius * self.end[1]);
        let crest = self.to_arc(x, p.0[1] + below);
        let trough = self.to_arc(across, below - p.0[1]);
        crest.min(trough) - S::constant(self.radius)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        let size = self.ring_radius + self.radius;
        Some(Evaluations { operations: OPERATIONS, size })
    }

    fn promise(&self) -> Promise<2> {
        // The gap between crests, which may close if arcs are more than half circles.
        let gap = 2.0 * (self.half_wave() - self.ring_radius);
        let meets_itself = self.radius > self.ring_radius
            || (self.half_angle > FRAC_PI_2 && gap < 2.0 * self.radius);
        Promise {
            inside: if meets_itself { Quality::Bound } else { Quality::Exact },
            has_interior: self.radius > 0.0,
            symmetric: [true, false],
            ..Promise::exact(None, OPERATIONS, self.ring_radius + self.radius)
        }
    }
}

primitive! {
    CircleWave, circle_wave, 2,
    about: "All points within a radius of an endless line of arcs, up and down in turn.",
    origin: "endless along x; a crest at x = 0, arcs that meet at y = 0",
    parameters: {
        ring_radius: Length = "the radius of the arcs",
        angle: Angle = "how much of a circle each arc is, at most 300°"
            => |kernel| 2.0 * kernel.half_angle,
        radius: LengthOrZero = "the radius of the tube, zero for a curve without inside",
    },
    marks: |kernel| {
        let centre = at(0.0, -kernel.ring_radius() * kernel.end[1]);
        sets::arc(centre, kernel.ring_radius(), kernel.angle(), kernel.radius())
    },
    example: (0.31, 4.0, 0.08),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, FAR, Patch, Row};
    use crate::vector::Point;

    impl Evidence<2> for CircleWave {
        const SAMPLE: &'static str =
            r#"{ "ring_radius": 0.015, "angle_degrees": 200, "radius": 0.003 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Circle Wave",
            "`ring_radius`, `angle` up to 300°, `radius` 0",
            "exact, unbounded; inside a bound where the tube meets itself",
        )];

        fn definition(&self) -> Definition<2> {
            circle_wave(self.ring_radius(), self.angle(), self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 5.5, 0.1)]
        }
    }

    /// Equal arcs about points on either side of the x axis in turn.
    fn circle_wave(ring: f64, angle: f64, r: f64) -> Definition<2> {
        let half = 0.5 * angle;
        let pitch = 2.0 * ring * half.sin();
        // The centre of an arc, and which way it bulges.
        let arc_of = move |index: f64| {
            let up = if index.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
            (Vector([pitch * index, -up * ring * half.cos()]), up)
        };
        let last = (FAR / pitch).ceil() + 1.0;
        let count = 2.0 * last + 1.0;
        let mut boundary = Vec::new();
        for side in [r, -r] {
            let speed = count * angle * (ring + r);
            boundary.push(Patch::curve(speed, move |t| {
                let place = t * count;
                let index = place.floor().min(count - 1.0);
                let (centre, up) = arc_of(index - last);
                let turned = (place - index - 0.5) * angle;
                centre + Vector([turned.sin(), up * turned.cos()]) * (ring + up * side)
            }));
        }
        let wave = Definition::new(boundary, move |p: Point<2>| {
            let nearest = (p[0] / pitch).round();
            (-3..=3_i32).any(|i| {
                let (centre, up) = arc_of(nearest + f64::from(i));
                let [x, y] = (p - centre).0;
                let end = Vector([half.sin(), half.cos()]) * ring;
                let distance = if x.abs().atan2(y * up) <= half {
                    (x.hypot(y) - ring).abs()
                } else {
                    (Vector([x.abs(), y * up]) - end).norm()
                };
                distance < r
            })
        });
        Definition {
            overlaps_itself: r > ring || (half > 0.5 * PI && pitch - ring < r),
            ..wave
        }
    }
}
