// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rhombi, parallelograms, trapezoids and triangles along the axes.

use super::line::Edge;
use super::outline::bounds_about;
use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, finite, not_negative, positive};
use crate::kernel::mark::{Mark, at, sets};
use crate::kernel::profile::{self, beside, intersection};
use crate::kernel::{Kernel, answered_by_inner, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distances.
const OPERATIONS: f64 = 6.0;

/// A rhombus about the origin, its diagonals along the axes. Exact.
///
/// Folded to `x, y ≥ 0`, it is the profile of a
/// [`RhombusPrism`](crate::kernel::RhombusPrism).
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Rhombus};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let diamond = Shape::from_kernel(Rhombus::new(Vector([8.0, 6.0]))?);
/// assert!((diamond.distance(Vector([0.0, 0.0])) + 2.4).abs() < 1e-15); // 3·4/5
/// assert!((diamond.distance(Vector([-5.0, 0.0])) - 1.0).abs() < 1e-15); // a corner
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Rhombus(profile::Rhombus);

impl Rhombus {
    /// A rhombus with the given full diagonals along x and y [m].
    ///
    /// # Errors
    ///
    /// If a diagonal is not positive.
    pub fn new(size: Vector<f64, 2>) -> Result<Self, ShapeError> {
        for length in size.0 {
            positive("size", length, Unit::Metre)?;
        }
        Ok(Self(profile::Rhombus::new(size.0.map(|length| 0.5 * length), 0.0)))
    }

    fn radius(&self) -> f64 {
        let [a, b] = self.0.corners();
        a.max(b)
    }
}

impl Kernel<2> for Rhombus {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.0.distance(p.abs().0)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.radius())
    }

    fn promise(&self) -> Promise<2> {
        let bounds = Bounds::centred(Vector(self.0.corners()), self.radius());
        Promise::exact_convex(Some(bounds), OPERATIONS, self.radius()).symmetric()
    }
}

primitive! {
    Rhombus, rhombus, 2,
    about: "A rhombus, its diagonals along the axes.",
    origin: "centred; diagonals along the axes",
    parameters: {
        size: Vector = "the full diagonals along x and y"
            => |kernel| Vector(kernel.0.corners()) * 2.0,
    },
    marks: |kernel| {
        let [x, y] = kernel.size().0.map(|size| 0.5 * size);
        vec![
            Mark::width("size", x, 0.0).of(0),
            Mark::length_between("size", at(0.0, -y), at(0.0, y)).of(1).left(),
        ]
    },
    example: (Vector([1.8, 1.1])),
}

/// A parallelogram about the origin, two of its edges along x. Exact.
///
/// # Derivation
///
/// A half turn maps it to itself, so a point below the x axis is turned above it. There the
/// bottom is never the nearest edge; the top and both whole sides decide, since the lower half
/// of a skewed side may be nearest.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Parallelogram};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let slanted = Shape::from_kernel(Parallelogram::new(10.0, 4.0, 3.0)?);
/// assert_eq!(slanted.distance(Vector([0.0, 0.0])), -2.0);
/// assert_eq!(slanted.distance(Vector([1.0, -3.0])), 1.0);
/// // From the corner at (6.5, 2), where the top is moved to.
/// assert!((slanted.distance(Vector([9.5, 6.0])) - 5.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Parallelogram {
    width: f64,
    skew: f64,
    half_extents: [f64; 2],
    radius: f64,
    top: Edge,
    right: Edge,
    left: Edge,
}

impl Parallelogram {
    /// A parallelogram whose top and bottom are `width` long and `height` apart,
    /// the top `skew` further to the right than the bottom [m].
    ///
    /// # Errors
    ///
    /// If the width or height is not positive, or the skew not finite.
    pub fn new(width: f64, height: f64, skew: f64) -> Result<Self, ShapeError> {
        let w = 0.5 * positive("width", width, Unit::Metre)?;
        let h = 0.5 * positive("height", height, Unit::Metre)?;
        let s = 0.5 * finite("skew", skew, Unit::Metre)?;
        let (top_left, top_right) = (Vector([s - w, h]), Vector([s + w, h]));
        Ok(Self {
            width,
            skew,
            half_extents: [w + s.abs(), h],
            radius: (w + s.abs()).hypot(h),
            // Counter-clockwise: outside is to the right.
            top: Edge::new(top_right, top_left),
            right: Edge::new(-top_left, top_right),
            left: Edge::new(top_left, -top_right),
        })
    }
}

