// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tubes about rings that lie flat: the torus, a part of it, and a chain's link.

use super::cylinder::from_axis;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, at, sets, turned};
use crate::kernel::profile::Curve;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::{Promise, Quality};
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distance of a capped torus.
const CAPPED_OPERATIONS: f64 = 10.0;

/// The same for a link.
const LINK_OPERATIONS: f64 = 9.0;

/// All points within `radius` of a circle about the y axis. Exact.
///
/// `f = ‖(√(x² + z²) − R, y)‖ − r`.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Torus};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ring = Shape::from_kernel(Torus::new(5.0, 1.0)?);
/// assert_eq!(ring.distance(Vector([0.0, 0.0, 0.0])), 4.0); // in the hole
/// assert_eq!(ring.distance(Vector([3.0, 12.0, 4.0])), 11.0); // above
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Torus {
    pub(super) ring_radius: f64,
    pub(super) radius: f64,
}

impl Torus {
    /// A torus around a circle of `ring_radius`, its tube of `radius` [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, or the tube's is the larger, so that the tube would meet
    /// itself at the axis.
    pub fn new(ring_radius: f64, radius: f64) -> Result<Self, ShapeError> {
        positive("ring_radius", ring_radius, Unit::Metre)?;
        positive("radius", radius, Unit::Metre)?;
        if radius > ring_radius {
            let rule = format!("at most the radius of the ring, {ring_radius} m");
            return Err(ShapeError::number("radius", rule, radius, Unit::Metre));
        }
        Ok(Self { ring_radius, radius })
    }
}

impl Kernel<3> for Torus {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        S::norm([from_axis(p) - S::constant(self.ring_radius), p.0[1]])
            - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<3> {
        let reach = self.ring_radius + self.radius;
        let bounds = Bounds::centred(Vector([reach, self.radius, reach]), reach);
        Promise::exact(Some(bounds), 8.0, reach).symmetric()
    }
}

primitive! {
    Torus, torus, 3,
    about: "All points within a radius of a circle about the y axis.",
    origin: "centred; axis along y",
    parameters: {
        ring_radius: Length = "the radius of the circle",
        radius: Length = "the radius of the tube",
    },
    marks: |kernel| sets::ring(kernel.ring_radius(), kernel.radius()),
    example: (0.6, 0.2),
}

/// All points within `radius` of an arc of a circle about the y axis, open towards −z.
///
/// Exact; inside a bound where the tube meets itself, at the centre or across the
/// opening. With a radius of zero it has no inside.
///
/// # Derivation
///
/// Folded to `x ≥ 0`, the distance from the arc in its plane is that of half a planar
/// arc, with z for the planar y; the height above the plane is across it.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CappedTorus};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let half = std::f64::consts::PI;
/// let handle = Shape::from_kernel(CappedTorus::new(2.0, 0.5, half)?);
/// assert_eq!(handle.distance(Vector([0.0, 4.0, 5.0])), 4.5); // 5 from the middle
/// assert!((handle.distance(Vector([2.0, 4.0, -3.0])) - 4.5).abs() < 1e-15); // from an end
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CappedTorus {
    ring_radius: f64,
    radius: f64,
    angle: f64,
    half: Curve,
}

impl CappedTorus {
    /// An arc of a circle of `ring_radius` [m] that spans `angle` [rad] about the +z
    /// axis, with a tube of `radius` [m].
    ///
    /// # Errors
    ///
    /// If the circle's radius is not positive, the tube's negative, or the angle not
    /// in (0, 2π].
    pub fn new(ring_radius: f64, radius: f64, angle: f64) -> Result<Self, ShapeError> {
        let half = Curve::of_tube(ring_radius, angle, radius)?;
        Ok(Self { ring_radius, radius, angle, half })
    }
}

impl Kernel<3> for CappedTorus {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.0;
        S::norm([self.half.distance([x.abs(), z]), y]) - S::constant(self.radius)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations {
            operations: CAPPED_OPERATIONS,
            size: self.ring_radius + self.radius,
        })
    }

    fn promise(&self) -> Promise<3> {
        let [sin, cos] = self.half.end();
        let widest = if cos < 0.0 { 1.0 } else { sin };
        let aabb = Aabb {
            min: Vector([-widest, 0.0, cos]) * self.ring_radius,
            max: Vector([widest, 0.0, 1.0]) * self.ring_radius,
        };
        let slack = 4.0 * f64::EPSILON * self.ring_radius;
        let bounds = Bounds {
            aabb: aabb.grown(slack),
            ball: BoundingBall {
                centre: Vector([0.0, 0.0, cos.max(0.0) * self.ring_radius]),
                radius: widest * self.ring_radius + slack,
            },
        };
        let meets_itself = self.radius > self.half.room();
        let size = self.ring_radius + self.radius;
        Promise {
            inside: if meets_itself { Quality::Bound } else { Quality::Exact },
            has_interior: self.radius > 0.0,
            symmetric: [true, true, false],
            ..Promise::exact(Some(bounds.grown(self.radius)), CAPPED_OPERATIONS, size)
        }
    }
}

