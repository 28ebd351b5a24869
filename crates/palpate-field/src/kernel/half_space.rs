// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Half-spaces.

use crate::error::{ShapeError, Unit, finite};
use crate::kernel::mark::Mark;
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// All points behind a plane: `n·p ≤ offset`, with `n` pointing out. Exact,
/// without bounds.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::HalfSpace};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 2.0, 0.0]), -0.5)?);
/// assert_eq!(floor.distance(Vector([7.0, 1.0, 7.0])), 1.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct HalfSpace<const D: usize> {
    normal: Vector<f64, D>,
    /// The normal, of length one.
    unit: [f64; D],
    offset: f64,
}

impl<const D: usize> HalfSpace<D> {
    /// The half-space behind the plane at `offset` [m] from the origin along
    /// `normal`, which need not be of length one.
    ///
    /// # Errors
    ///
    /// If the normal has no direction or the offset is not finite.
    pub fn new(normal: Vector<f64, D>, offset: f64) -> Result<Self, ShapeError> {
        let Some(unit) = normal.normalized() else {
            return Err(ShapeError::number("normal", "a direction", normal.norm(), Unit::One));
        };
        Ok(Self { normal, unit: unit.0, offset: finite("offset", offset, Unit::Metre)? })
    }
}

impl<const D: usize> Kernel<D> for HalfSpace<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        p.dot_constant(&self.unit) - S::constant(self.offset)
    }

    fn promise(&self) -> Promise<D> {
        Promise::exact_convex(None, 6.0, self.offset.abs())
    }
}

primitive! {
    HalfSpace<D>, half_space, any,
    about: "All points behind a plane.",
    origin: "endless; `offset` from the origin along `normal`, which points out",
    parameters: {
        normal: Direction = "the direction out of the half-space, of any length",
        offset: Coordinate = "where the plane is along the normal",
    },
    marks: |kernel| {
        let out = kernel.normal().normalized().unwrap_or(Vector::ZERO);
        let foot = out * kernel.offset();
        vec![
            Mark::direction("normal", foot, foot + out * 0.5),
            Mark::from_origin("offset", foot),
        ]
    },
    example: (Vector(std::array::from_fn(|i| [0.3, 1.0, -0.2][i])), 0.1),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, FAR, Patch, Row, cross};
    use crate::vector::Point;

    impl Evidence<2> for HalfSpace<2> {
        const SAMPLE: &'static str = r#"{ "normal": [1, 2], "offset": 0.01 }"#;

        fn definition(&self) -> Definition<2> {
            let normal = self.normal().normalized().unwrap_or(Vector::unit(0));
            let offset = self.offset();
            let along = Vector([-normal[1], normal[0]]) * FAR;
            let foot = normal * offset;
            let line = Patch::segment(foot - along, foot + along);
            Definition::new(vec![line], move |p| p.dot(normal) < offset)
        }
    }

    impl Evidence<3> for HalfSpace<3> {
        const SAMPLE: &'static str = r#"{ "normal": [1, 2, 0.5], "offset": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Plane",
            "`normal` of any length, `offset`",
            "exact, convex, unbounded",
        )];

        fn definition(&self) -> Definition<3> {
            half_space(self.normal(), self.offset())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([0.0, 0.0, 0.0]), 0.0)]
        }
    }

    fn half_space(normal: Point<3>, offset: f64) -> Definition<3> {
        let normal = normal.normalized().unwrap_or(Vector::unit(0));
        let least =
            (0..3).min_by(|i, j| normal[*i].abs().total_cmp(&normal[*j].abs())).unwrap_or(0);
        let x = cross(normal, Vector::unit(least)).normalized().unwrap_or(Vector::unit(0));
        let y = cross(normal, x);
        let plane = Patch::surface([2.0 * FAR; 2], move |u, v| {
            normal * offset + x * (FAR * (2.0 * u - 1.0)) + y * (FAR * (2.0 * v - 1.0))
        });
        Definition::new(vec![plane], move |p| p.dot(normal) < offset)
    }
}
