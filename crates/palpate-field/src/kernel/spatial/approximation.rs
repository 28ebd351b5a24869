// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The haptics article's approximate forms: the largest signed distance to a face.
//!
//! They are exact inside. Outside they are lower bounds: past edges and corners they are less
//! than the distance, so their isolines keep sharp corners. The article's cone and pyramid have
//! Lipschitz constants above one and are no bounds; here the lateral term is divided by its
//! slope.

use super::cylinder::{from_axis, turned_bounds};
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, sets};
use crate::kernel::{Kernel, primitive};
use crate::promise::{Promise, Quality};
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The promise: a bound outside, exact inside, and at most the distance to the box.
fn face_distance(bounds: Bounds<3>, symmetric_in_y: bool) -> Promise<3> {
    Promise {
        outside: Quality::Bound,
        above_bounds: false,
        symmetric: [true, symmetric_in_y, true],
        ..Promise::exact_convex(Some(bounds), 8.0, bounds.ball.radius)
    }
}

/// A cube by the distance to its nearest face's plane: `max |pᵢ| − s/2`.
///
/// Exact inside, a bound outside.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CubeApproximation};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cube = Shape::from_kernel(CubeApproximation::new(2.0)?);
/// assert_eq!(cube.distance(Vector([4.0, 5.0, 0.0])), 4.0); // truly 5
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CubeApproximation {
    half_side: f64,
}

impl CubeApproximation {
    /// A cube with edges of length `side` [m].
    ///
    /// # Errors
    ///
    /// If the side is not positive.
    pub fn new(side: f64) -> Result<Self, ShapeError> {
        Ok(Self { half_side: 0.5 * positive("side", side, Unit::Metre)? })
    }
}

impl Kernel<3> for CubeApproximation {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.abs().0;
        x.max(y).max(z) - S::constant(self.half_side)
    }

    fn promise(&self) -> Promise<3> {
        let half = Vector::constant(self.half_side);
        let radius = half.norm() * (1.0 + 4.0 * f64::EPSILON);
        face_distance(Bounds::centred(half, radius), true)
    }
}

primitive! {
    CubeApproximation, cube_approximation, 3,
    about: "The article's approximate cube: a bound with sharp isolines.",
    origin: "centred; edges along the axes",
    parameters: {
        side: Length = "the edge length" => |kernel| 2.0 * kernel.half_side,
    },
    marks: |kernel| {
        let half = 0.5 * kernel.side();
        vec![Mark::width("side", half, -half)]
    },
    example: (0.9),
}

/// A cylinder by the distance to its nearest face: `max(√(x² + z²) − r,
/// |y| − h/2)`.
///
/// Exact inside, a bound outside.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CylinderApproximation};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let can = Shape::from_kernel(CylinderApproximation::new(2.0, 6.0)?);
/// assert_eq!(can.distance(Vector([5.0, 7.0, 0.0])), 4.0); // truly 5
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CylinderApproximation {
    radius: f64,
    half_height: f64,
}

impl CylinderApproximation {
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

impl Kernel<3> for CylinderApproximation {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let side = from_axis(p) - S::constant(self.radius);
        side.max(p.0[1].abs() - S::constant(self.half_height))
    }

    fn promise(&self) -> Promise<3> {
        face_distance(turned_bounds(self.radius, self.half_height), true)
    }
}

primitive! {
    CylinderApproximation, cylinder_approximation, 3,
    about: "The article's approximate cylinder: a bound with sharp isolines.",
    origin: "centred; axis along y",
    parameters: {
        radius: Length = "the radius",
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| sets::cylinder(kernel.radius(), kernel.height()),
    example: (0.4, 1.0),
}

/// The offset out of a side that leans from half width `w` at the bottom to the axis at the
/// top: `(across − w(½ − y/h)) · h/√(h² + w²)`.
#[derive(Clone, Debug)]
struct LeaningSide {
    half_width: f64,
    height: f64,
    across: f64,
    up: f64,
}

impl LeaningSide {
    fn new(half_width: f64, height: f64) -> Self {
        let slant = half_width.hypot(height);
        Self { half_width, height, across: height / slant, up: half_width / slant }
    }

    /// The larger of the side's distance and that of the planes of base and tip.
    #[inline(always)]
    fn distance<S: Scalar>(&self, across: S, y: S) -> S {
        let side =
            (across - S::constant(0.5 * self.half_width)).scale(self.across) + y.scale(self.up);
        side.max(y.abs() - S::constant(0.5 * self.height))
    }
}

/// A cone, its tip up, by the distance to its nearest face.
///
/// `max((√(x² + z²) − r(½ − y/h)) · h/√(h² + r²), |y| − h/2)`: exact inside, a
/// bound outside.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::ConeApproximation};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cone = Shape::from_kernel(ConeApproximation::new(3.0, 4.0)?);
/// assert_eq!(cone.distance(Vector([0.0, -4.0, 0.0])), 2.0);
/// assert!((cone.distance(Vector([4.0, 0.0, 0.0])) - 2.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ConeApproximation(LeaningSide);

impl ConeApproximation {
    /// A cone with the given `radius` at the base and full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(radius: f64, height: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        positive("height", height, Unit::Metre)?;
        Ok(Self(LeaningSide::new(radius, height)))
    }
}

