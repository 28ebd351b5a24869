// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rectangles: with rounded corners, with cut corners, between two points.

use super::outline::frame_between;
use std::f64::consts::FRAC_1_SQRT_2;

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, at, sets};
use crate::kernel::profile::{beside, intersection};
use crate::kernel::{Cuboid, Kernel, primitive, tangent_model};
use crate::pose::Placement;
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector, array};

/// The signs of x and y at the top left, top right, bottom right and bottom left.
const CORNERS: [[f64; 2]; 4] = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];

/// A rectangle along the axes, each corner rounded inwards with a radius of its
/// own. Exact.
///
/// # Derivation
///
/// One corner, with its two faces extended without end, is an orthant grown by the corner's
/// radius, whose distance is known. The shape is the intersection of the four corners, so none
/// of their distances exceeds the shape's, and inside the largest equals it. Outside, the
/// nearest point lies on a face or an arc, and the corner that has this face or arc gives the
/// distance, again the largest.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundedRectangle};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let leaf = RoundedRectangle::new(Vector([4.0, 2.0]), 1.0, 0.0, 1.0, 0.0)?;
/// let leaf = Shape::from_kernel(leaf);
/// assert_eq!(leaf.distance(Vector([5.0, 5.0])), 5.0); // past a sharp corner: 3-4-5
/// assert_eq!(leaf.distance(Vector([-4.0, 4.0])), 4.0); // √(3² + 4²) − 1
/// assert_eq!(leaf.distance(Vector([0.0, 0.0])), -1.0); // the nearest face
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundedRectangle {
    half_extents: [f64; 2],
    /// In the order of [`CORNERS`].
    radii: [f64; 4],
}

impl RoundedRectangle {
    /// A rectangle with the given edge lengths and radii of its corners [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, a radius is negative, or the two radii at an
    /// edge are together longer than it.
    pub fn new(
        size: Vector<f64, 2>,
        top_left_radius: f64,
        top_right_radius: f64,
        bottom_right_radius: f64,
        bottom_left_radius: f64,
    ) -> Result<Self, ShapeError> {
        for length in size.0 {
            positive("size", length, Unit::Metre)?;
        }
        let corners = [
            ("top_left_radius", top_left_radius),
            ("top_right_radius", top_right_radius),
            ("bottom_right_radius", bottom_right_radius),
            ("bottom_left_radius", bottom_left_radius),
        ];
        for (name, radius) in corners {
            not_negative(name, radius, Unit::Metre)?;
        }
        for (i, (name, radius)) in corners.into_iter().enumerate() {
            // The edges from the corner before, across or along in turn.
            let (before, other) = corners[(i + 3) % 4];
            let edge = size[(i + 1) % 2];
            if radius > edge - other {
                let rule =
                    format!("at most what {before} leaves of the edge, {} m", edge - other);
                return Err(ShapeError::number(name, rule, radius, Unit::Metre));
            }
        }
        let half_extents = size.0.map(|length| 0.5 * length);
        Ok(Self { half_extents, radii: corners.map(|(_, radius)| radius) })
    }
}

impl Kernel<2> for RoundedRectangle {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let corners: [S; 4] = array!(i < 4 => {
            let radius = self.radii[i];
            let [x, y] = self.half_extents;
            let right = p.0[0].scale(CORNERS[i][0]) - S::constant(x - radius);
            let up = p.0[1].scale(CORNERS[i][1]) - S::constant(y - radius);
            S::orthant([right, up]) - S::constant(radius)
        });
        corners[0].max(corners[1]).max(corners[2]).max(corners[3])
    }

    fn promise(&self) -> Promise<2> {
        let half = Vector(self.half_extents);
        let reach = |radius: f64| (half - Vector::constant(radius)).norm() + radius;
        let radius = self.radii.iter().fold(0.0_f64, |m, r| m.max(reach(*r)));
        let bounds = Bounds::centred(half, radius * (1.0 + 4.0 * f64::EPSILON));
        let [a, b, c, d] = self.radii;
        Promise {
            symmetric: [a == b && c == d, a == d && b == c],
            ..Promise::exact_convex(Some(bounds), 6.0, half.norm())
        }
    }
}

