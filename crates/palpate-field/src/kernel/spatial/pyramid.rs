// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Square pyramids.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::sets;
use crate::kernel::profile::{beside, intersection};
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Vector, array};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 18.0;

/// A pyramid on a square in x and z, its tip up along y, centred at half its
/// height. Exact.
///
/// # Derivation
///
/// Fold the eight symmetric parts into `a ≥ b ≥ 0`, with `a` and `b` the larger
/// and smaller of `|x|` and `|z|`. There the nearest face is the base or the one
/// side that crosses the a axis; inside, the nearer plane decides. Outside, the
/// nearest point is on the base where `p` is below it, on the side where its
/// foot falls into the side's half triangle, else on the edge of the base or the
/// edge that rises to the tip.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Pyramid};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let giza = Shape::from_kernel(Pyramid::new(6.0, 4.0)?);
/// assert!((giza.distance(Vector([0.0, 5.0, 0.0])) - 3.0).abs() < 1e-15); // the tip
/// assert_eq!(giza.distance(Vector([1.0, -4.0, 2.0])), 2.0); // below the base
/// assert_eq!(giza.distance(Vector([6.0, -6.0, 0.0])), 5.0); // from an edge
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Pyramid {
    half_side: f64,
    half_height: f64,
    /// From the base along the middle of a side to the tip: direction and length.
    slope: [f64; 2],
    slant: f64,
    /// From a corner of the base to the tip: direction and length.
    ridge: [f64; 3],
    ridge_length: f64,
}

impl Pyramid {
    /// A pyramid on a square of the given `side`, of full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(side: f64, height: f64) -> Result<Self, ShapeError> {
        let half_side = 0.5 * positive("side", side, Unit::Metre)?;
        let height = positive("height", height, Unit::Metre)?;
        let slant = half_side.hypot(height);
        let ridge_length = half_side.hypot(slant);
        Ok(Self {
            half_side,
            half_height: 0.5 * height,
            slope: [-half_side / slant, height / slant],
            slant,
            ridge: [-half_side, height, -half_side].map(|x| x / ridge_length),
            ridge_length,
        })
    }
}

impl Kernel<3> for Pyramid {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let zero = S::constant(0.0);
        let (x, z) = (p.0[0].abs(), p.0[2].abs());
        let (a, b) = (x.max(z), z.min(x));
        let y = p.0[1] + S::constant(self.half_height);
        let half = S::constant(self.half_side);
        let [along_a, along_y] = self.slope;
        let beyond = a - half;
        let along = beyond.scale(along_a) + y.scale(along_y);
        let out = beyond.scale(along_y) - y.scale(along_a);
        let inside = out.max(-y);

        let base_edge = S::norm([beyond, y, (b - half).max(zero)]);
        let corner = Vector([beyond, y, b - half]);
        let up = corner.dot_constant(&self.ridge);
        let up_ridge = up.clamp(0.0, self.ridge_length);
        let on_ridge = Vector(array!(i < 3 => up_ridge.scale(self.ridge[i])));
        let ridge = (corner - on_ridge).norm();
        // Where the point is past the corner on the base's edge, or up the side, the ridge decides:
        // where both edges are as near to within a rounding, their directions are not.
        let beside_corner = S::select_less(along, zero, base_edge, ridge);
        let not_past = S::select_less(half, b, ridge, beside_corner);
        let edges = S::select_less(up, zero, base_edge, not_past);
        // On the side: between base and tip, and no further across than the side
        // is wide there.
        let share = along.scale(1.0 / self.slant);
        let width = half - share.scale(self.half_side);
        let past_side = (b - width).max(-along);
        let pieces = beside(out, past_side, beside(-y, beyond, edges));
        intersection(inside, pieces, self.ridge_length)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.ridge_length + self.half_side)
    }

    fn promise(&self) -> Promise<3> {
        let half = Vector([self.half_side, self.half_height, self.half_side]);
        let radius = half.norm() * (1.0 + 4.0 * f64::EPSILON);
        let size = self.ridge_length + self.half_side;
        Promise {
            symmetric: [true, false, true],
            ..Promise::exact_convex(Some(Bounds::centred(half, radius)), OPERATIONS, size)
        }
    }
}

primitive! {
    Pyramid, pyramid, 3,
    about: "A pyramid on a square, its tip up along y.",
    origin: "centred, at half its height; a tip up, a base with edges along x and z",
    parameters: {
        side: Length = "the edge of the base" => |kernel| 2.0 * kernel.half_side,
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| sets::arch("side", kernel.side(), kernel.height()),
    example: (1.0, 0.9),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, pyramid};

    impl Evidence<3> for Pyramid {
        const SAMPLE: &'static str = r#"{ "side": 0.08, "height": 0.1 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Pyramid", "`side`, `height`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            pyramid(self.side(), self.height())
        }
    }
}
