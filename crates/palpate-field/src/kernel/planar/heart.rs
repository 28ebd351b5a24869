// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The heart.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::Mark;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The height of a heart whose square has edges of one.
const HEIGHT: f64 = 0.75 * SQRT_2 + 0.5;

/// Half the width of that heart.
const HALF_WIDTH: f64 = 0.25 * SQRT_2 + 0.5;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 5.0;

/// A heart about the y axis, its tip down, centred at half its height: a square on
/// its corner, with half a disc on each of its upper edges. Exact.
///
/// # Derivation
///
/// Fold to x ≥ 0 and take, from the tip, `t` along the right edge of the square and `s` across
/// it, to the right. With e the length of the edge, the half circle about (−e/2, e) leads from
/// the edge's end (0, e), without a corner there, to the cleft (−e, e). Where `t > e` it is the
/// nearest, since its normals fill that half-plane. Elsewhere the nearest point is on the edge
/// (from below, it is the tip) or, from inside, the cleft.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Heart};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let heart = Shape::from_kernel(Heart::new(2.0)?);
/// assert!((heart.distance(Vector([0.0, -3.0])) - 2.0).abs() < 1e-15); // below the tip
/// // The middle of the square is as far from its edges as the discs' radius.
/// let edge = 2.0 / (0.75 * 2.0_f64.sqrt() + 0.5);
/// let middle = Vector([0.0, -1.0 + edge * 0.5_f64.sqrt()]);
/// assert!((heart.distance(middle) + 0.5 * edge).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Heart {
    height: f64,
    /// The edge of the square.
    edge: f64,
}

impl Heart {
    /// A heart of full `height` [m].
    ///
    /// # Errors
    ///
    /// If the height is not positive.
    pub fn new(height: f64) -> Result<Self, ShapeError> {
        positive("height", height, Unit::Metre)?;
        Ok(Self { height, edge: height / HEIGHT })
    }
}

impl Kernel<2> for Heart {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let edge = S::constant(self.edge);
        let q = Vector([p.0[0].abs(), p.0[1] + S::constant(0.5 * self.height)]);
        let across = q.dot_constant(&[FRAC_1_SQRT_2, -FRAC_1_SQRT_2]);
        let along = q.dot_constant(&[FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
        let past_edge = along - edge;
        let half = S::constant(0.5 * self.edge);
        let lobe = S::norm([across + half, past_edge]) - half;
        let tip = S::norm([across, along]);
        let side = S::select_less(along, zero, tip, across);
        // The larger of two negative numbers is the nearer; outside, the edge is.
        let square = side.max(-S::norm([across + edge, past_edge]));
        S::select_less(zero, past_edge, lobe, square)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.height })
    }

    fn promise(&self) -> Promise<2> {
        let half = Vector([HALF_WIDTH * self.edge, 0.5 * self.height]);
        let room = 4.0 * f64::EPSILON * self.height;
        let bounds = Bounds::of_box(Aabb::centred(half).grown(room));
        Promise {
            symmetric: [true, false],
            ..Promise::exact(Some(bounds), OPERATIONS, self.height)
        }
    }
}

primitive! {
    Heart, heart, 2,
    about: "A heart, its tip down: a square on its corner with half a disc on each upper edge.",
    origin: "centred, at half its height; a tip down",
    parameters: { height: Length = "the full height" },
    marks: |kernel| {
        let lobe = 0.5 * FRAC_1_SQRT_2 * kernel.edge;
        vec![Mark::height(kernel.height, 0.0, lobe)]
    },
    example: (1.7),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::FRAC_PI_4;

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, arc};

    impl Evidence<2> for Heart {
        const SAMPLE: &'static str = r#"{ "height": 0.1 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Heart", "`height`", "exact")];

        fn definition(&self) -> Definition<2> {
            heart(self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(-1.0)]
        }
    }

    /// A square on its corner and the discs over its upper edges.
    fn heart(height: f64) -> Definition<2> {
        let edge = height / (0.75 * SQRT_2 + 0.5);
        let half = edge * FRAC_1_SQRT_2;
        let low = -0.5 * height;
        let (middle, lobe) = (low + half, low + 1.5 * half);
        let tip = Vector([0.0, low]);
        let boundary = vec![
            Patch::segment(tip, Vector([half, middle])),
            Patch::segment(tip, Vector([-half, middle])),
            arc([0.5 * half, lobe], 0.5 * edge, [-FRAC_PI_4, 3.0 * FRAC_PI_4]),
            arc([-0.5 * half, lobe], 0.5 * edge, [FRAC_PI_4, 5.0 * FRAC_PI_4]),
        ];
        Definition::new(boundary, move |p| {
            let in_square = p[0].abs() + (p[1] - middle).abs() < half;
            let in_lobe = (Vector([p[0].abs(), p[1]]) - Vector([0.5 * half, lobe])).norm();
            in_square || in_lobe < 0.5 * edge
        })
    }
}
