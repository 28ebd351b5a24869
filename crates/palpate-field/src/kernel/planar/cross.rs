// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two crossed bars: upright with square ends, diagonal with round ends.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at, diagonal};
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distances.
const OPERATIONS: f64 = 6.0;

/// A point folded to `x ≥ y ≥ 0`: by the axes and the diagonal.
#[inline(always)]
fn fold<S: Scalar>(p: Vector<S, 2>) -> [S; 2] {
    let [x, y] = p.abs().0;
    // On the diagonal both take their first operand.
    [x.max(y), y.min(x)]
}

/// A bar along x and one along y, crossed at the origin. Exact.
///
/// # Derivation
///
/// Fold to `x ≥ y ≥ 0`. The outline there is the end `x = l` below `y = w` and the side `y = w`
/// from the inner corner (w, w) to the end. Where x is past the inner corner, as it is for
/// every point outside, the distance is that of the quarter-plane of these two lines. Before
/// it, in the square where the bars cross, the nearest point is on the end or is the inner
/// corner.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cross};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let plus = Shape::from_kernel(Cross::new(8.0, 2.0)?);
/// assert_eq!(plus.distance(Vector([-3.0, 2.5])), 1.5); // above an arm
/// assert_eq!(plus.distance(Vector([4.0, 7.0])), 3.0_f64.hypot(3.0)); // past an end
/// assert_eq!(plus.distance(Vector([0.0, 0.0])), -2.0_f64.sqrt()); // inner corners
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Cross {
    half_length: f64,
    half_width: f64,
}

impl Cross {
    /// A cross of two bars of full `length` and `width` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive, or the width not less than the length.
    pub fn new(length: f64, width: f64) -> Result<Self, ShapeError> {
        positive("length", length, Unit::Metre)?;
        positive("width", width, Unit::Metre)?;
        if width >= length {
            let rule = format!("less than the length, {length} m");
            return Err(ShapeError::number("width", rule, width, Unit::Metre));
        }
        Ok(Self { half_length: 0.5 * length, half_width: 0.5 * width })
    }
}

impl Kernel<2> for Cross {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let [x, y] = fold(p);
        let half_width = S::constant(self.half_width);
        let (end, side) = (x - S::constant(self.half_length), y - half_width);
        let to_corner = S::norm([x - half_width, side]);
        S::select_less(x, half_width, end.max(-to_corner), S::orthant([end, side]))
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.half_length + self.half_width })
    }

    fn promise(&self) -> Promise<2> {
        let radius = self.half_length.hypot(self.half_width) * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(Vector::constant(self.half_length), radius);
        Promise::exact(Some(bounds), OPERATIONS, radius).symmetric()
    }
}

primitive! {
    Cross, cross, 2,
    about: "A bar along x and one along y, crossed at the origin.",
    origin: "centred; bars along the axes",
    parameters: {
        length: Length = "the full length of a bar" => |kernel| 2.0 * kernel.half_length,
        width: Length = "the full width of a bar" => |kernel| 2.0 * kernel.half_width,
    },
    marks: |kernel| {
        let (length, width) = (0.5 * kernel.length(), 0.5 * kernel.width());
        vec![
            Mark::length_between("length", at(-length, width), at(length, width)).above(),
            Mark::width("width", width, -length),
        ]
    },
    example: (1.7, 0.5),
}

/// Two crossed diagonal strokes with round ends. Exact.
///
/// # Derivation
///
/// Fold to `x ≥ y ≥ 0`, and let `u` run along the stroke there and `v ≥ 0` across it. The
/// outline is that of the stroke, a capsule along `u` up to `l`, from the inner corner on. At
/// the inner corner it meets `y = 0`, which is the line `u = v`: on the straight side at
/// `u = v = r`. If the strokes are so short that `l < r`, it is on the round end, where
/// `(u − l)² + u² = r²`, so `2u = l + √(2r² − l²)`.
///
/// The distance is that of the capsule where its nearest point is on the outline.
/// Else, before the outline's normal at the inner corner, which is a point inside,
/// the corner is nearest.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundedX};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let x = Shape::from_kernel(RoundedX::new(8.0, 1.0)?);
/// assert!((x.distance(Vector([6.0, 7.0])) - 4.0).abs() < 1e-14); // from the end (3, 3)
/// let root = 2.0_f64.sqrt();
/// assert!((x.distance(Vector([0.0, 0.0])) + root).abs() < 1e-15); // inner corners
/// assert!((x.distance(Vector([0.0, 2.0 * root])) - 1.0).abs() < 1e-14); // a side
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundedX {
    size: f64,
    radius: f64,
    /// How far the stroke's axis goes along `u`.
    length: f64,
    /// The inner corner's `u` and `v`.
    corner: f64,
    /// The outline's normal there, a line: before it are the points whose
    /// `weights·(u, v)` is less than `offset`.
    weights: [f64; 2],
    offset: f64,
}

