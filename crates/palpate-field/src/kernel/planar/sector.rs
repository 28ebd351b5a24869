// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sectors of discs and rings about the +y axis.

use super::outline::bounds_about;
use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, sets, turned};
use crate::kernel::profile::Wedge;
use crate::kernel::{Evaluations, Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distances.
const OPERATIONS: f64 = 6.0;

/// The bounds of what a wedge cuts out of a disc or ring.
fn bounds_of(wedge: &Wedge) -> Bounds<2> {
    let [sin, cos] = wedge.end();
    let (inner, outer) = (wedge.inner(), wedge.outer());
    let widest = if cos < 0.0 { outer } else { outer * sin };
    let lowest = if cos < 0.0 { outer * cos } else { inner * cos };
    let margin = 4.0 * f64::EPSILON * outer;
    let aabb = Aabb { min: Vector([-widest, lowest]), max: Vector([widest, outer]) };
    let aabb = aabb.grown(margin);
    if cos <= 0.0 {
        return bounds_about(aabb, 0.0, outer);
    }
    // The ball about the middle of the outer corners or, if the inner corners are farther from
    // there, about the point equally far from all four.
    let height = (outer * cos).min(0.5 * (inner + outer) / cos);
    let radius = (outer * sin).hypot(outer * cos - height);
    bounds_about(aabb, height, radius + margin)
}

/// A sector of a disc about the origin, spread about the +y axis. Exact.
///
/// Folded to `x ≥ 0`, it is the profile that a [`SolidAngle`](crate::kernel::SolidAngle)
/// turns.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Pie};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let quarter = Shape::from_kernel(Pie::new(5.0, std::f64::consts::FRAC_PI_2)?);
/// assert_eq!(quarter.distance(Vector([3.0, 8.0])), 73.0_f64.sqrt() - 5.0); // the arc
/// assert!((quarter.distance(Vector([0.0, -2.0])) - 2.0).abs() < 1e-15); // the tip
/// assert!((quarter.distance(Vector([0.0, 2.0])) + 2.0_f64.sqrt()).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Pie(Wedge);

impl Pie {
    /// A sector of a disc of `radius` [m] that spans `angle` [rad].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the angle not in (0, 2π).
    pub fn new(radius: f64, angle: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        Ok(Self(Wedge::new(angle, 0.0, radius)?))
    }
}

impl Kernel<2> for Pie {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.0.sector([p.0[0].abs(), p.0[1]])
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        if self.0.is_convex() {
            tangent_model(self, cell, OPERATIONS, self.0.outer())
        } else {
            let evaluations = Evaluations { operations: OPERATIONS, size: self.0.outer() };
            evaluations.or_by_steepness(self.distance(cell), &cell)
        }
    }

    fn promise(&self) -> Promise<2> {
        Promise {
            convex: self.0.is_convex(),
            symmetric: [true, false],
            ..Promise::exact(Some(bounds_of(&self.0)), OPERATIONS, self.0.outer())
        }
    }
}

primitive! {
    Pie, pie, 2,
    about: "A sector of a disc, spread about the +y axis.",
    origin: "at the centre of its disc; spread about +y",
    parameters: {
        radius: Length = "the radius of the disc" => |kernel| kernel.0.outer(),
        angle: Angle = "how much of the disc, about the +y axis" => |kernel| kernel.0.angle(),
    },
    marks: |kernel| sets::sector(kernel.radius(), kernel.angle()),
    example: (0.9, 1.9),
}

/// A sector of a ring about the origin with flat ends, spread about the +y axis.
/// Exact.
///
/// # Derivation
///
/// As a [`Pie`], with the ring `|‖p‖ − m| − w` in place of the disc, and with edges
/// that begin at the inner radius.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RingSector};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let arch = Shape::from_kernel(RingSector::new(2.0, 4.0, std::f64::consts::PI)?);
/// assert_eq!(arch.distance(Vector([3.0, 4.0])), 1.0); // above
/// assert_eq!(arch.distance(Vector([0.0, 1.0])), 1.0); // below
/// assert!((arch.distance(Vector([-3.0, -2.0])) - 2.0).abs() < 1e-15); // from an end
/// assert!((arch.distance(Vector([0.0, 3.0])) + 1.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RingSector {
    wedge: Wedge,
    mean_radius: f64,
    half_width: f64,
}

