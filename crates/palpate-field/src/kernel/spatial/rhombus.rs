// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Prisms on rhombi.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::profile::{Rhombus, inner_radius};
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 10.0;

/// A prism along y on a rhombus whose diagonals are along x and z, its edges rounded
/// inwards. Exact.
///
/// The orthant of the rhombus's distance and `|y| − h/2`. All faces are moved inwards by the
/// rounding, and the smaller prism is grown by as much, which puts the faces back.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RhombusPrism};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let tile = Shape::from_kernel(RhombusPrism::new(Vector([8.0, 2.0, 6.0]), 0.0)?);
/// assert_eq!(tile.distance(Vector([8.0, 4.0, 0.0])), 5.0); // past a corner: 3-4-5
/// assert!((tile.distance(Vector([5.0, 0.0, 5.0])) - 4.6).abs() < 1e-15); // from a side
/// assert_eq!(tile.distance(Vector([1.0, 0.75, 1.0])), -0.25);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RhombusPrism {
    size: Vector<f64, 3>,
    rhombus: Rhombus,
    half_height: f64,
    rounding: f64,
}

impl RhombusPrism {
    /// A prism with diagonals of `size[0]` along x and `size[2]` along z, `size[1]` high,
    /// its edges rounded with radius `rounding` [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the rounding is negative or more than half the
    /// height or the radius of the circle in the rhombus.
    pub fn new(size: Vector<f64, 3>, rounding: f64) -> Result<Self, ShapeError> {
        for length in size.0 {
            positive("size", length, Unit::Metre)?;
        }
        let [a, half_height, b] = size.0.map(|length| 0.5 * length);
        not_negative("rounding", rounding, Unit::Metre)?;
        let most = half_height.min(inner_radius([a, b]));
        if rounding > most {
            let rule = format!(
                "at most half the height and the radius of the circle in the rhombus, {most} m"
            );
            return Err(ShapeError::number("rounding", rule, rounding, Unit::Metre));
        }
        let rhombus = Rhombus::new([a, b], rounding);
        Ok(Self { size, rhombus, half_height: half_height - rounding, rounding })
    }

    /// From the centre to the farthest corner of the smaller prism, by coordinate [m].
    fn core(&self) -> Vector<f64, 3> {
        let [a, b] = self.rhombus.corners();
        Vector([a, self.half_height, b])
    }

    /// The radius of the bounding ball [m].
    fn reach(&self) -> f64 {
        self.core().norm() + self.rounding
    }
}

impl Kernel<3> for RhombusPrism {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.abs().0;
        S::orthant([self.rhombus.distance([x, z]), y - S::constant(self.half_height)])
            - S::constant(self.rounding)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.reach())
    }

    fn promise(&self) -> Promise<3> {
        let core = self.core();
        let widest = core[0].max(core[2]).hypot(core[1]);
        let radius = (widest + self.rounding) * (1.0 + 4.0 * f64::EPSILON);
        let half = (core + Vector::constant(self.rounding)) * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(half, radius);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.reach()).symmetric()
    }
}

primitive! {
    RhombusPrism, rhombus_prism, 3,
    about: "A prism along y on a rhombus, its edges rounded inwards.",
    origin: "centred; axis along y, diagonals along x and z",
    parameters: {
        size: Vector = "the diagonal along x, the height along y and the diagonal along z, before rounding",
        rounding: LengthOrZero = "the radius of the edges",
    },
    marks: |kernel| {
        let (size, rounding) = (kernel.size(), kernel.rounding());
        let [x, y, z] = size.0.map(|size| 0.5 * size);
        let deep = Mark::length_between("size", Vector([0.0, 0.0, -z]), Vector([0.0, 0.0, z]));
        let inner = at(kernel.rhombus.corners()[0], kernel.half_height);
        vec![
            Mark::width("size", x, 0.0).of(0),
            Mark::length_between("size", at(0.0, -y), at(0.0, y)).of(1).left(),
            deep.of(2).left(),
            Mark::length_between("rounding", inner, inner + at(0.0, rounding)),
        ]
    },
    example: (Vector([1.6, 0.6, 1.0]), 0.08),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, slab};
    use crate::vector::Point;

    impl Evidence<3> for RhombusPrism {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.06, 0.07], "rounding": 0.005 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Rhombus",
            "`size`: the full diagonals and the height; `rounding`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            rhombus_prism(self.size(), self.rounding())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([0.6, 1.0, 0.8]), 0.25)]
        }
    }

    /// The rhombus with its faces moved inwards by `r`, then grown by `r`.
    fn rhombus_prism(size: Point<3>, r: f64) -> Definition<3> {
        let [a, half, b] = (size * 0.5).0;
        let slope = b.atan2(a);
        let face = a * slope.sin() - r;
        let (a, b) = (face / slope.sin(), face / slope.cos());
        // About y, from z to x.
        let corners =
            [[0.0, b], [a, 0.0], [0.0, -b], [-a, 0.0]].map(|[x, z]| Vector([x, 0.0, z]));
        slab(corners.to_vec(), Vector::unit(1), half - r, r)
    }
}
