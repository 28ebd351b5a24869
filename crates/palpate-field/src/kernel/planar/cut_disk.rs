// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Discs with a part taken off: by a line, by another disc.

use super::outline::bounds_about;
use crate::bounds::Aabb;
use crate::error::{ShapeError, Unit, finite, positive};
use crate::kernel::mark::sets;
use crate::kernel::profile::{self, CutDiskProfile};
use crate::kernel::{Evaluations, Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance of a cut disc.
const OPERATIONS: f64 = 6.0;

/// The part of a disc about the origin above a line. Exact.
///
/// Folded to `x ≥ 0`, it is the profile that a [`CutBall`](crate::kernel::CutBall)
/// turns.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CutDisk};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cap = Shape::from_kernel(CutDisk::new(5.0, 3.0)?);
/// assert_eq!(cap.distance(Vector([0.0, 7.0])), 2.0); // above
/// assert_eq!(cap.distance(Vector([-2.0, 0.0])), 3.0); // below
/// assert!((cap.distance(Vector([7.0, -1.0])) - 5.0).abs() < 1e-14); // from (4, 3)
/// assert_eq!(cap.distance(Vector([0.0, 3.5])), -0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CutDisk {
    radius: f64,
    cut_height: f64,
    half: CutDiskProfile,
}

impl CutDisk {
    /// A disc of `radius`, without what is below `cut_height` above its centre [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the cut does not meet the disc.
    pub fn new(radius: f64, cut_height: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        finite("cut_height", cut_height, Unit::Metre)?;
        if cut_height.abs() >= radius {
            let rule = format!("less than the radius, {radius} m, above or below the centre");
            return Err(ShapeError::number("cut_height", rule, cut_height, Unit::Metre));
        }
        Ok(Self { radius, cut_height, half: CutDiskProfile::new(radius, cut_height) })
    }
}

impl Kernel<2> for CutDisk {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.half.distance([p.0[0].abs(), p.0[1]])
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<2> {
        let (radius, half_width) = (self.radius, self.half.half_width());
        let below = self.cut_height < 0.0;
        let widest = if below { radius } else { half_width };
        let aabb =
            Aabb { min: Vector([-widest, self.cut_height]), max: Vector([widest, radius]) };
        let aabb = aabb.grown(4.0 * f64::EPSILON * radius);
        let bounds = if below {
            bounds_about(aabb, 0.0, radius)
        } else {
            bounds_about(aabb, self.cut_height, half_width + 4.0 * f64::EPSILON * radius)
        };
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, radius)
        }
    }
}

primitive! {
    CutDisk, cut_disk, 2,
    about: "What is above a line of a disc.",
    origin: "at the centre of its disc; a flat side down",
    parameters: {
        radius: Length = "the radius of the disc",
        cut_height: Coordinate = "how far above the centre the cut is",
    },
    marks: |kernel| sets::cut(kernel.radius(), kernel.cut_height()),
    example: (0.9, -0.3),
}

/// The largest number of rounded operations of the distance of a moon.
const MOON_OPERATIONS: f64 = 6.0;

/// A disc about the origin without a second disc above it on the y axis: a crescent
/// with its horns up. Exact.
///
/// Folded to `x ≥ 0`, it is the profile that a [`DeathStar`](crate::kernel::DeathStar)
/// turns.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Moon};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // The horns' tips are at (±4, 3).
/// let moon = Shape::from_kernel(Moon::new(5.0, 4.0, 3.0)?);
/// assert_eq!(moon.distance(Vector([0.0, -6.0])), 1.0); // below
/// assert_eq!(moon.distance(Vector([0.0, 1.0])), 2.0); // between the horns
/// assert!((moon.distance(Vector([-7.0, 7.0])) - 5.0).abs() < 1e-14); // from a tip
/// assert_eq!(moon.distance(Vector([0.0, -3.0])), -2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Moon {
    radius: f64,
    half: profile::Moon,
}