impl RingSector {
    /// A sector of the ring between circles of `inner_radius` and `outer_radius`
    /// [m] that spans `angle` [rad].
    ///
    /// # Errors
    ///
    /// If the inner radius is not positive or the outer not larger, or the angle not
    /// in (0, 2π).
    pub fn new(inner_radius: f64, outer_radius: f64, angle: f64) -> Result<Self, ShapeError> {
        positive("inner_radius", inner_radius, Unit::Metre)?;
        positive("outer_radius", outer_radius, Unit::Metre)?;
        if outer_radius <= inner_radius {
            let rule = format!("more than the inner radius, {inner_radius} m");
            return Err(ShapeError::number("outer_radius", rule, outer_radius, Unit::Metre));
        }
        Ok(Self {
            wedge: Wedge::new(angle, inner_radius, outer_radius)?,
            mean_radius: 0.5 * (inner_radius + outer_radius),
            half_width: 0.5 * (outer_radius - inner_radius),
        })
    }
}

impl Kernel<2> for RingSector {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        // y first: from the centre, the +y axis leads to the ring.
        let ring = (S::norm([p.0[1], p.0[0]]) - S::constant(self.mean_radius)).abs();
        self.wedge.cut([p.0[0].abs(), p.0[1]], ring - S::constant(self.half_width))
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.wedge.outer() })
    }

    fn promise(&self) -> Promise<2> {
        Promise {
            symmetric: [true, false],
            ..Promise::exact(Some(bounds_of(&self.wedge)), OPERATIONS, self.wedge.outer())
        }
    }
}

primitive! {
    RingSector, ring_sector, 2,
    about: "A sector of a ring with flat ends, spread about the +y axis.",
    origin: "at the centre of its ring; open downwards",
    parameters: {
        inner_radius: Length = "the radius of the hole" => |kernel| kernel.wedge.inner(),
        outer_radius: Length = "the radius of the outer circle"
            => |kernel| kernel.wedge.outer(),
        angle: Angle = "how much of the ring, about the +y axis"
            => |kernel| kernel.wedge.angle(),
    },
    marks: |kernel| {
        let (inner, outer) = (kernel.inner_radius(), kernel.outer_radius());
        let place = |share: f64, radius: f64| turned(share * kernel.angle(), radius);
        vec![
            Mark::from_origin("inner_radius", place(-0.2, inner)),
            Mark::from_origin("outer_radius", place(0.2, outer)),
            Mark::angle("angle", |share| place(share, 0.75 * inner)),
        ]
    },
    example: (0.5, 0.9, 4.2),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, both_sides, line};

    impl Evidence<2> for Pie {
        const SAMPLE: &'static str = r#"{ "radius": 0.05, "angle_degrees": 100 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Pie", "`radius`, `angle`", "exact")];

        fn definition(&self) -> Definition<2> {
            sector(0.0, self.radius(), self.angle())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 7.0)]
        }
    }

    impl Evidence<2> for RingSector {
        const SAMPLE: &'static str =
            r#"{ "inner_radius": 0.03, "outer_radius": 0.05, "angle_degrees": 250 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Ring",
            "`inner_radius`, `outer_radius`, `angle`; `ring` for a full turn",
            "exact",
        )];

        fn definition(&self) -> Definition<2> {
            sector(self.inner_radius(), self.outer_radius(), self.angle())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.25, 1.0)]
        }
    }

    /// The part of a ring within half the angle from +y.
    fn sector(inner: f64, outer: f64, angle: f64) -> Definition<2> {
        let half = 0.5 * angle;
        let angles = [FRAC_PI_2 - half, FRAC_PI_2];
        let at = |r: f64| [r * half.sin(), r * half.cos()];
        let right = vec![
            arc([0.0; 2], inner, angles),
            arc([0.0; 2], outer, angles),
            line(at(inner), at(outer)),
        ];
        both_sides(right, move |p| {
            let r = p.norm();
            inner < r && r < outer && p[0].abs().atan2(p[1]) < half
        })
    }
}