primitive! {
    RoundedRectangle, rounded_rectangle, 2,
    about: "A rectangle along the axes, each corner rounded inwards with its own radius.",
    origin: "centred; edges along the axes",
    parameters: {
        size: Vector = "the edge lengths before rounding"
            => |kernel| Vector(kernel.half_extents) * 2.0,
        top_left_radius: LengthOrZero = "the radius at the top left"
            => |kernel| kernel.radii[0],
        top_right_radius: LengthOrZero = "the radius at the top right"
            => |kernel| kernel.radii[1],
        bottom_right_radius: LengthOrZero = "the radius at the bottom right"
            => |kernel| kernel.radii[2],
        bottom_left_radius: LengthOrZero = "the radius at the bottom left"
            => |kernel| kernel.radii[3],
    },
    marks: |kernel| {
        let size = kernel.size();
        let radius = |name, [right, up]: [f64; 2], radius: f64| {
            let out = Vector([right, up]);
            let half = size * 0.5 - Vector([radius; 2]);
            let centre = Vector([right * half[0], up * half[1]]);
            Mark::length_between(name, centre, centre + out * (FRAC_1_SQRT_2 * radius))
        };
        let ([top_left, _, bottom_right, bottom_left], [x, y]) =
            (kernel.radii, kernel.half_extents);
        let width = [at(-x, bottom_left - y), at(x, bottom_right - y)];
        let height = [at(bottom_left - x, -y), at(top_left - x, y)];
        vec![
            Mark::length_between("size", width[0], width[1]).of(0).below(),
            Mark::length_between("size", height[0], height[1]).of(1).left(),
            radius("top_left_radius", [-1.0, 1.0], kernel.top_left_radius()),
            radius("top_right_radius", [1.0, 1.0], kernel.top_right_radius()),
            radius("bottom_right_radius", [1.0, -1.0], kernel.bottom_right_radius()),
            radius("bottom_left_radius", [-1.0, -1.0], kernel.bottom_left_radius()),
        ]
    },
    example: (Vector([1.6, 1.0]), 0.6, 0.2, 0.0, 0.35),
}

/// The largest number of rounded operations of the distance of a chamfered rectangle.
const CHAMFERED_OPERATIONS: f64 = 6.0;

/// A rectangle along the axes with its corners cut off at 45°. Exact.
///
/// # Derivation
///
/// Fold to `x, y ≥ 0`; `q = |p| − half` is measured from the corner that was cut
/// off. The larger of the two is `a`, the smaller `b`: this folds along the
/// corner's diagonal, which keeps distances to the cut. What remains of the outline
/// there is the face `a = 0` as far as `b = −c`, and half of the cut, the line
/// `a + b = −c` from there to `a = b`.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::ChamferedRectangle};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let tray = Shape::from_kernel(ChamferedRectangle::new(Vector([6.0, 4.0]), 1.0)?);
/// assert_eq!(tray.distance(Vector([7.0, 4.0])), 5.0); // from the corner (3, 1)
/// assert_eq!(tray.distance(Vector([0.0, 0.0])), -2.0);
/// assert!((tray.distance(Vector([3.0, 2.0])) - 0.5_f64.sqrt()).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ChamferedRectangle {
    half_extents: [f64; 2],
    chamfer: f64,
}

impl ChamferedRectangle {
    /// A rectangle with the given edge lengths, cut off `chamfer` from each corner along both
    /// edges [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the chamfer is negative or more than half
    /// the shortest length.
    pub fn new(size: Vector<f64, 2>, chamfer: f64) -> Result<Self, ShapeError> {
        for length in size.0 {
            positive("size", length, Unit::Metre)?;
        }
        let half_extents = size.0.map(|length| 0.5 * length);
        let shortest = half_extents[0].min(half_extents[1]);
        not_negative("chamfer", chamfer, Unit::Metre)?;
        if chamfer > shortest {
            let rule = format!("at most half the shortest edge, {shortest} m");
            return Err(ShapeError::number("chamfer", rule, chamfer, Unit::Metre));
        }
        Ok(Self { half_extents, chamfer })
    }