impl Moon {
    /// A disc of `radius` without one of `cut_radius` whose centre is `distance`
    /// above its own [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the circles do not cross.
    pub fn new(radius: f64, cut_radius: f64, distance: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        positive("cut_radius", cut_radius, Unit::Metre)?;
        positive("distance", distance, Unit::Metre)?;
        let (least, most) = ((radius - cut_radius).abs(), radius + cut_radius);
        if !(least < distance && distance < most) {
            let rule = format!("between {least} m and {most} m, where the circles cross");
            return Err(ShapeError::number("distance", rule, distance, Unit::Metre));
        }
        Ok(Self { radius, half: profile::Moon::new(radius, cut_radius, distance) })
    }
}

impl Kernel<2> for Moon {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.half.distance([p.0[0].abs(), p.0[1]])
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: MOON_OPERATIONS, size: self.half.size() })
    }

    fn promise(&self) -> Promise<2> {
        let [tip_x, tip_y] = self.half.corner();
        let radius = self.radius;
        let widest = if tip_y > 0.0 { radius } else { tip_x };
        let margin = 8.0 * f64::EPSILON * self.half.size();
        let aabb = Aabb { min: Vector([-widest, -radius]), max: Vector([widest, tip_y]) };
        let aabb = aabb.grown(margin);
        let bounds = if tip_y > 0.0 {
            bounds_about(aabb, 0.0, radius)
        } else {
            bounds_about(aabb, tip_y, tip_x + margin)
        };
        Promise {
            symmetric: [true, false],
            ..Promise::exact(Some(bounds), MOON_OPERATIONS, self.half.size())
        }
    }
}

primitive! {
    Moon, moon, 2,
    about: "A disc without a second one above it: a crescent with its horns up.",
    origin: "at the centre of its disc; hollow upwards",
    parameters: {
        radius: Length = "the radius of the disc",
        cut_radius: Length = "the radius of the disc that is taken off"
            => |kernel| kernel.half.cut_radius,
        distance: Length = "how far above the disc's centre the other's is"
            => |kernel| kernel.half.distance,
    },
    marks: |kernel| sets::bite(kernel.radius(), kernel.cut_radius(), kernel.distance()),
    example: (0.9, 0.7, 0.45),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, both_sides, line};

    impl Evidence<2> for CutDisk {
        const SAMPLE: &'static str = r#"{ "radius": 0.05, "cut_height": -0.02 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Cut Disk", "`radius`, `cut_height`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            cut_disk(self.radius(), self.cut_height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, -0.5)]
        }
    }

    impl Evidence<2> for Moon {
        const SAMPLE: &'static str =
            r#"{ "radius": 0.05, "cut_radius": 0.04, "distance": 0.025 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Moon", "`radius`, `cut_radius`, `distance`", "exact")];

        fn definition(&self) -> Definition<2> {
            moon(self.radius(), self.cut_radius(), self.distance())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.25, 0.75), Self::new(0.5, 0.25, 0.125)]
        }
    }

    fn cut_disk(r: f64, height: f64) -> Definition<2> {
        let from = (height / r).asin();
        let corner = [r * from.cos(), height];
        let right = vec![arc([0.0; 2], r, [from, FRAC_PI_2]), line([0.0, height], corner)];
        both_sides(right, move |p| p.norm() < r && p[1] > height)
    }

    fn moon(r: f64, cut: f64, distance: f64) -> Definition<2> {
        let cosine =
            |a: f64, b: f64| (a * a + distance * distance - b * b) / (2.0 * a * distance);
        // At the disc's centre from +y to the tip, at the other's from −y.
        let (at_disc, at_cut) = (cosine(r, cut).acos(), cosine(cut, r).acos());
        let right = vec![
            arc([0.0; 2], r, [-FRAC_PI_2, FRAC_PI_2 - at_disc]),
            arc([0.0, distance], cut, [-FRAC_PI_2, at_cut - FRAC_PI_2]),
        ];
        let centre = Vector([0.0, distance]);
        both_sides(right, move |p| p.norm() < r && (p - centre).norm() > cut)
    }
}
