// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The ball.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// All points within `radius` of the origin: a disc in 2D, a ball in 3D.
///
/// `f = ‖p‖ − r`, exact.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// assert_eq!(ball.distance(Vector([2.0, 3.0, 6.0])), 6.5);
/// assert_eq!(ball.distance(Vector([0.0, 0.0, 0.0])), -0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Ball {
    radius: f64,
}

impl Ball {
    /// A ball of `radius` [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn new(radius: f64) -> Result<Self, ShapeError> {
        Ok(Self { radius: positive("radius", radius, Unit::Metre)? })
    }
}

impl<const D: usize> Kernel<D> for Ball {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        p.norm() - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<D> {
        let bounds = Bounds::centred(Vector::constant(self.radius), self.radius);
        Promise::exact_convex(Some(bounds), 3.0, self.radius).symmetric()
    }
}

primitive! {
    Ball, ball, any,
    about: "All points within a radius of the origin.",
    origin: "centred",
    parameters: { radius: Length = "the radius" },
    marks: |kernel| vec![Mark::from_origin("radius", at(kernel.radius, 0.0))],
    example: (0.7),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::TAU;

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, ellipsoid};

    impl Evidence<2> for Ball {
        const SAMPLE: &'static str = r#"{ "radius": 0.05 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Circle", "`radius`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let r = self.radius();
            Definition::new(vec![arc([0.0; 2], r, [0.0, TAU])], move |p| p.norm() < r)
        }
    }

    impl Evidence<3> for Ball {
        const SAMPLE: &'static str = r#"{ "radius": 0.05 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Sphere", "`radius`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            ellipsoid(Vector([self.radius(); 3]))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(-0.02),
                Self::new(f64::NAN),
                Self::new(f64::INFINITY),
                Self::new(1e-20),
            ]
        }
    }
}