impl Kernel<2> for Parallelogram {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let x = S::select_less(p.0[1], S::constant(0.0), -p.0[0], p.0[0]);
        let turned = Vector([x, p.0[1].abs()]);
        let top = self.top.offsets(turned);
        let right = self.right.offsets(turned);
        let left = self.left.offsets(turned);
        let sides = top[0].max(right[0]).max(left[0]);
        let corners = S::norm(top).min(S::norm(right)).min(S::norm(left));
        let by_sides = beside(right[0], right[1], beside(left[0], left[1], corners));
        let pieces = beside(top[0], top[1], by_sides);
        intersection(sides, pieces, self.radius)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<2> {
        let radius = self.radius * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(Vector(self.half_extents), radius);
        Promise::exact_convex(Some(bounds), OPERATIONS, radius)
    }
}

primitive! {
    Parallelogram, parallelogram, 2,
    about: "A parallelogram, two of its edges along x.",
    origin: "centred; two edges along x",
    parameters: {
        width: Length = "the length of the top and of the bottom",
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_extents[1],
        skew: Coordinate = "how much further right the top is than the bottom",
    },
    marks: |kernel| {
        let [w, h, s] = [kernel.width, kernel.height(), kernel.skew].map(|length| 0.5 * length);
        vec![
            Mark::length_between("width", at(-w - s, -h), at(w - s, -h)).below(),
            Mark::length_between("height", at(-w - s, -h), at(s - w, h)).left(),
            Mark::length_between("skew", at(w - s, -h), at(w + s, h)).above(),
        ]
    },
    example: (1.1, 0.9, 0.5),
}

/// A trapezoid about the y axis, centred at half its height. Exact.
///
/// # Derivation
///
/// Fold to `x ≥ 0`. Inside, the nearest of the lines of the side, the top and the
/// bottom decides. Outside it is the distance to the side, or to the top or bottom,
/// whichever is on the point's half.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::IsoscelesTrapezoid};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let bucket = Shape::from_kernel(IsoscelesTrapezoid::new(8.0, 2.0, 4.0)?);
/// assert_eq!(bucket.distance(Vector([0.0, 3.0])), 1.0); // above
/// assert_eq!(bucket.distance(Vector([-7.0, -6.0])), 5.0); // from the corner (−4, −2)
/// assert_eq!(bucket.distance(Vector([0.0, -1.0])), -1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct IsoscelesTrapezoid {
    bottom: f64,
    top: f64,
    half_height: f64,
    side: Edge,
}

impl IsoscelesTrapezoid {
    /// A trapezoid with the given full widths at the bottom and top and full
    /// `height` [m].
    ///
    /// # Errors
    ///
    /// If the height is not positive, a width is negative, or both are zero.
    pub fn new(bottom_width: f64, top_width: f64, height: f64) -> Result<Self, ShapeError> {
        let bottom = 0.5 * not_negative("bottom_width", bottom_width, Unit::Metre)?;
        let top = 0.5 * not_negative("top_width", top_width, Unit::Metre)?;
        let half_height = 0.5 * positive("height", height, Unit::Metre)?;
        positive("bottom_width or top_width", bottom_width.max(top_width), Unit::Metre)?;
        // Counter-clockwise: outside is to the right.
        let side = Edge::new(Vector([bottom, -half_height]), Vector([top, half_height]));
        Ok(Self { bottom, top, half_height, side })
    }

    fn size(&self) -> f64 {
        self.bottom.max(self.top) + self.half_height
    }
}

impl Kernel<2> for IsoscelesTrapezoid {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let (x, y) = (p.0[0].abs(), p.0[1]);
        let cap = y.abs() - S::constant(self.half_height);
        let [bottom, top] = [self.bottom, self.top].map(S::constant);
        let past_cap = (x - S::select_less(y, zero, bottom, top)).max(zero);
        let side = self.side.offsets(Vector([x, y]));
        let corners = S::norm([cap, past_cap]).min(S::norm(side));
        let pieces = beside(cap, past_cap, beside(side[0], side[1], corners));
        intersection(side[0].max(cap), pieces, self.size())
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.size())
    }

    fn promise(&self) -> Promise<2> {
        let (h, widest) = (self.half_height, self.bottom.max(self.top));
        // The centre from which the corners at the top and bottom are equally far,
        // if it lies between them.
        let apart = (self.top - self.bottom) * (self.top + self.bottom);
        let centre = (apart / (4.0 * h)).clamp(-h, h);
        let radius = self.bottom.hypot(h + centre).max(self.top.hypot(h - centre));
        let bounds = bounds_about(Aabb::centred(Vector([widest, h])), centre, radius);
        Promise {
            symmetric: [true, self.bottom == self.top],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, self.size())
        }
    }
}

