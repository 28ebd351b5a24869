// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The ring between two circles.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 5.0;

/// All points between two circles about the origin. Exact.
///
/// `f = |‖p‖ − m| − w`, with `m` the mean radius and `2w` the width.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ring};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let washer = Shape::from_kernel(Ring::new(2.0, 4.0)?);
/// assert_eq!(washer.distance(Vector([0.0, 0.5])), 1.5); // in the hole
/// assert_eq!(washer.distance(Vector([3.0, 4.0])), 1.0); // outside
/// assert_eq!(washer.distance(Vector([-3.0, 0.0])), -1.0); // in the middle
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Ring {
    inner_radius: f64,
    outer_radius: f64,
    mean_radius: f64,
    half_width: f64,
}

impl Ring {
    /// The ring between circles of `inner_radius` and `outer_radius` [m].
    ///
    /// # Errors
    ///
    /// If the inner radius is not positive or the outer not larger.
    pub fn new(inner_radius: f64, outer_radius: f64) -> Result<Self, ShapeError> {
        positive("inner_radius", inner_radius, Unit::Metre)?;
        positive("outer_radius", outer_radius, Unit::Metre)?;
        if outer_radius <= inner_radius {
            let rule = format!("more than the inner radius, {inner_radius} m");
            return Err(ShapeError::number("outer_radius", rule, outer_radius, Unit::Metre));
        }
        Ok(Self {
            inner_radius,
            outer_radius,
            mean_radius: 0.5 * (inner_radius + outer_radius),
            half_width: 0.5 * (outer_radius - inner_radius),
        })
    }
}

impl Kernel<2> for Ring {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        (p.norm() - S::constant(self.mean_radius)).abs() - S::constant(self.half_width)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.mean_radius + self.half_width })
    }

    fn promise(&self) -> Promise<2> {
        let radius = self.mean_radius + self.half_width;
        let bounds = Bounds::centred(Vector::constant(radius), radius);
        Promise::exact(Some(bounds), OPERATIONS, radius).symmetric()
    }
}

primitive! {
    Ring, ring, 2,
    about: "All points between two circles.",
    origin: "centred",
    parameters: {
        inner_radius: Length = "the radius of the hole",
        outer_radius: Length = "the radius of the outer circle",
    },
    marks: |kernel| {
        let (inner, outer) = (kernel.inner_radius(), kernel.outer_radius());
        vec![
            Mark::from_origin("inner_radius", at(-0.6 * inner, -0.8 * inner)),
            Mark::from_origin("outer_radius", at(0.8 * outer, 0.6 * outer)),
        ]
    },
    example: (0.4, 0.8),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::TAU;

    use super::*;
    use crate::oracle::{Definition, Evidence, arc};
    use crate::vector::Point;

    impl Evidence<2> for Ring {
        const SAMPLE: &'static str = r#"{ "inner_radius": 0.03, "outer_radius": 0.05 }"#;

        fn definition(&self) -> Definition<2> {
            let (inner, outer) = (self.inner_radius(), self.outer_radius());
            let circles = [inner, outer].map(|r| arc([0.0; 2], r, [0.0, TAU]));
            let between = move |p: Point<2>| inner < p.norm() && p.norm() < outer;
            Definition::new(circles.into(), between)
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.2, 0.1)]
        }
    }
}
