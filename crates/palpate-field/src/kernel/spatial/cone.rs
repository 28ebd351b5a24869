// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cones about the y axis: whole, capped and without a base.

use super::cylinder::{from_axis, in_profile, turned_bounds};
use std::f64::consts::PI;

use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, at, sets, turned};
use crate::kernel::profile::{beside, intersection};
use crate::kernel::{Kernel, answered_by_inner, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 10.0;

/// The same for a cone without a base.
const INFINITE_OPERATIONS: f64 = 6.0;

/// A cone about the y axis with its tip cut off. Exact.
///
/// # Derivation
///
/// The profile in `(ρ, y)`, with `ρ` the distance from the axis, is a convex
/// quadrilateral: inside, the nearest of the caps' planes and the side's line
/// decides. Outside, the nearest point is on the side where `p` projects into
/// it, on a cap where `p` is above or below it, else on a rim.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CappedCone};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let bucket = Shape::from_kernel(CappedCone::new(4.0, 1.0, 4.0)?);
/// assert_eq!(bucket.distance(Vector([0.0, 3.0, 0.0])), 1.0); // above
/// assert_eq!(bucket.distance(Vector([7.0, -6.0, 0.0])), 5.0); // from the rim
/// assert!((bucket.distance(Vector([0.0, 0.0, 0.0])) + 2.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CappedCone {
    bottom_radius: f64,
    top_radius: f64,
    half_height: f64,
    /// From the bottom rim along the side to the top rim, of length one.
    slope: [f64; 2],
    side: f64,
}

impl CappedCone {
    /// A capped cone with the given radii at the bottom and top and full
    /// `height` [m].
    ///
    /// # Errors
    ///
    /// If the height is not positive, a radius is negative, or both are zero.
    pub fn new(bottom_radius: f64, top_radius: f64, height: f64) -> Result<Self, ShapeError> {
        not_negative("bottom_radius", bottom_radius, Unit::Metre)?;
        not_negative("top_radius", top_radius, Unit::Metre)?;
        let height = positive("height", height, Unit::Metre)?;
        positive("bottom_radius or top_radius", bottom_radius.max(top_radius), Unit::Metre)?;
        let side = (top_radius - bottom_radius).hypot(height);
        let slope = [(top_radius - bottom_radius) / side, height / side];
        Ok(Self { bottom_radius, top_radius, half_height: 0.5 * height, slope, side })
    }

    /// The sum of the radii and the side [m].
    #[inline(always)]
    fn size(&self) -> f64 {
        self.side + self.bottom_radius + self.top_radius
    }
}

impl Kernel<3> for CappedCone {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let zero = S::constant(0.0);
        let (rho, y) = (from_axis(p), p.0[1]);
        let [along_rho, along_y] = self.slope;
        // From the bottom rim: along the side and out of it.
        let from_rim =
            [rho - S::constant(self.bottom_radius), y + S::constant(self.half_height)];
        let along = from_rim[0].scale(along_rho) + from_rim[1].scale(along_y);
        let out = from_rim[0].scale(along_y) - from_rim[1].scale(along_rho);
        let cap = y.abs() - S::constant(self.half_height);
        let inside = out.max(cap);

        let from_top = [rho - S::constant(self.top_radius), y - S::constant(self.half_height)];
        let rims = S::norm(from_rim).min(S::norm(from_top));
        let radius = S::select_less(
            y,
            zero,
            S::constant(self.bottom_radius),
            S::constant(self.top_radius),
        );
        let past_side = (along - S::constant(self.side)).max(-along);
        let pieces = beside(out, past_side, beside(cap, rho - radius, rims));
        intersection(inside, pieces, self.size())
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.size())
    }

    fn promise(&self) -> Promise<3> {
        let widest = self.bottom_radius.max(self.top_radius);
        let bounds = turned_bounds(widest, self.half_height);
        Promise {
            symmetric: [true, self.bottom_radius == self.top_radius, true],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, self.size())
        }
    }
}

primitive! {
    CappedCone, capped_cone, 3,
    about: "A cone about the y axis with its tip cut off.",
    origin: "centred, at half its height; axis along y, `bottom_radius` below",
    parameters: {
        bottom_radius: LengthOrZero = "the radius at the bottom",
        top_radius: LengthOrZero = "the radius at the top",
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| {
        let (bottom, top) = (kernel.bottom_radius, kernel.top_radius);
        let height = kernel.height();
        let y = 0.5 * height;
        vec![
            Mark::length_between("bottom_radius", at(0.0, -y), at(bottom, -y)).below(),
            Mark::length_between("top_radius", at(0.0, y), at(top, y)).above(),
            Mark::height(height, bottom, top),
        ]
    },
    example: (0.6, 0.25, 0.9),
}

/// A cone about the y axis, its tip up, centred at half its height. Exact.
///
/// A [`CappedCone`] whose top has no radius.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cone};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cone = Shape::from_kernel(Cone::new(3.0, 4.0)?);
/// assert_eq!(cone.distance(Vector([0.0, 5.0, 0.0])), 3.0); // above the tip
/// assert_eq!(cone.distance(Vector([0.0, -3.0, 0.0])), 1.0); // below the base
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Cone(CappedCone);

impl Cone {
    /// A cone with the given `radius` at the base and full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(radius: f64, height: f64) -> Result<Self, ShapeError> {
        let radius = positive("radius", radius, Unit::Metre)?;
        Ok(Self(CappedCone::new(radius, 0.0, height)?))
    }
}