impl RoundedX {
    /// Two strokes of `radius` that together are `size` wide and high [m].
    ///
    /// # Errors
    ///
    /// If either is not positive, or the size less than twice the radius.
    pub fn new(size: f64, radius: f64) -> Result<Self, ShapeError> {
        positive("size", size, Unit::Metre)?;
        positive("radius", radius, Unit::Metre)?;
        if size < 2.0 * radius {
            let rule = format!("at least twice the radius, {} m", 2.0 * radius);
            return Err(ShapeError::number("size", rule, size, Unit::Metre));
        }
        let length = (0.5 * size - radius) * std::f64::consts::SQRT_2;
        if length >= radius {
            let (corner, weights) = (radius, [1.0, 0.0]);
            return Ok(Self { size, radius, length, corner, weights, offset: corner });
        }
        // As a product, so that no square overflows.
        let root = (std::f64::consts::SQRT_2 * radius - length).sqrt()
            * (std::f64::consts::SQRT_2 * radius + length).sqrt();
        let corner = 0.5 * (length + root);
        let weights = [corner / radius, (length - corner) / radius];
        Ok(Self { size, radius, length, corner, weights, offset: weights[0] * length })
    }
}

impl Kernel<2> for RoundedX {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;
        let [x, y] = fold(p);
        let stroke = Vector([(x + y).scale(HALF_ROOT), (x - y).scale(HALF_ROOT)]);
        let [u, v] = stroke.0;
        let length = S::constant(self.length);
        // Beside the stroke `v` itself, which has a gradient on the stroke's axis too.
        let to_axis = S::select_less(u, length, v, S::norm([u - length, v]));
        let capsule = to_axis - S::constant(self.radius);
        let corner = S::constant(self.corner);
        let to_corner = S::norm([u - corner, v - corner]);
        let before = stroke.dot_constant(&self.weights);
        // Rounding must not take a point outside for one before the normal.
        let inside = S::select_less(before, S::constant(self.offset), -to_corner, capsule);
        S::select_less(capsule, S::constant(0.0), inside, capsule)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.length + self.radius })
    }

    fn promise(&self) -> Promise<2> {
        let half = self.length * std::f64::consts::FRAC_1_SQRT_2 + self.radius;
        let half = half * (1.0 + 4.0 * f64::EPSILON);
        let radius = self.length + self.radius;
        let bounds = Bounds::centred(Vector::constant(half), radius);
        Promise::exact(Some(bounds), OPERATIONS, radius).symmetric()
    }
}

primitive! {
    RoundedX, rounded_x, 2,
    about: "Two crossed diagonal strokes with round ends.",
    origin: "centred; strokes along the diagonals",
    parameters: {
        size: Length = "the full width and height",
        radius: Length = "half the width of a stroke",
    },
    marks: |kernel| {
        let (half, radius) = (0.5 * kernel.size(), kernel.radius());
        let end = half - radius;
        vec![
            Mark::width("size", half, -end),
            Mark::length_between("radius", at(end, end), at(end, end) + diagonal() * radius),
        ]
    },
    example: (1.7, 0.22),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4};

    use super::*;
    use crate::oracle::{
        AXES, Definition, Evidence, Patch, Row, both_sides, corners_of, from_segment, line,
    };

    impl Evidence<2> for Cross {
        const SAMPLE: &'static str = r#"{ "length": 0.1, "width": 0.03 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Cross", "`length`, `width`", "exact, inside too")];

        fn definition(&self) -> Definition<2> {
            let (l, w) = (0.5 * self.length(), 0.5 * self.width());
            corners_of(&[
                [l, w],
                [w, w],
                [w, l],
                [-w, l],
                [-w, w],
                [-l, w],
                [-l, -w],
                [-w, -w],
                [-w, -l],
                [w, -l],
                [w, -w],
                [l, -w],
            ])
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.5)]
        }
    }

    impl Evidence<2> for RoundedX {
        const SAMPLE: &'static str = r#"{ "size": 0.1, "radius": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Rounded X", "`size`, `radius`", "exact")];

        fn definition(&self) -> Definition<2> {
            rounded_x(self.size(), self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.3)]
        }
    }

    fn rounded_x(size: f64, r: f64) -> Definition<2> {
        let end = 0.5 * size - r;
        let straight = end >= r * FRAC_1_SQRT_2;
        // A half turn about the diagonal, extended to where the arc crosses the axes.
        let reach = if straight { FRAC_PI_4 } else { (end / r).asin() };
        let from = if straight { -FRAC_PI_4 } else { -reach };
        let to = FRAC_PI_2 - from;
        let mut right = Vec::new();
        for sign in [1.0, -1.0] {
            let up = Vector([0.0, sign]);
            right.push(Patch::arc(Vector([end, sign * end]), [AXES[0], up], r, [from, to]));
            if straight {
                let s = r * FRAC_1_SQRT_2;
                let inner = r / FRAC_1_SQRT_2;
                right.push(line([inner, 0.0], [end + s, sign * (end - s)]));
                right.push(line([0.0, sign * inner], [end - s, sign * (end + s)]));
            }
        }
        both_sides(right, move |p| {
            let stroke = |y: f64| from_segment(Vector([-end, -y]), Vector([end, y]), p) < r;
            stroke(end) || stroke(-end)
        })
    }
}
