// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Regular polygons and stars.

use super::line::Edge;
use std::f64::consts::PI;

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at, turned};
use crate::kernel::{Evaluations, Kernel, face_if_on_it, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Vector, array};

/// The most corners or branches.
const MOST_BRANCHES: u32 = 256;

/// Reflections that fold [`MOST_BRANCHES`] branches into half of one, not counting the first,
/// which folds left onto right.
const FOLDS: usize = 8;

/// The largest number of rounded operations of the distance of a polygon. Few of the
/// reflections move a point, so few round.
const POLYGON_OPERATIONS: f64 = 18.0;

/// The same for a star, whose thin tips are far from their middle.
const STAR_OPERATIONS: f64 = 40.0;

/// The symmetries of a regular polygon, as reflections that fold the plane onto
/// the wedge between the +y axis and the angle π/n from it.
///
/// # Derivation
///
/// Every line at a multiple of π/n from the y axis is a mirror. Fold left onto right: the wedge
/// is n times π/n wide. The mirror in the middle of a wedge that is m times π/n wide folds the
/// wedge onto ⌈m/2⌉ times π/n, so ⌈log₂ n⌉ reflections suffice. They need no inverse function,
/// hold for odd n, and have no singular centre.
#[derive(Clone, Debug)]
struct Fold {
    /// Normals of the mirrors, pointing out of the kept part; zero for unused mirrors.
    mirrors: [[f64; 2]; FOLDS],
    /// Sine and cosine of π/n.
    half_branch: [f64; 2],
}

impl Fold {
    fn new(branches: u32) -> Self {
        let angle = |m: u32| std::f64::consts::PI * f64::from(m) / f64::from(branches);
        let mut mirrors = [[0.0; 2]; FOLDS];
        let mut width = branches;
        for mirror in &mut mirrors {
            if width > 1 {
                width = width.div_ceil(2);
                *mirror = [libm::cos(angle(width)), -libm::sin(angle(width))];
            }
        }
        Self { mirrors, half_branch: [libm::sin(angle(1)), libm::cos(angle(1))] }
    }

    #[inline(always)]
    fn apply<S: Scalar>(&self, p: Vector<S, 2>) -> Vector<S, 2> {
        let mut q = Vector([p.0[0].abs(), p.0[1]]);
        for mirror in &self.mirrors {
            let beyond = q.dot_constant(mirror).max(S::constant(0.0)).scale(2.0);
            q = Vector(array!(i < 2 => q.0[i] - beyond.scale(mirror[i])));
        }
        q
    }
}

fn check_branches(parameter: &'static str, count: u32) -> Result<u32, ShapeError> {
    if (3..=MOST_BRANCHES).contains(&count) {
        return Ok(count);
    }
    let rule = format!("from 3 to {MOST_BRANCHES}");
    Err(ShapeError::number(parameter, rule, f64::from(count), Unit::One))
}

/// A regular polygon about the origin, one corner on the +y axis. Exact.
///
/// In the folded wedge there is one edge, from the corner on the y axis to its
/// middle. With `s` the offset from the edge's line and `t` the place along it from
/// the corner, the distance is `s` beside the edge and `‖(s, t)‖` past the corner.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RegularPolygon};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let square = Shape::from_kernel(RegularPolygon::new(4, 2.0)?);
/// assert!((square.distance(Vector([0.0, -5.0])) - 3.0).abs() < 1e-15); // corner
/// assert!((square.distance(Vector([2.0, 2.0])) - 2.0_f64.sqrt()).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RegularPolygon {
    fold: Fold,
    sides: u32,
    radius: f64,
}

impl RegularPolygon {
    /// A polygon with `sides` corners at `radius` from the centre [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or there are not 3 to 256 sides.
    pub fn new(sides: u32, radius: f64) -> Result<Self, ShapeError> {
        let sides = check_branches("sides", sides)?;
        let radius = positive("radius", radius, Unit::Metre)?;
        Ok(Self { fold: Fold::new(sides), sides, radius })
    }
}

impl Kernel<2> for RegularPolygon {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let [sin, cos] = self.fold.half_branch;
        let q = self.fold.apply(p) - Vector::of(&[0.0, self.radius]);
        let out = q.dot_constant(&[sin, cos]);
        let along = q.dot_constant(&[cos, -sin]);
        let corner = face_if_on_it(S::norm([out, along]), out, self.radius);
        S::select_less(along, zero, corner, out)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, POLYGON_OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<2> {
        let bounds = Bounds::centred(Vector::constant(self.radius), self.radius);
        Promise {
            symmetric: [true, self.sides.is_multiple_of(2)],
            ..Promise::exact_convex(Some(bounds), POLYGON_OPERATIONS, self.radius)
        }
    }
}

primitive! {
    RegularPolygon, regular_polygon, 2,
    about: "A regular polygon, one corner up.",
    origin: "at the centre of its circle; a tip up",
    parameters: {
        sides: Count = "how many sides, 3 to 256",
        radius: Length = "from the centre to a corner",
    },
    marks: |kernel| vec![Mark::from_origin("radius", at(0.0, kernel.radius()))],
    example: (5, 0.8),
}

/// A regular star about the origin, one tip on the +y axis. Exact.
///
/// In the folded wedge there is one edge, from the tip on the y axis to the
/// inner corner at the angle π/n.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RegularStar};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let star = Shape::from_kernel(RegularStar::new(5, 2.0, 1.0)?);
/// assert!((star.distance(Vector([0.0, 3.0])) - 1.0).abs() < 1e-15); // above a tip
/// // At the centre: the nearest points are the five inner corners.
/// assert!((star.distance(Vector([0.0, 0.0])) + 1.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RegularStar {
    fold: Fold,
    branches: u32,
    outer_radius: f64,
    inner_radius: f64,
    edge: Edge,
}