    fn radius(&self) -> f64 {
        let [x, y] = self.half_extents;
        (x - self.chamfer).hypot(y).max(x.hypot(y - self.chamfer))
    }
}

impl Kernel<2> for ChamferedRectangle {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;
        let q = p.abs() - Vector::of(&self.half_extents);
        // On the diagonal both take their first operand.
        let (a, b) = (q.0[0].max(q.0[1]), q.0[1].min(q.0[0]));
        let past_face = b + S::constant(self.chamfer);
        let corner = S::norm([a, past_face]);
        let cut = (a + past_face).scale(HALF_ROOT);
        let by_cut = beside(cut, a - past_face, corner);
        intersection(a.max(cut), beside(a, past_face, by_cut), self.radius())
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, CHAMFERED_OPERATIONS, self.radius())
    }

    fn promise(&self) -> Promise<2> {
        let radius = self.radius() * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(Vector(self.half_extents), radius);
        Promise::exact_convex(Some(bounds), CHAMFERED_OPERATIONS, radius).symmetric()
    }
}

primitive! {
    ChamferedRectangle, chamfered_rectangle, 2,
    about: "A rectangle along the axes with its corners cut off at 45°.",
    origin: "centred; edges along the axes",
    parameters: {
        size: Vector = "the edge lengths before cutting"
            => |kernel| Vector(kernel.half_extents) * 2.0,
        chamfer: LengthOrZero = "what a cut takes from each edge",
    },
    marks: |kernel| {
        let (size, chamfer) = (kernel.size(), kernel.chamfer());
        let [x, y] = [0.5 * size[0], 0.5 * size[1]];
        let mut marks = Mark::edges(size, chamfer);
        let cut = Mark::length_between("chamfer", at(x - chamfer, y), at(x, y - chamfer));
        marks.push(cut.above());
        marks
    },
    example: (Vector([1.6, 1.1]), 0.35),
}

/// The rectangle around the line between two points, which are the middles of its
/// ends. Exact.
///
/// A [`Cuboid`] along the line between the points.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::OrientedRectangle};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let plank = OrientedRectangle::new(Vector([1.0, 0.0]), Vector([4.0, 4.0]), 2.0)?;
/// let plank = Shape::from_kernel(plank);
/// assert!((plank.distance(Vector([2.5, 2.0])) + 1.0).abs() < 1e-15); // its centre
/// assert!((plank.distance(Vector([7.0, 8.0])) - 5.0).abs() < 1e-15); // past `to`
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct OrientedRectangle {
    from: Point<2>,
    to: Point<2>,
    rectangle: Cuboid<2>,
    placement: Placement<2>,
}

impl OrientedRectangle {
    /// A rectangle from the middle of one end to that of the other, of full
    /// `width` across [m].
    ///
    /// # Errors
    ///
    /// If the points are the same, a coordinate is not finite or the width not
    /// positive.
    pub fn new(from: Point<2>, to: Point<2>, width: f64) -> Result<Self, ShapeError> {
        positive("width", width, Unit::Metre)?;
        let (placement, half_length) = frame_between(from, to)?;
        let rectangle = Cuboid::new(Vector([width, 2.0 * half_length]))?;
        Ok(Self { from, to, rectangle, placement })
    }
}

impl Kernel<2> for OrientedRectangle {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.rectangle.distance(self.placement.to_body(p))
    }

    fn promise(&self) -> Promise<2> {
        self.rectangle.promise().placed(&self.placement.world_from_body)
    }
}