impl Kernel<3> for ConeApproximation {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.0.distance(from_axis(p), p.0[1])
    }

    fn promise(&self) -> Promise<3> {
        face_distance(turned_bounds(self.0.half_width, 0.5 * self.0.height), false)
    }
}

primitive! {
    ConeApproximation, cone_approximation, 3,
    about: "The article's approximate cone, corrected to be a bound.",
    origin: "centred, at half its height; axis along y, a tip up, a flat side down",
    parameters: {
        radius: Length = "the radius of the base" => |kernel| kernel.0.half_width,
        height: Length = "the full height" => |kernel| kernel.0.height,
    },
    marks: |kernel| sets::cone(kernel.radius(), kernel.height()),
    example: (0.6, 1.0),
}

/// A pyramid on a square, its tip up, by the distance to its nearest face.
///
/// `max((max(|x|, |z|) − s/2·(½ − y/h)) · h/√(h² + (s/2)²), |y| − h/2)`: exact
/// inside, a bound outside.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::PyramidApproximation};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let giza = Shape::from_kernel(PyramidApproximation::new(6.0, 4.0)?);
/// assert!((giza.distance(Vector([1.0, 0.0, -4.0])) - 2.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PyramidApproximation(LeaningSide);

impl PyramidApproximation {
    /// A pyramid on a square of the given `side`, of full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(side: f64, height: f64) -> Result<Self, ShapeError> {
        positive("side", side, Unit::Metre)?;
        positive("height", height, Unit::Metre)?;
        Ok(Self(LeaningSide::new(0.5 * side, height)))
    }
}

impl Kernel<3> for PyramidApproximation {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.0.distance(p.0[0].abs().max(p.0[2].abs()), p.0[1])
    }

    fn promise(&self) -> Promise<3> {
        let side = &self.0;
        let half = Vector([side.half_width, 0.5 * side.height, side.half_width]);
        let radius = half.norm() * (1.0 + 4.0 * f64::EPSILON);
        face_distance(Bounds::centred(half, radius), false)
    }
}

primitive! {
    PyramidApproximation, pyramid_approximation, 3,
    about: "The article's approximate pyramid, corrected to be a bound.",
    origin: "centred, at half its height; a tip up, a base with edges along x and z",
    parameters: {
        side: Length = "the edge of the base" => |kernel| 2.0 * kernel.0.half_width,
        height: Length = "the full height" => |kernel| kernel.0.height,
    },
    marks: |kernel| sets::arch("side", kernel.side(), kernel.height()),
    example: (1.0, 0.9),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{
        Definition, Evidence, bound, capped_cone, cylinder, pyramid, rounded_box,
    };

    impl Evidence<3> for CubeApproximation {
        const SAMPLE: &'static str = r#"{ "side": 0.08 }"#;

        fn definition(&self) -> Definition<3> {
            bound(rounded_box(Vector([0.5 * self.side(); 3]), 0.0, 2.0))
        }
    }

    impl Evidence<3> for CylinderApproximation {
        const SAMPLE: &'static str = r#"{ "radius": 0.035, "height": 0.1 }"#;

        fn definition(&self) -> Definition<3> {
            bound(cylinder(self.radius(), 0.5 * self.height()))
        }
    }

    impl Evidence<3> for ConeApproximation {
        const SAMPLE: &'static str = r#"{ "radius": 0.04, "height": 0.1 }"#;

        fn definition(&self) -> Definition<3> {
            bound(capped_cone(self.radius(), 0.0, self.height()))
        }
    }

    impl Evidence<3> for PyramidApproximation {
        const SAMPLE: &'static str = r#"{ "side": 0.08, "height": 0.1 }"#;

        fn definition(&self) -> Definition<3> {
            bound(pyramid(self.side(), self.height()))
        }
    }
}