primitive! {
    CappedTorus, capped_torus, 3,
    about: "All points within a radius of an arc of a circle about the y axis, open towards -z.",
    origin: "at the centre of its circle; axis along y, open towards -z",
    parameters: {
        ring_radius: Length = "the radius of the circle",
        radius: LengthOrZero = "the radius of the tube, zero for a curve without inside",
        angle: Angle = "how much of the circle, about the +z axis",
    },
    marks: |kernel| {
        let (ring, radius) = (kernel.ring_radius(), kernel.radius());
        let place = |share: f64, radius: f64| {
            let [x, z] = turned::<2>(share * kernel.angle(), radius).0;
            Vector([x, 0.0, z])
        };
        vec![
            Mark::from_origin("ring_radius", place(0.2, ring)),
            Mark::length_between("radius", place(-0.2, ring), place(-0.2, ring + radius)),
            Mark::angle("angle", |share| place(share, 0.4 * ring)),
        ]
    },
    example: (0.7, 0.15, 4.0),
}

/// A chain's link: a torus about the y axis with straight sides along z. Exact.
///
/// A torus cut in the middle, pulled apart and joined. In its plane, the curve inside the tube
/// is at `ring_radius` from a segment; the curve's nearest point lies on the ray from the
/// segment's nearest point through `p`.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Link};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let link = Shape::from_kernel(Link::new(2.0, 0.5, 6.0)?);
/// assert_eq!(link.distance(Vector([0.0, 0.0, 1.0])), 1.5); // in the hole
/// assert_eq!(link.distance(Vector([5.0, 4.0, -2.0])), 4.5); // beside a side
/// assert_eq!(link.distance(Vector([0.0, 4.0, 8.0])), 4.5); // past the bow
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Link {
    ring_radius: f64,
    radius: f64,
    half_length: f64,
}

impl Link {
    /// A link with bows of `ring_radius`, its tube of `radius`, its straight sides of
    /// `length` [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, the tube's is the larger, or the length is
    /// negative.
    pub fn new(ring_radius: f64, radius: f64, length: f64) -> Result<Self, ShapeError> {
        let torus = Torus::new(ring_radius, radius)?;
        let half_length = 0.5 * not_negative("length", length, Unit::Metre)?;
        Ok(Self { ring_radius: torus.ring_radius, radius: torus.radius, half_length })
    }
}

impl Kernel<3> for Link {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.0;
        let along = (z.abs() - S::constant(self.half_length)).max(S::constant(0.0));
        let from_curve = S::norm([x, along]) - S::constant(self.ring_radius);
        S::norm([from_curve, y]) - S::constant(self.radius)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations {
            operations: LINK_OPERATIONS,
            size: self.half_length + self.ring_radius + self.radius,
        })
    }

    fn promise(&self) -> Promise<3> {
        let reach = self.ring_radius + self.radius;
        let half = Vector([reach, self.radius, reach + self.half_length]);
        Promise::exact(Some(Bounds::centred(half, half[2])), LINK_OPERATIONS, half[2])
            .symmetric()
    }
}

