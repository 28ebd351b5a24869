// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lenses of two equal arcs.

use super::outline::frame_between;
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::field::Placement;
use crate::kernel::{Kernel, face_if_on_it, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{Model, Scalar};
use crate::vector::{Point, Vector};

/// How many rounded operations the distance takes at most.
const OPERATIONS: f64 = 8.0;

/// The largest height for a width of one: the arcs' radius is a quarter of its square.
const LARGEST_ASPECT: f64 = 1e3;

/// A lens about the origin, bounded by two equal arcs that meet in tips on the y
/// axis. Exact.
///
/// # Derivation
///
/// With `a` and `b` half the width and height, the right arc's circle has its centre
/// at (−c, 0) and the radius `r = a + c`, and passes through (0, b), so
/// `2ar = a² + b²`. Fold to `x, y ≥ 0`: the nearest point is on that circle, or the
/// tip where the direction from the centre is past it, which shows in the sign of the
/// offset from the line through both.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Vesica};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // The arcs have a radius of 5 and centres at (±3, 0).
/// let lens = Shape::from_kernel(Vesica::new(4.0, 8.0)?);
/// assert_eq!(lens.distance(Vector([0.0, 0.0])), -2.0);
/// assert!((lens.distance(Vector([9.0, 5.0])) - 8.0).abs() < 1e-14); // 5-12-13
/// assert!((lens.distance(Vector([3.0, -8.0])) - 5.0).abs() < 1e-14); // from a tip
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Vesica {
    half_extents: [f64; 2],
    /// Of an arc.
    radius: f64,
    /// How far its centre is from the y axis.
    offset: f64,
}

impl Vesica {
    /// A lens of full `width` and `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive, the width more than the height, or less than a
    /// thousandth of it.
    pub fn new(width: f64, height: f64) -> Result<Self, ShapeError> {
        let a = 0.5 * positive("width", width, Unit::Metre)?;
        let b = 0.5 * positive("height", height, Unit::Metre)?;
        if width > height || height > LARGEST_ASPECT * width {
            let rule =
                format!("at most the height, {height} m, and at least a thousandth of it");
            return Err(ShapeError::number("width", rule, width, Unit::Metre));
        }
        let offset = 0.5 * (b - a) * ((b + a) / a);
        Ok(Self { half_extents: [a, b], radius: offset + a, offset })
    }
}

impl Kernel<2> for Vesica {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let [_, b] = self.half_extents;
        let folded = p.abs();
        let [x, y] = folded.0;
        let arc = S::norm([x + S::constant(self.offset), y]) - S::constant(self.radius);
        let tip = S::norm([y - S::constant(b), x]);
        let across = [-b / self.radius, self.offset / self.radius];
        let past = folded.dot_constant(&across) - S::constant(b * across[1]);
        S::select_less(zero, past, face_if_on_it(tip, arc, self.radius), arc)
    }

    #[inline(always)]
    fn model(&self, cell: Vector<Model, 2>) -> Model {
        tangent_model(self, cell, OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<2> {
        let half = Vector(self.half_extents);
        let bounds = Bounds::centred(half, half[1]);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.radius).symmetric()
    }
}

primitive! {
    Vesica, "vesica", 2,
    about: "A lens of two equal arcs that meet on the y axis.",
    model: Tangent,
    parameters: {
        width: Length = "the full width",
        height: Length = "from tip to tip, at least the width",
    },
    example: (0.9, 1.7),
}

/// A lens of two equal arcs between two points. Exact.
///
/// A [`Vesica`] in a frame of its own.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::OrientedVesica};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let leaf = OrientedVesica::new(Vector([0.0, 0.0]), Vector([8.0, 0.0]), 4.0)?;
/// let leaf = Shape::from_kernel(leaf);
/// assert!((leaf.distance(Vector([4.0, 0.0])) + 2.0).abs() < 1e-15);
/// assert!((leaf.distance(Vector([12.0, 3.0])) - 5.0).abs() < 1e-14); // from `to`
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct OrientedVesica {
    lens: Vesica,
    placement: Placement<2>,
}

impl OrientedVesica {
    /// A lens from tip to tip, of full `width` across [m].
    ///
    /// # Errors
    ///
    /// If the points are the same, a coordinate is not finite, or the width not
    /// positive, more than their distance or less than a thousandth of it.
    pub fn new(from: Point<2>, to: Point<2>, width: f64) -> Result<Self, ShapeError> {
        positive("width", width, Unit::Metre)?;
        let (placement, half_length) = frame_between(from, to)?;
        Ok(Self { lens: Vesica::new(width, 2.0 * half_length)?, placement })
    }
}

impl Kernel<2> for OrientedVesica {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.lens.distance(self.placement.to_body(p))
    }

    #[inline(always)]
    fn model(&self, cell: Vector<Model, 2>) -> Model {
        self.lens.model(self.placement.to_body(cell))
    }

    fn promise(&self) -> Promise<2> {
        self.lens.promise().placed(&self.placement.world_from_body)
    }
}

primitive! {
    OrientedVesica, "oriented_vesica", 2,
    about: "A lens of two equal arcs between two points.",
    model: Tangent,
    parameters: {
        from: Vector = "one tip",
        to: Vector = "the other tip",
        width: Length = "the full width across, at most the distance of the tips",
    },
    example: (Vector([-0.7, -0.4]), Vector([0.6, 0.5]), 0.6),
}