impl RegularStar {
    /// A star with tips at `outer_radius` and inner corners at `inner_radius`
    /// from the centre [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, the inner not less than the outer, or there
    /// are not 3 to 256 branches.
    pub fn new(
        branches: u32,
        outer_radius: f64,
        inner_radius: f64,
    ) -> Result<Self, ShapeError> {
        let branches = check_branches("branches", branches)?;
        let outer_radius = positive("outer_radius", outer_radius, Unit::Metre)?;
        positive("inner_radius", inner_radius, Unit::Metre)?;
        if inner_radius >= outer_radius {
            let rule = format!("less than the outer radius, {outer_radius} m");
            return Err(ShapeError::number("inner_radius", rule, inner_radius, Unit::Metre));
        }
        let fold = Fold::new(branches);
        // Counter-clockwise around the star: outside is to the right.
        let inner = Vector(fold.half_branch) * inner_radius;
        let edge = Edge::new(inner, Vector([0.0, outer_radius]));
        Ok(Self { fold, branches, outer_radius, inner_radius, edge })
    }

    /// The star of two triangles, with six tips at `radius` from the centre [m].
    ///
    /// A triangle's edges are `r/2` from the centre, and an inner corner lies on two
    /// of them, 30° from the middle of either: at `r/2 / cos 30° = r/√3`.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::RegularStar};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let star = Shape::from_kernel(RegularStar::hexagram(2.0)?);
    /// // On the base of the triangle whose tip is up, at y = −1.
    /// assert!((star.distance(Vector([1.0, -1.0]))).abs() < 1e-15);
    /// assert!((star.distance(Vector([0.0, -3.0])) - 1.0).abs() < 1e-15); // a tip
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn hexagram(radius: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        Self::new(6, radius, radius / 3.0_f64.sqrt())
    }

    /// The star drawn in five strokes, with five tips at `radius` from the centre [m].
    ///
    /// A stroke joins tips 144° apart, so it is `r cos 72°` from the centre, and an
    /// inner corner lies on two strokes, 36° from the middle of either: at
    /// `r cos 72° / cos 36° = r (3 − √5)/2`.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::RegularStar};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let star = Shape::from_kernel(RegularStar::pentagram(2.0)?);
    /// // On the stroke between the tips at the left and right, as high as they are.
    /// let height = 2.0 * 72.0_f64.to_radians().cos();
    /// assert!(star.distance(Vector([1.5, height])).abs() < 1e-15);
    /// assert!((star.distance(Vector([0.0, 3.0])) - 1.0).abs() < 1e-15); // a tip
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn pentagram(radius: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        Self::new(5, radius, radius * (0.5 * (3.0 - 5.0_f64.sqrt())))
    }
}

impl Kernel<2> for RegularStar {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.edge.signed_distance(self.fold.apply(p))
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: STAR_OPERATIONS, size: self.outer_radius })
    }

    fn promise(&self) -> Promise<2> {
        let bounds = Bounds::centred(Vector::constant(self.outer_radius), self.outer_radius);
        Promise {
            symmetric: [true, self.branches.is_multiple_of(2)],
            ..Promise::exact(Some(bounds), STAR_OPERATIONS, self.outer_radius)
        }
    }
}

primitive! {
    RegularStar, regular_star, 2,
    about: "A regular star, one tip up.",
    origin: "at the centre of its circle; a tip up",
    parameters: {
        branches: Count = "how many branches, 3 to 256",
        outer_radius: Length = "from the centre to a tip",
        inner_radius: Length = "from the centre to an inner corner",
    },
    marks: |kernel| {
        let inner = turned(PI / f64::from(kernel.branches()), kernel.inner_radius());
        vec![
            Mark::from_origin("outer_radius", at(0.0, kernel.outer_radius())),
            Mark::from_origin("inner_radius", inner),
        ]
    },
    example: (7, 0.9, 0.5),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, corners, polygon};

    impl Evidence<2> for RegularPolygon {
        const SAMPLE: &'static str = r#"{ "sides": 6, "radius": 0.05 }"#;
        const GUIDE: &'static [Row] = &[
            Row::new(
                "Equilateral Triangle",
                "`sides` 3; `radius` is to a corner",
                "exact, convex",
            ),
            Row::new("Regular Pentagon", "`sides` 5", "exact, convex"),
            Row::new("Regular Hexagon", "`sides` 6", "exact, convex"),
            Row::new("Regular Octogon", "`sides` 8", "exact, convex"),
        ];

        fn definition(&self) -> Definition<2> {
            polygon(vec![corners(f64::from(self.sides()), &[self.radius()])])
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(2, 1.0)]
        }
    }

    impl Evidence<2> for RegularStar {
        const SAMPLE: &'static str =
            r#"{ "branches": 5, "outer_radius": 0.05, "inner_radius": 0.02 }"#;
        const GUIDE: &'static [Row] = &[
            Row::new("Hexagram", "`branches` 6, `inner_radius` the outer over √3", "exact"),
            Row::new(
                "Pentagram",
                "`branches` 5, `inner_radius` the outer over 2.618 034, the square of the golden ratio",
                "exact",
            ),
            Row::new(
                "Regular Star",
                "`branches`, `outer_radius`, `inner_radius` in place of an angle",
                "exact",
            ),
        ];

        fn definition(&self) -> Definition<2> {
            polygon(vec![corners(
                f64::from(self.branches()),
                &[self.outer_radius(), self.inner_radius()],
            )])
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(1_000_000, 1.0, 0.5),
                Self::new(5, 1.0, 1.0),
                Self::hexagram(0.0),
                Self::pentagram(f64::NAN),
            ]
        }
    }
}