primitive! {
    Link, link, 3,
    about: "A chain's link: a torus about the y axis with straight sides along z.",
    origin: "centred; axis along y, straight sides along z",
    parameters: {
        ring_radius: Length = "the radius of the circle of each bow",
        radius: Length = "the radius of the tube",
        length: LengthOrZero = "the length of the straight sides"
            => |kernel| 2.0 * kernel.half_length,
    },
    marks: |kernel| {
        let (ring, radius, half) = (kernel.ring_radius(), kernel.radius(), kernel.half_length);
        let side = ring + radius;
        vec![
            Mark::length_between(
                "ring_radius", Vector([0.0, 0.0, half]), Vector([0.6 * ring, 0.0, half + 0.8 * ring]),
            ),
            Mark::length_between("radius", at(-ring, 0.0), at(-ring, radius)),
            Mark::length_between("length", Vector([side, 0.0, -half]), Vector([side, 0.0, half])).right(),
        ]
    },
    example: (0.4, 0.15, 0.8),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, from_segment};
    use crate::vector::Point;

    impl Evidence<3> for Torus {
        const SAMPLE: &'static str = r#"{ "ring_radius": 0.035, "radius": 0.015 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Torus", "`ring_radius`, `radius`", "exact")];

        fn definition(&self) -> Definition<3> {
            let (ring, r) = (self.ring_radius(), self.radius());
            let tube = Patch::arc(
                Vector([ring, 0.0]),
                [Vector([1.0, 0.0]), Vector([0.0, 1.0])],
                r,
                [0.0, TAU],
            );
            Definition::new(vec![tube.turned(ring + r)], move |p| {
                (p[0].hypot(p[2]) - ring).hypot(p[1]) < r
            })
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.1, 0.25)]
        }
    }

    impl Evidence<3> for CappedTorus {
        const SAMPLE: &'static str =
            r#"{ "ring_radius": 0.04, "radius": 0.01, "angle_degrees": 240 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Capped Torus",
            "`ring_radius`, `radius`, `angle`",
            "exact; inside a bound where the tube meets itself",
        )];

        fn definition(&self) -> Definition<3> {
            capped_torus(self.ring_radius(), self.radius(), self.angle())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(1.0, 0.1, -0.5)]
        }
    }

    impl Evidence<3> for Link {
        const SAMPLE: &'static str =
            r#"{ "ring_radius": 0.03, "radius": 0.01, "length": 0.03 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Link", "`ring_radius`, `radius`, `length`", "exact")];

        fn definition(&self) -> Definition<3> {
            link(self.ring_radius(), self.radius(), self.length())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.1, 0.25, 1.0)]
        }
    }

    /// The point of a circle at an angle from +z towards +x, and the direction out of it.
    fn on_circle(angle: f64) -> Point<3> {
        Vector([angle.sin(), 0.0, angle.cos()])
    }

    /// The tube of radius `r` about an arc, from one angle to another.
    fn tube(centre: Point<3>, ring: f64, r: f64, [from, to]: [f64; 2]) -> Patch<3> {
        Patch::surface([(ring + r) * (to - from), TAU * r], move |u, v| {
            let out = on_circle(from + (to - from) * u);
            let (sin, cos) = (TAU * v).sin_cos();
            centre + out * (ring + r * cos) + Vector::unit(1) * (r * sin)
        })
    }

    /// The distance from an arc, by its nearest angle.
    fn from_arc(centre: Point<3>, ring: f64, half: f64, p: Point<3>) -> f64 {
        let q = p - centre;
        let angle = q[0].atan2(q[2]).clamp(-half, half);
        (q - on_circle(angle) * ring).norm()
    }

    fn capped_torus(ring: f64, r: f64, angle: f64) -> Definition<3> {
        let half = 0.5 * angle;
        let mut boundary = vec![tube(Vector::ZERO, ring, r, [-half, half])];
        for side in [1.0, -1.0] {
            let end = on_circle(side * half);
            let onwards = on_circle(side * (half + FRAC_PI_2));
            if angle < TAU {
                boundary.push(Patch::surface([FRAC_PI_2 * r, TAU * r], move |u, v| {
                    let (sin, cos) = (TAU * v).sin_cos();
                    let flat = end * cos + Vector::unit(1) * sin;
                    let (up, across) = (FRAC_PI_2 * u).sin_cos();
                    end * ring + flat * (r * across) + onwards * (r * up)
                }));
            }
        }
        let gap = 2.0 * ring * half.sin();
        let overlaps_itself = r > ring || (half > FRAC_PI_2 && angle < TAU && gap < 2.0 * r);
        let definition =
            Definition::new(boundary, move |p| from_arc(Vector::ZERO, ring, half, p) < r);
        Definition { overlaps_itself, ..definition }
    }

    fn link(ring: f64, r: f64, length: f64) -> Definition<3> {
        let bow = Vector([0.0, 0.0, 0.5 * length]);
        let mut boundary = vec![
            tube(bow, ring, r, [-FRAC_PI_2, FRAC_PI_2]),
            tube(-bow, ring, r, [FRAC_PI_2, 3.0 * FRAC_PI_2]),
        ];
        let side = Vector([ring, 0.0, 0.0]);
        for middle in [side, -side] {
            boundary.push(Patch::surface([length, TAU * r], move |u, v| {
                let (sin, cos) = (TAU * v).sin_cos();
                middle + bow * (2.0 * u - 1.0) + Vector([r * cos, r * sin, 0.0])
            }));
        }
        Definition::new(boundary, move |p| {
            let turned = Vector([p[0], p[1], -p[2]]);
            let sides = [side, -side].map(|s| from_segment(s - bow, s + bow, p));
            let bows = [p, turned].map(|q| from_arc(bow, ring, 0.5 * PI, q));
            sides.into_iter().chain(bows).fold(f64::INFINITY, f64::min) < r
        })
    }
}
