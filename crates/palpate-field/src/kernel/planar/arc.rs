// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Circular arcs with a radius.

use crate::bounds::{Aabb, Bounds};
use crate::error::ShapeError;
use crate::kernel::mark::sets;
use crate::kernel::profile::Curve;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::{Promise, Quality};
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 8.0;

/// All points within `radius` of an arc of a circle about the origin, open
/// downwards.
///
/// Exact; inside a bound where the tube meets itself, at the centre or across
/// the opening. With a radius of zero it has no inside.
///
/// Folded to `x ≥ 0`, the shape is all points within `radius` of half the arc.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Arc};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let half = std::f64::consts::PI;
/// let handle = Shape::from_kernel(Arc::new(2.0, half, 0.5)?);
/// assert_eq!(handle.distance(Vector([3.0, 4.0])), 2.5); // above
/// assert!((handle.distance(Vector([2.0, -3.0])) - 2.5).abs() < 1e-15); // from the end
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Arc {
    ring_radius: f64,
    angle: f64,
    radius: f64,
    half: Curve,
}

impl Arc {
    /// An arc of a circle of `ring_radius` [m] that spans `angle` [rad] about the
    /// +y axis, with a tube of `radius` [m].
    ///
    /// # Errors
    ///
    /// If the circle's radius is not positive, the tube's negative, or the angle
    /// not in (0, 2π].
    pub fn new(ring_radius: f64, angle: f64, radius: f64) -> Result<Self, ShapeError> {
        let half = Curve::of_tube(ring_radius, angle, radius)?;
        Ok(Self { ring_radius, angle, radius, half })
    }
}

impl Kernel<2> for Arc {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.half.distance([p.0[0].abs(), p.0[1]]) - S::constant(self.radius)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.ring_radius + self.radius })
    }

    fn promise(&self) -> Promise<2> {
        let [sin, cos] = self.half.end();
        let widest = if cos < 0.0 { 1.0 } else { sin };
        let aabb = Aabb {
            min: Vector([-widest, cos]).scale(self.ring_radius),
            max: Vector([widest, 1.0]).scale(self.ring_radius),
        };
        let bounds = Bounds::of_box(aabb.grown(4.0 * f64::EPSILON * self.ring_radius));
        let meets_itself = self.radius > self.half.room();
        Promise {
            inside: if meets_itself { Quality::Bound } else { Quality::Exact },
            has_interior: self.radius > 0.0,
            symmetric: [true, false],
            ..Promise::exact(
                Some(bounds.grown(self.radius)),
                OPERATIONS,
                self.ring_radius + self.radius,
            )
        }
    }
}

primitive! {
    Arc, arc, 2,
    about: "All points within a radius of an arc of a circle, open downwards.",
    origin: "at the centre of its circle; open downwards",
    parameters: {
        ring_radius: Length = "the radius of the circle",
        angle: Angle = "how much of the circle, about the +y axis",
        radius: LengthOrZero = "the radius of the tube, zero for a curve without inside",
    },
    marks: |kernel| {
        sets::arc(Vector::ZERO, kernel.ring_radius(), kernel.angle(), kernel.radius())
    },
    example: (0.7, 4.0, 0.12),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc};
    use crate::vector::Point;

    impl Evidence<2> for Arc {
        const SAMPLE: &'static str =
            r#"{ "ring_radius": 0.04, "angle_degrees": 240, "radius": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Arc",
            "`ring_radius`, `angle`, `radius`",
            "exact; inside a bound where the tube meets itself",
        )];

        fn definition(&self) -> Definition<2> {
            tube(self.ring_radius(), self.angle(), self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(1.0, 6.5, 0.1)]
        }
    }

    /// All points within `r` of an arc. Where the tube meets itself, parts of these pieces lie
    /// inside.
    fn tube(ring: f64, angle: f64, r: f64) -> Definition<2> {
        let half = 0.5 * angle;
        // Angles here are from +x, those of the arc from +y.
        let span = [0.5 * PI - half, 0.5 * PI + half];
        let ends = span.map(|a| [ring * a.cos(), ring * a.sin()]);
        let mut boundary = Vec::new();
        for radius in [ring - r, ring + r] {
            boundary.push(arc([0.0; 2], radius.abs(), span));
        }
        if angle < TAU {
            for (end, from) in ends.into_iter().zip([span[0] - PI, span[1]]) {
                boundary.push(arc(end, r, [from, from + PI]));
            }
        }
        let gap = 2.0 * ring * half.sin();
        let overlaps_itself = r > ring || (half > 0.5 * PI && angle < TAU && gap < 2.0 * r);
        let tube = Definition::new(boundary, move |p: Point<2>| {
            let turned = p[0].abs().atan2(p[1]);
            let on_arc = Vector([half.sin(), half.cos()]) * ring;
            let from_arc = if turned <= half {
                (p.norm() - ring).abs()
            } else {
                (Vector([p[0].abs(), p[1]]) - on_arc).norm()
            };
            from_arc < r
        });
        Definition { overlaps_itself, ..tube }
    }
}
