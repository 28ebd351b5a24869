// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The ball of another norm.

use super::exponent::{Exponent, in_another_norm};
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// All points with `‖p‖_P ≤ radius`, where `‖p‖_P = (Σ|pᵢ|^P)^(1/P)`: between a ball and
/// the cube around it. A bound on both sides.
///
/// `f = ‖p‖_P − r`. The shape is due to Lamé (1818), its use as a change of metric in distance
/// functions to Quilez.
///
/// # Derivation
///
/// A norm is convex, and by the triangle inequality changes from `p` to `q` by at most
/// `‖p − q‖_P ≤ ‖p − q‖`. So `f` has the Lipschitz constant 1, and the surface is at least as
/// far away as the value. On the axes it is the distance outside; along the diagonals it has
/// the slope `D^(1/P − 1/2)`, in space 0.66 for `P` = 8.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::PowerBall};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let dice = Shape::from_kernel(PowerBall::new(1.0, 4)?);
/// assert_eq!(dice.distance(Vector([0.0, -3.0, 0.0])), 2.0);
/// let past_an_edge = dice.distance(Vector([2.0, 2.0, 0.0]));
/// assert!((past_an_edge - (2.0_f64.powf(1.25) - 1.0)).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PowerBall {
    radius: f64,
    exponent: Exponent,
}

impl PowerBall {
    /// The ball of `radius` [m] in the norm of an `exponent` of 4, 6 or 8.
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the exponent another.
    pub fn new(radius: f64, exponent: u32) -> Result<Self, ShapeError> {
        Ok(Self {
            radius: positive("radius", radius, Unit::Metre)?,
            exponent: Exponent::new("exponent", exponent)?,
        })
    }
}

impl<const D: usize> Kernel<D> for PowerBall {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        self.exponent.norm(p.0) - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<D> {
        let reach = self.exponent.reach::<D>() * self.radius;
        let bounds = Bounds::centred(Vector::constant(self.radius), reach);
        in_another_norm(Promise::exact_convex(Some(bounds), 4.0, self.radius).symmetric())
    }
}

primitive! {
    PowerBall, power_ball, any,
    about: "A ball in the norm of fourth, sixth or eighth powers: a rounded cube.",
    origin: "centred; radii along the axes",
    parameters: {
        radius: Length = "the radius along the axes",
        exponent: Count = "the power that the norm adds up, 4, 6 or 8"
            => |kernel| kernel.exponent.number(),
    },
    marks: |kernel| vec![Mark::from_origin("radius", at(kernel.radius, 0.0))],
    example: (0.8, 4),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, bound, norm, on_ball, speed};

    impl Evidence<2> for PowerBall {
        const SAMPLE: &'static str = r#"{ "radius": 0.045, "exponent": 4 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Sphere, by another length",
            "`radius` along the axes, `exponent`",
            "bound, convex",
        )];

        fn definition(&self) -> Definition<2> {
            disc(self.radius(), f64::from(self.exponent()))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(-0.5, 4), Self::new(0.5, 2)]
        }
    }

    impl Evidence<3> for PowerBall {
        const SAMPLE: &'static str = r#"{ "radius": 0.04, "exponent": 6 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Sphere, by another length",
            "`radius` along the axes, `exponent`",
            "bound, convex",
        )];

        fn definition(&self) -> Definition<3> {
            ball(self.radius(), f64::from(self.exponent()))
        }
    }

    fn disc(radius: f64, exponent: f64) -> Definition<2> {
        let circle = Patch::curve(TAU * radius * speed::<2>(exponent), move |t| {
            let (sin, cos) = (TAU * t).sin_cos();
            on_ball(Vector([cos, sin]), exponent) * radius
        });
        bound(Definition::new(vec![circle], move |p| norm(p, exponent) < radius))
    }

    fn ball(radius: f64, exponent: f64) -> Definition<3> {
        let speed = radius * speed::<3>(exponent);
        let surface = Patch::surface([PI * speed, TAU * speed], move |u, v| {
            let ((up, across), (sin, cos)) = ((PI * (u - 0.5)).sin_cos(), (TAU * v).sin_cos());
            on_ball(Vector([across * cos, up, across * sin]), exponent) * radius
        });
        bound(Definition::new(vec![surface], move |p| norm(p, exponent) < radius))
    }
}