primitive! {
    OrientedRectangle, oriented_rectangle, 2,
    about: "The rectangle around the line between two points.",
    origin: "given by its points",
    parameters: {
        from: Vector = "the middle of one end",
        to: Vector = "the middle of the other end",
        width: Length = "the full width across" => |kernel| kernel.rectangle.size()[0],
    },
    marks: |kernel| sets::between(kernel.from(), kernel.to(), kernel.width()),
    example: (Vector([-0.7, -0.5]), Vector([0.6, 0.4]), 0.5),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, arc, corners_of, polygon};

    impl Evidence<2> for RoundedRectangle {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.08], "top_left_radius": 0, "top_right_radius": 0.01,
             "bottom_right_radius": 0.02, "bottom_left_radius": 0.04 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Rounded Box",
            "`size`, and a radius for each corner; `rounded_cuboid` if all are equal",
            "exact",
        )];

        fn definition(&self) -> Definition<2> {
            rounded_rectangle(
                self.size(),
                [
                    self.top_left_radius(),
                    self.top_right_radius(),
                    self.bottom_right_radius(),
                    self.bottom_left_radius(),
                ],
            )
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(Vector([1.0, 0.5]), 0.1, -0.02, 0.1, 0.1),
                Self::new(Vector([1.0, 0.5]), 0.25, 0.1, 0.45, 0.1),
            ]
        }
    }

    impl Evidence<2> for ChamferedRectangle {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.07], "chamfer": 0.02 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Chamfer Box", "`size`, `chamfer`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let ([x, y], c) = ((self.size() * 0.5).0, self.chamfer());
            corners_of(&[
                [x, y - c],
                [x - c, y],
                [c - x, y],
                [-x, y - c],
                [-x, c - y],
                [c - x, -y],
                [x - c, -y],
                [x, c - y],
            ])
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 0.5]), 0.3)]
        }
    }

    impl Evidence<2> for OrientedRectangle {
        const SAMPLE: &'static str =
            r#"{ "from": [-0.03, -0.03], "to": [0.03, 0.03], "width": 0.03 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Oriented Box", "`from`, `to`, `width`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            oriented_rectangle(self.from(), self.to(), self.width())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(Vector([0.25, 0.5]), Vector([0.25, 0.5]), 0.1),
                Self::new(Vector([0.25, 0.5]), Vector([f64::NAN, 0.5]), 0.1),
            ]
        }
    }

    /// A rectangle with its corners cut by arcs: top left, top right, bottom right, bottom left.
    fn rounded_rectangle(size: Point<2>, radii: [f64; 4]) -> Definition<2> {
        let half = size * 0.5;
        let signs = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let centre = move |i: usize| {
            let [sx, sy] = signs[i];
            Vector([sx * (half[0] - radii[i]), sy * (half[1] - radii[i])])
        };
        let mut boundary = Vec::new();
        for (i, from) in [FRAC_PI_2, 0.0, -FRAC_PI_2, PI].into_iter().enumerate() {
            boundary.push(arc(centre(i).0, radii[i], [from, from + FRAC_PI_2]));
            let next = (i + 1) % 4;
            // The edge's normal is the mean of its corners' signs.
            let out = (Vector(signs[i]) + Vector(signs[next])) * 0.5;
            let ends = [i, next].map(|k| centre(k) + out * radii[k]);
            boundary.push(Patch::segment(ends[0], ends[1]));
        }
        Definition::new(boundary, move |p| {
            let in_corner = |i: usize| {
                let q = p - centre(i);
                q[0] * signs[i][0] > 0.0 && q[1] * signs[i][1] > 0.0
            };
            let cut = (0..4).any(|i| in_corner(i) && (p - centre(i)).norm() >= radii[i]);
            p[0].abs() < half[0] && p[1].abs() < half[1] && !cut
        })
    }

    fn oriented_rectangle(from: Point<2>, to: Point<2>, width: f64) -> Definition<2> {
        let along = (to - from).normalized().unwrap_or(Vector::unit(0));
        let across = Vector([-along[1], along[0]]) * (0.5 * width);
        polygon(vec![vec![from - across, to - across, to + across, from + across]])
    }
}
