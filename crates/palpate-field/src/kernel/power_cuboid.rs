// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The box rounded in another norm.

use super::cuboid::{RoundedCuboid, faces};
use super::exponent::{Exponent, in_another_norm};
use crate::bounds::Bounds;
use crate::error::ShapeError;
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// A box along the axes with edges and corners rounded inwards by balls of the norm
/// `‖·‖_P`: fuller than round ones, and flat where they meet a face. A bound on both
/// sides.
///
/// `f = ‖max(q, 0)‖_P + min(max qᵢ, 0) − r` with `qᵢ = |pᵢ| − (sizeᵢ/2 − r)`.
///
/// # Derivation
///
/// `f + r` is the maximum of `w·q` over all `w ≥ 0` with `Σwᵢ^(P/(P−1)) = 1`: by Hölder's
/// inequality where some `qᵢ` is positive; elsewhere the best `w` is a unit vector along an
/// axis. So `f` is convex in `q` and grows with each `qᵢ`, hence it is convex in `p`. No such
/// `w` is longer than one, so the Lipschitz constant is 1, and values are bounds. The curvature
/// of these edges is zero where they meet a face.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::PowerCuboid};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let key = Shape::from_kernel(PowerCuboid::new(Vector([4.0, 2.0]), 0.5, 4)?);
/// assert_eq!(key.distance(Vector([3.0, 0.0])), 1.0); // faces stay in place
/// assert_eq!(key.distance(Vector([0.0, 0.25])), -0.75);
/// // 2 beyond the centre of a corner's rounding, along both axes
/// let past_a_corner = key.distance(Vector([3.5, 2.5]));
/// assert!((past_a_corner - (2.0_f64.powf(1.25) - 0.5)).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PowerCuboid<const D: usize> {
    rounded: RoundedCuboid<D>,
    exponent: Exponent,
}

impl<const D: usize> PowerCuboid<D> {
    /// A box with the given edge lengths [m], rounded with radius `rounding` [m] in the
    /// norm of an `exponent` of 4, 6 or 8.
    ///
    /// # Errors
    ///
    /// If a length is not positive, the rounding is negative or more than half the
    /// shortest length, or the exponent is another.
    pub fn new(size: Vector<f64, D>, rounding: f64, exponent: u32) -> Result<Self, ShapeError> {
        Ok(Self {
            rounded: RoundedCuboid::new(size, rounding)?,
            exponent: Exponent::new("exponent", exponent)?,
        })
    }
}

impl<const D: usize> Kernel<D> for PowerCuboid<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        let q = faces(p, &self.rounded.core);
        self.exponent.orthant(q) - S::constant(self.rounded.rounding)
    }

    fn promise(&self) -> Promise<D> {
        let (core, rounding) = (Vector(self.rounded.core), self.rounded.rounding);
        let corner = self.exponent.reach::<D>() * rounding;
        let radius = (core.norm() + corner) * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(core + Vector::constant(rounding), radius);
        in_another_norm(Promise::exact_convex(Some(bounds), 6.0, radius).symmetric())
    }
}

primitive! {
    PowerCuboid<D>, power_cuboid, any,
    about: "A box along the axes, its edges rounded inwards in a norm of higher powers.",
    origin: "centred; edges along the axes",
    parameters: {
        size: Vector = "the edge lengths" => |kernel| kernel.rounded.size,
        rounding: LengthOrZero = "the radius of the edges along the axes"
            => |kernel| kernel.rounded.rounding,
        exponent: Count = "the power that the norm adds up, 4, 6 or 8"
            => |kernel| kernel.exponent.number(),
    },
    marks: |kernel| {
        let (size, rounding) = (kernel.size(), kernel.rounding());
        let mut marks = Mark::edges(size, rounding);
        let (x, y) = (0.5 * size[0], 0.5 * size[1] - rounding);
        marks.push(Mark::length_between("rounding", at(x - rounding, y), at(x, y)));
        marks
    },
    example: (Vector(std::array::from_fn(|i| [1.4, 1.1, 0.9][i])), 0.4, 6),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, bound, rounded_area, rounded_box};

    impl Evidence<2> for PowerCuboid<2> {
        const SAMPLE: &'static str =
            r#"{ "size": [0.1, 0.07], "rounding": 0.03, "exponent": 8 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Round Box, by another length",
            "`size` with the rounding, `rounding`, `exponent`",
            "bound, convex",
        )];

        fn definition(&self) -> Definition<2> {
            bound(rounded_area(self.size() * 0.5, self.rounding(), f64::from(self.exponent())))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 0.5]), 0.3, 4), Self::new(Vector([1.0, 0.5]), 0.1, 7)]
        }
    }

    impl Evidence<3> for PowerCuboid<3> {
        const SAMPLE: &'static str =
            r#"{ "size": [0.1, 0.07, 0.05], "rounding": 0.025, "exponent": 4 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Round Box, by another length",
            "`size` with the rounding, `rounding`, `exponent`",
            "bound, convex",
        )];

        fn definition(&self) -> Definition<3> {
            bound(rounded_box(self.size() * 0.5, self.rounding(), f64::from(self.exponent())))
        }
    }
}
