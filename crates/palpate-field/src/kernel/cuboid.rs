// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes along the axes, sharp and rounded.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::Mark;
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The box `|pᵢ| ≤ sizeᵢ / 2`: a rectangle in 2D, a cuboid in 3D. Exact.
///
/// # Derivation
///
/// Fold `p` into the positive orthant; `qᵢ = |pᵢ| − sizeᵢ/2` is then the signed
/// distance to face `i`, and the box is the orthant `qᵢ ≤ 0`. Outside, the
/// nearest point undoes only the positive `qᵢ`; inside, the nearest face is the
/// one with the largest.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let plate = Shape::from_kernel(Cuboid::new(Vector([4.0, 2.0]))?);
/// assert_eq!(plate.distance(Vector([5.0, 5.0])), 5.0); // past a corner: 3-4-5
/// assert_eq!(plate.distance(Vector([0.0, 0.0])), -1.0); // the nearest face
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Cuboid<const D: usize> {
    half_extents: [f64; D],
}

impl<const D: usize> Cuboid<D> {
    /// A box with the given edge lengths [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive.
    pub fn new(size: Vector<f64, D>) -> Result<Self, ShapeError> {
        for length in size.0 {
            positive("size", length, Unit::Metre)?;
        }
        Ok(Self { half_extents: size.0.map(|length| 0.5 * length) })
    }
}

/// `|pᵢ| − hᵢ`: the signed distances to the faces of a box.
#[inline(always)]
pub(super) fn faces<S: Scalar, const D: usize>(
    p: Vector<S, D>,
    half_extents: &[f64; D],
) -> [S; D] {
    (p.abs() - Vector::of(half_extents)).0
}

impl<const D: usize> Kernel<D> for Cuboid<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        S::orthant(faces(p, &self.half_extents))
    }

    fn promise(&self) -> Promise<D> {
        let radius = Vector(self.half_extents).norm() * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(Vector(self.half_extents), radius);
        Promise::exact_convex(Some(bounds), 5.0, radius).symmetric()
    }
}

primitive! {
    Cuboid<D>, cuboid, any,
    about: "A box along the axes: a rectangle in 2D.",
    origin: "centred; edges along the axes",
    parameters: {
        size: Vector = "the edge lengths" => |kernel| Vector(kernel.half_extents) * 2.0,
    },
    marks: |kernel| Mark::edges(kernel.size(), 0.0),
    example: (Vector(std::array::from_fn(|i| [1.2, 0.8, 0.6][i]))),
}

/// A box along the axes with edges and corners rounded inwards. Exact.
///
/// The box `|pᵢ| ≤ sizeᵢ/2 − r`, grown by `r`: rounding does not enlarge it.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundedCuboid};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let key = Shape::from_kernel(RoundedCuboid::new(Vector([4.0, 2.0]), 0.5)?);
/// assert_eq!(key.distance(Vector([3.0, 0.0])), 1.0); // faces stay in place
/// assert_eq!(key.distance(Vector([4.5, 4.5])), 4.5); // √(3² + 4²) − 0.5
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundedCuboid<const D: usize> {
    pub(super) size: Vector<f64, D>,
    pub(super) core: [f64; D],
    pub(super) rounding: f64,
}

impl<const D: usize> RoundedCuboid<D> {
    /// A box with the given edge lengths [m], rounded with radius `rounding` [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the rounding is negative or more than half
    /// the shortest length.
    pub fn new(size: Vector<f64, D>, rounding: f64) -> Result<Self, ShapeError> {
        let sharp = Cuboid::new(size)?;
        let shortest = sharp.half_extents.iter().fold(f64::INFINITY, |m, h| m.min(*h));
        not_negative("rounding", rounding, Unit::Metre)?;
        if rounding > shortest {
            let rule = format!("at most half the shortest edge, {shortest} m");
            return Err(ShapeError::number("rounding", rule, rounding, Unit::Metre));
        }
        Ok(Self { size, core: sharp.half_extents.map(|h| h - rounding), rounding })
    }
}

impl<const D: usize> Kernel<D> for RoundedCuboid<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        S::orthant(faces(p, &self.core)) - S::constant(self.rounding)
    }

    fn promise(&self) -> Promise<D> {
        let core = Vector(self.core);
        let radius = (core.norm() + self.rounding) * (1.0 + 4.0 * f64::EPSILON);
        let half = core + Vector::constant(self.rounding);
        let bounds = Bounds::centred(half, radius);
        Promise::exact_convex(Some(bounds), 6.0, radius).symmetric()
    }
}

primitive! {
    RoundedCuboid<D>, rounded_cuboid, any,
    about: "A box along the axes, its edges rounded inwards.",
    origin: "centred; edges along the axes",
    parameters: {
        size: Vector = "the edge lengths",
        rounding: LengthOrZero = "the radius of the edges",
    },
    marks: |kernel| {
        let mut marks = Mark::edges(kernel.size(), kernel.rounding);
        marks.push(Mark::rounding(kernel.size(), kernel.rounding));
        marks
    },
    example: (Vector(std::array::from_fn(|i| [1.2, 0.8, 0.6][i])), 0.15),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, rounded_area, rounded_box};

    impl Evidence<2> for Cuboid<2> {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.07] }"#;
        const GUIDE: &'static [Row] = &[Row::new("Box", "`size`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            rounded_area(self.size() * 0.5, 0.0, 2.0)
        }
    }

    impl Evidence<2> for RoundedCuboid<2> {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.07], "rounding": 0.015 }"#;

        fn definition(&self) -> Definition<2> {
            rounded_area(self.size() * 0.5, self.rounding(), 2.0)
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 0.2]), 0.3)]
        }
    }

    impl Evidence<3> for Cuboid<3> {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.07, 0.05] }"#;
        const GUIDE: &'static [Row] = &[Row::new("Box", "`size`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            rounded_box(self.size() * 0.5, 0.0, 2.0)
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 0.0, 1.0]))]
        }
    }

    impl Evidence<3> for RoundedCuboid<3> {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.07, 0.05], "rounding": 0.015 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Round Box", "`size` with the rounding, `rounding`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            rounded_box(self.size() * 0.5, self.rounding(), 2.0)
        }
    }
}