answered_by_inner!(Cone.0, CappedCone, 3);

primitive! {
    Cone, cone, 3,
    about: "A cone about the y axis, its tip up.",
    origin: "centred, at half its height; axis along y, a tip up, a flat side down",
    parameters: {
        radius: Length = "the radius of the base" => |kernel| kernel.0.bottom_radius,
        height: Length = "the full height" => |kernel| 2.0 * kernel.0.half_height,
    },
    marks: |kernel| sets::cone(kernel.radius(), kernel.height()),
    example: (0.6, 1.0),
}

/// A cone about the y axis without a base, its tip at the origin, opening downwards.
/// Exact, without bounds.
///
/// # Derivation
///
/// In the profile the surface is a half line from the origin. Where `p` is beside it,
/// the distance is the offset from its line, which is nearer than the half line across
/// the axis; above, the tip is nearest.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::InfiniteCone};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let right_angle = std::f64::consts::FRAC_PI_2;
/// let funnel = Shape::from_kernel(InfiniteCone::new(right_angle)?);
/// assert_eq!(funnel.distance(Vector([0.0, 2.0, 0.0])), 2.0); // above the tip
/// let depth = 8.0_f64.sqrt();
/// assert!((funnel.distance(Vector([0.0, -4.0, 0.0])) + depth).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct InfiniteCone {
    angle: f64,
    /// Sine and cosine of half the opening angle.
    half_angle: [f64; 2],
}

impl InfiniteCone {
    /// A cone that opens by `angle` [rad] from side to side.
    ///
    /// # Errors
    ///
    /// If the angle is not between 0 and π.
    pub fn new(angle: f64) -> Result<Self, ShapeError> {
        if !(angle > 0.0 && angle < std::f64::consts::PI) {
            let rule = "in (0, π), less than half a turn";
            return Err(ShapeError::number("angle", rule, angle, Unit::Radian));
        }
        let half_angle = 0.5 * angle;
        Ok(Self { angle, half_angle: [libm::sin(half_angle), libm::cos(half_angle)] })
    }
}

impl Kernel<3> for InfiniteCone {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [sin, cos] = self.half_angle;
        let profile = in_profile(p);
        let out = S::weighted_sum(profile, &[cos, sin]);
        let along = S::weighted_sum(profile, &[sin, -cos]);
        S::select_less(along, S::constant(0.0), p.norm(), out)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, INFINITE_OPERATIONS, 0.0)
    }

    fn promise(&self) -> Promise<3> {
        Promise {
            symmetric: [true, false, true],
            ..Promise::exact_convex(None, INFINITE_OPERATIONS, 0.0)
        }
    }
}

primitive! {
    InfiniteCone, infinite_cone, 3,
    about: "A cone without a base, its tip at the origin, opening downwards.",
    origin: "endless; at its tip, opening downwards",
    parameters: { angle: Angle = "the opening from side to side, less than half a turn" },
    marks: |kernel| vec![Mark::angle("angle", |share| turned(PI + share * kernel.angle(), 0.5))],
    example: (0.9),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, FAR, Row, capped_cone, line};
    use crate::vector::Point;

    impl Evidence<3> for CappedCone {
        const SAMPLE: &'static str =
            r#"{ "bottom_radius": 0.05, "top_radius": 0.02, "height": 0.08 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Capped Cone, vertical",
            "`bottom_radius`, `top_radius`, `height`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            capped_cone(self.bottom_radius(), self.top_radius(), self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.0, 0.0, 1.0)]
        }
    }

    impl Evidence<3> for Cone {
        const SAMPLE: &'static str = r#"{ "radius": 0.04, "height": 0.1 }"#;
        const GUIDE: &'static [Row] = &[
            Row::new("Cone", "`radius`, `height`; centred at half its height", "exact, convex"),
            Row::new("Cone, cheap", "the same: there is no cheap one", "exact, convex"),
        ];

        fn definition(&self) -> Definition<3> {
            capped_cone(self.radius(), 0.0, self.height())
        }
    }

    impl Evidence<3> for InfiniteCone {
        const SAMPLE: &'static str = r#"{ "angle_degrees": 60 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Infinite Cone", "`angle`", "exact, convex, unbounded")];

        fn definition(&self) -> Definition<3> {
            infinite_cone(self.angle())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(std::f64::consts::PI)]
        }
    }

    /// Pieces of the surface of a cone without a base, each half as long towards the tip.
    const PIECES: i32 = 12;

    /// In pieces, each reaching twice as far out as the one before, so that samples near the tip
    /// are dense.
    fn infinite_cone(angle: f64) -> Definition<3> {
        let half = 0.5 * angle;
        let at = |along: f64| [along * half.sin(), -along * half.cos()];
        let piece = |k: i32| {
            let far = FAR * 0.5_f64.powi(k);
            let near = if k < PIECES { 0.5 * far } else { 0.0 };
            line(at(near), at(far)).turned(far * half.sin())
        };
        let boundary = (0..=PIECES).map(piece).collect();
        Definition::new(boundary, move |p: Point<3>| p[0].hypot(p[2]).atan2(-p[1]) < half)
    }
}