primitive! {
    IsoscelesTrapezoid, isosceles_trapezoid, 2,
    about: "A trapezoid about the y axis.",
    origin: "centred, at half its height; a flat side down",
    parameters: {
        bottom_width: LengthOrZero = "the full width at the bottom"
            => |kernel| 2.0 * kernel.bottom,
        top_width: LengthOrZero = "the full width at the top" => |kernel| 2.0 * kernel.top,
        height: Length = "the full height" => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| {
        let (height, bottom, top) =
            (kernel.height(), 0.5 * kernel.bottom_width(), 0.5 * kernel.top_width());
        let y = 0.5 * height;
        vec![
            Mark::width("bottom_width", bottom, -y),
            Mark::length_between("top_width", at(-top, y), at(top, y)).above(),
            Mark::height(height, bottom, top),
        ]
    },
    example: (1.6, 0.7, 0.9),
}

/// A triangle about the y axis, its tip up, centred at half its height. Exact.
///
/// An [`IsoscelesTrapezoid`] whose top has no width.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::IsoscelesTriangle};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let roof = Shape::from_kernel(IsoscelesTriangle::new(6.0, 4.0)?);
/// assert_eq!(roof.distance(Vector([0.0, 5.0])), 3.0); // above the tip
/// assert_eq!(roof.distance(Vector([0.0, -3.0])), 1.0); // below the base
/// assert!((roof.distance(Vector([4.0, 3.0])) - 3.8).abs() < 1e-15); // beside
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct IsoscelesTriangle(IsoscelesTrapezoid);

impl IsoscelesTriangle {
    /// A triangle with the given `base` and full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(base: f64, height: f64) -> Result<Self, ShapeError> {
        let base = positive("base", base, Unit::Metre)?;
        Ok(Self(IsoscelesTrapezoid::new(base, 0.0, height)?))
    }
}

answered_by_inner!(IsoscelesTriangle.0, IsoscelesTrapezoid, 2);

primitive! {
    IsoscelesTriangle, isosceles_triangle, 2,
    about: "A triangle about the y axis, its tip up.",
    origin: "centred, at half its height; a tip up, a flat side down",
    parameters: {
        base: Length = "the length of the base" => |kernel| kernel.0.bottom_width(),
        height: Length = "the full height" => |kernel| kernel.0.height(),
    },
    marks: |kernel| sets::arch("base", kernel.base(), kernel.height()),
    example: (1.1, 1.3),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, corners_of};

    impl Evidence<2> for Rhombus {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.06] }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Rhombus", "`size`: the full diagonals", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let [x, y] = (self.size() * 0.5).0;
            corners_of(&[[x, 0.0], [0.0, y], [-x, 0.0], [0.0, -y]])
        }
    }

    impl Evidence<2> for Parallelogram {
        const SAMPLE: &'static str = r#"{ "width": 0.07, "height": 0.06, "skew": 0.03 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Parallelogram", "`width`, `height`, `skew`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let (w, h, s) = (0.5 * self.width(), 0.5 * self.height(), 0.5 * self.skew());
            corners_of(&[[w - s, -h], [w + s, h], [s - w, h], [-w - s, -h]])
        }
    }

    impl Evidence<2> for IsoscelesTrapezoid {
        const SAMPLE: &'static str =
            r#"{ "bottom_width": 0.1, "top_width": 0.05, "height": 0.07 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Isosceles Trapezoid",
            "`bottom_width`, `top_width`, `height`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<2> {
            let (bottom, top, half) =
                (0.5 * self.bottom_width(), 0.5 * self.top_width(), 0.5 * self.height());
            corners_of(&[[bottom, -half], [top, half], [-top, half], [-bottom, -half]])
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.0, 0.0, 1.0)]
        }
    }

    impl Evidence<2> for IsoscelesTriangle {
        const SAMPLE: &'static str = r#"{ "base": 0.08, "height": 0.1 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Isosceles Triangle", "`base`, `height`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let (foot, half) = (0.5 * self.base(), 0.5 * self.height());
            corners_of(&[[foot, -half], [0.0, half], [-foot, -half]])
        }
    }
}
