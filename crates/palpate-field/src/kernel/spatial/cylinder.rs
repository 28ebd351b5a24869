// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cylinders about the y axis: sharp, rounded and without ends.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, at, sets};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The distance from the y axis.
#[inline(always)]
pub(super) fn from_axis<S: Scalar>(p: Vector<S, 3>) -> S {
    S::norm([p.0[0], p.0[2]])
}

/// The place of `p` in the profile of a solid of revolution about y: the distance from the
/// axis, and the height.
#[inline(always)]
pub(super) fn in_profile<S: Scalar>(p: Vector<S, 3>) -> [S; 2] {
    [from_axis(p), p.0[1]]
}

/// The bounds of a solid of revolution about y whose profile fits into a box of `half_width`
/// and `half_height`.
pub(super) fn turned_bounds(half_width: f64, half_height: f64) -> Bounds<3> {
    let radius = Vector([half_width, half_height]).norm() * (1.0 + 4.0 * f64::EPSILON);
    Bounds::centred(Vector([half_width, half_height, half_width]), radius)
}

/// A cylinder of a radius and full height about the y axis. Exact.
///
/// The orthant of `√(x² + z²) − r` and `|y| − h/2`: a rectangle, turned.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cylinder};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let can = Shape::from_kernel(Cylinder::new(2.0, 6.0)?);
/// assert_eq!(can.distance(Vector([3.0, 0.0, 4.0])), 3.0);
/// assert_eq!(can.distance(Vector([5.0, 7.0, 0.0])), 5.0); // past the rim
/// assert_eq!(can.distance(Vector([0.0, 2.5, 0.0])), -0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Cylinder {
    radius: f64,
    half_height: f64,
}

impl Cylinder {
    /// A cylinder of `radius` and full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(radius: f64, height: f64) -> Result<Self, ShapeError> {
        Ok(Self {
            radius: positive("radius", radius, Unit::Metre)?,
            half_height: 0.5 * positive("height", height, Unit::Metre)?,
        })
    }
}

impl Kernel<3> for Cylinder {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        S::orthant([
            from_axis(p) - S::constant(self.radius),
            p.0[1].abs() - S::constant(self.half_height),
        ])
    }

    fn promise(&self) -> Promise<3> {
        let bounds = turned_bounds(self.radius, self.half_height);
        Promise::exact_convex(Some(bounds), 8.0, bounds.ball.radius).symmetric()
    }
}

primitive! {
    Cylinder, cylinder, 3,
    about: "A cylinder about the y axis.",
    origin: "centred; axis along y",
    parameters: {
        radius: Length = "the radius",
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| sets::cylinder(kernel.radius(), kernel.height()),
    example: (0.4, 1.0),
}

/// A cylinder about the y axis with its rims rounded inwards. Exact.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundedCylinder};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let pill = Shape::from_kernel(RoundedCylinder::new(2.0, 6.0, 0.5)?);
/// assert_eq!(pill.distance(Vector([3.0, 0.0, 4.0])), 3.0); // the side stays
/// assert_eq!(pill.distance(Vector([4.5, 6.5, 0.0])), 4.5); // √(3² + 4²) − 0.5
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundedCylinder {
    radius: f64,
    height: f64,
    core: Cylinder,
    rounding: f64,
}

impl RoundedCylinder {
    /// A cylinder of `radius` and full `height`, its rims rounded with radius
    /// `rounding` [m].
    ///
    /// # Errors
    ///
    /// If the radius or height is not positive, or the rounding is negative or
    /// more than the radius or half the height.
    pub fn new(radius: f64, height: f64, rounding: f64) -> Result<Self, ShapeError> {
        let sharp = Cylinder::new(radius, height)?;
        not_negative("rounding", rounding, Unit::Metre)?;
        let most = sharp.radius.min(sharp.half_height);
        if rounding > most {
            let rule = format!("at most the radius and half the height, {most} m");
            return Err(ShapeError::number("rounding", rule, rounding, Unit::Metre));
        }
        let core = Cylinder {
            radius: sharp.radius - rounding,
            half_height: sharp.half_height - rounding,
        };
        Ok(Self { radius, height, core, rounding })
    }
}

impl Kernel<3> for RoundedCylinder {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.core.distance(p) - S::constant(self.rounding)
    }

    fn promise(&self) -> Promise<3> {
        let core = &self.core;
        let bounds =
            turned_bounds(core.radius + self.rounding, core.half_height + self.rounding);
        Promise::exact_convex(Some(bounds), 9.0, bounds.ball.radius).symmetric()
    }
}

