// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The egg of four arcs.

use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 4.0;

/// The slope of the line on which the side arc and the top arc have their centres:
/// the tangent of 60°.
const SLOPE: f64 = 1.732_050_807_568_877_2;

/// An egg about the y axis, its widest place at y = 0. Exact.
///
/// Four arcs that continue each other: half a circle of radius R below, a part of a
/// circle of radius r on top, and two sides.
///
/// # Derivation
///
/// With `c = R − r`, the triangle of the points (±c, 0) and (0, √3c) has equal edges
/// 2c long. The right side is the arc about the left corner with radius `2c + r`: at
/// y = 0 it meets the bottom circle, `c + R = 2c + r`, and beyond the top corner the
/// top circle, each with a common normal. Folded to x ≥ 0, the normals of one arc
/// fill one region: below y = 0, above the line through the left and the top corner,
/// and what is between. In each, the distance is that to the arc's circle.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Egg};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let egg = Shape::from_kernel(Egg::new(5.0, 2.0)?);
/// assert_eq!(egg.distance(Vector([3.0, -4.0])), 0.0); // on the bottom circle
/// // From the centre of the right side, at (−3, 0), with radius 8.
/// assert_eq!(egg.distance(Vector([9.0, 5.0])), 5.0);
/// let tip = 3.0 * 3.0_f64.sqrt() + 2.0;
/// assert!((egg.distance(Vector([0.0, 12.0])) - (12.0 - tip)).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Egg {
    bottom_radius: f64,
    top_radius: f64,
    /// From the middle to the centre of either side.
    side: f64,
    /// How high the centre of the top circle is.
    top: f64,
}

impl Egg {
    /// An egg whose bottom and top are arcs of the given radii [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, or that of the top the larger.
    pub fn new(bottom_radius: f64, top_radius: f64) -> Result<Self, ShapeError> {
        positive("bottom_radius", bottom_radius, Unit::Metre)?;
        positive("top_radius", top_radius, Unit::Metre)?;
        if top_radius > bottom_radius {
            let rule = format!("at most the radius of the bottom, {bottom_radius} m");
            return Err(ShapeError::number("top_radius", rule, top_radius, Unit::Metre));
        }
        let side = bottom_radius - top_radius;
        Ok(Self { bottom_radius, top_radius, side, top: SLOPE * side })
    }
}

impl Kernel<2> for Egg {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let (x, y) = (p.0[0].abs(), p.0[1]);
        let from_side = x + S::constant(self.side);
        let bottom = S::norm([x, y]) - S::constant(self.bottom_radius);
        let side = S::norm([from_side, y]) - S::constant(self.side + self.bottom_radius);
        let top = S::norm([x, y - S::constant(self.top)]) - S::constant(self.top_radius);
        let above = S::select_less(from_side.scale(SLOPE), y, top, side);
        S::select_less(y, S::constant(0.0), bottom, above)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, 2.0 * self.bottom_radius)
    }

    fn promise(&self) -> Promise<2> {
        let (low, high) = (-self.bottom_radius, self.top + self.top_radius);
        let aabb = Aabb { min: Vector([low, low]), max: Vector([self.bottom_radius, high]) };
        // The ball touches the bottom and the top circle and holds both, and with them the ends
        // of the sides.
        let ball = BoundingBall {
            centre: Vector([0.0, 0.5 * (low + high)]),
            radius: 0.5 * (high - low),
        };
        let room = 4.0 * f64::EPSILON * self.bottom_radius;
        let bounds = Bounds { aabb, ball }.grown(room);
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, 2.0 * self.bottom_radius)
        }
    }
}

primitive! {
    Egg, egg, 2,
    about: "An egg of four arcs, its thin end up.",
    origin: "at the centre of its bottom circle; the thin end up",
    parameters: {
        bottom_radius: Length = "the radius of the bottom, half the width",
        top_radius: Length = "the radius of the top, at most that of the bottom",
    },
    marks: |kernel| {
        let (bottom, top) = (kernel.bottom_radius, kernel.top_radius);
        vec![
            Mark::from_origin("bottom_radius", at(-0.8 * bottom, -0.6 * bottom)),
            Mark::length_between("top_radius", at(0.0, kernel.top), at(0.0, kernel.top + top)),
        ]
    },
    example: (0.7, 0.25),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::PI;

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc};
    use crate::vector::Point;

    impl Evidence<2> for Egg {
        const SAMPLE: &'static str = r#"{ "bottom_radius": 0.04, "top_radius": 0.015 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Simple Egg", "`bottom_radius`, `top_radius`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            egg(self.bottom_radius(), self.top_radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.25, 0.5)]
        }
    }

    /// Half a circle below, a smaller arc on top, and two arcs that join them. The corners of an
    /// equilateral triangle are the centres of the top and of the joining arcs.
    fn egg(bottom: f64, top: f64) -> Definition<2> {
        let c = bottom - top;
        let high = c * 3.0_f64.sqrt();
        let side = 2.0 * c + top;
        let boundary = vec![
            arc([0.0; 2], bottom, [PI, 2.0 * PI]),
            arc([-c, 0.0], side, [0.0, PI / 3.0]),
            arc([c, 0.0], side, [2.0 * PI / 3.0, PI]),
            arc([0.0, high], top, [PI / 3.0, 2.0 * PI / 3.0]),
        ];
        let junction = high + top * (PI / 3.0).sin();
        let in_disc = |p: Point<2>, x: f64, y: f64, r: f64| (p - Vector([x, y])).norm() < r;
        Definition::new(boundary, move |p| {
            let between = p[1] >= 0.0
                && p[1] <= junction
                && in_disc(p, c, 0.0, side)
                && in_disc(p, -c, 0.0, side);
            (p[1] < 0.0 && p.norm() < bottom) || between || in_disc(p, 0.0, high, top)
        })
    }
}