primitive! {
    RoundedCylinder, rounded_cylinder, 3,
    about: "A cylinder about the y axis, its rims rounded inwards.",
    origin: "centred; axis along y",
    parameters: {
        radius: Length = "the radius",
        height: Length = "the full height",
        rounding: LengthOrZero = "the radius of the rims",
    },
    marks: |kernel| {
        let [radius, height, rounding] = [kernel.radius(), kernel.height(), kernel.rounding()];
        let flat = radius - rounding;
        vec![
            Mark::from_origin("radius", at(radius, 0.0)),
            Mark::height(height, flat, flat),
            Mark::rounding(Vector([2.0 * radius, height, 0.0]), rounding),
        ]
    },
    example: (0.4, 1.0, 0.1),
}

/// A cylinder without ends about the y axis. Exact, without bounds.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::InfiniteCylinder};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let pole = Shape::from_kernel(InfiniteCylinder::new(0.5)?);
/// assert_eq!(pole.distance(Vector([3.0, 1e6, 4.0])), 4.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct InfiniteCylinder {
    radius: f64,
}

impl InfiniteCylinder {
    /// A cylinder of `radius` [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn new(radius: f64) -> Result<Self, ShapeError> {
        Ok(Self { radius: positive("radius", radius, Unit::Metre)? })
    }
}

impl Kernel<3> for InfiniteCylinder {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        from_axis(p) - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<3> {
        Promise::exact_convex(None, 4.0, self.radius).symmetric()
    }
}

primitive! {
    InfiniteCylinder, infinite_cylinder, 3,
    about: "A cylinder without ends about the y axis.",
    origin: "endless along y; about the y axis",
    parameters: { radius: Length = "the radius" },
    marks: |kernel| vec![Mark::from_origin("radius", at(kernel.radius(), 0.0))],
    example: (0.3),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{
        Definition, Evidence, FAR, Patch, Row, cylinder, in_rounded_box, rounded_rectangle,
    };

    impl Evidence<3> for Cylinder {
        const SAMPLE: &'static str = r#"{ "radius": 0.035, "height": 0.1 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Capped Cylinder, vertical", "`radius`, `height`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            cylinder(self.radius(), 0.5 * self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.1, -1e300)]
        }
    }

    impl Evidence<3> for RoundedCylinder {
        const SAMPLE: &'static str = r#"{ "radius": 0.035, "height": 0.1, "rounding": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Rounded Cylinder",
            "`radius` with the rounding, `height`, `rounding`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            rounded_cylinder(self.radius(), 0.5 * self.height(), self.rounding())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.1, 1.0, 0.2)]
        }
    }

    impl Evidence<3> for InfiniteCylinder {
        const SAMPLE: &'static str = r#"{ "radius": 0.03 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Infinite Cylinder",
            "`radius`; about the y axis, then `placed`",
            "exact, convex, unbounded",
        )];

        fn definition(&self) -> Definition<3> {
            let r = self.radius();
            let wall = Patch::segment(Vector([r, -FAR]), Vector([r, FAR])).turned(r);
            Definition::new(vec![wall], move |p| p[0].hypot(p[2]) < r)
        }
    }

    fn rounded_cylinder(r: f64, half: f64, rounding: f64) -> Definition<3> {
        let profile = rounded_rectangle(Vector([r, half]), rounding, 2.0);
        // Turning the whole cross-section covers the surface twice.
        let boundary = profile.into_iter().map(|piece| piece.turned(r)).collect();
        Definition::new(boundary, move |p| {
            let q = Vector([p[0].hypot(p[2]), p[1]]);
            in_rounded_box(Vector([r, half]), rounding, 2.0, q)
        })
    }
}
