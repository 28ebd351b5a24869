// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Flat sheets in space: triangles and quadrilaterals, thickened by a radius.

use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, finite, not_negative};
use crate::kernel::mark::sets;
use crate::kernel::planar::line::Edge;
use crate::kernel::{Kernel, face_if_on_it, primitive, tangent_model};
use crate::pose::Placement;
use crate::pose::{Pose, Rotation};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 12.0;

/// A point that is no farther from the line of its neighbours than this share of the size is
/// refused as a corner: the direction of the plane would be rounding.
const FLAT: f64 = 1e-9;

/// Four points count as in one plane if they are off by at most this share of their size, which
/// leaves room for coordinates with few digits.
const PLANAR: f64 = 1e-6;

/// All points within a radius of a flat convex polygon in space. Exact.
///
/// With a radius of zero it has no inside.
///
/// # Derivation
///
/// In a frame whose y axis is across the plane, the polygon is at `y = 0`, its edges in
/// `(x, z)`. Where `p` is above or below the polygon, behind the lines of all its edges, the
/// distance is `|y|`. Elsewhere it is the norm of `y` and the least distance to an edge in the
/// plane, which are at right angles.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Sheet};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]];
/// let sail = Sheet::<3>::new(corners.map(Vector).to_vec(), 0.5)?;
/// let sail = Shape::from_kernel(sail);
/// assert!((sail.distance(Vector([1.0, 2.0, 1.0])) - 1.5).abs() < 1e-15); // above
/// assert!((sail.distance(Vector([1.0, 4.0, -3.0])) - 4.5).abs() < 1e-15); // past an edge
///
/// let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let plate = Shape::from_kernel(Sheet::<4>::new(corners.map(Vector).to_vec(), 0.0)?);
/// assert!((plate.distance(Vector([7.0, 6.0, 0.0])) - 5.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Sheet<const N: usize> {
    points: [Point<3>; N],
    edges: [Edge; N],
    placement: Placement<3>,
    radius: f64,
    bounds: Bounds<3>,
    /// The largest distance of a point from the origin [m].
    size: f64,
}

impl Sheet<3> {
    /// The triangle of three points [m], in any order, with a `radius` [m].
    ///
    /// # Errors
    ///
    /// If there are not three points, a coordinate is not finite, they are on a line,
    /// or the radius is negative.
    pub fn new(points: Vec<Point<3>>, radius: f64) -> Result<Self, ShapeError> {
        let points: [_; 3] = checked(points)?;
        let length = |i: usize| (points[(i + 1) % 3] - points[i]).norm();
        // Over the longest edge, the height has the least relative error.
        let longest = (1..3).fold(0, |best, i| if length(i) > length(best) { i } else { best });
        let corners = std::array::from_fn(|i| points[(longest + i) % 3]);
        let [from, to, top] = corners;
        let basis = basis(to - from, top - from).map_err(|height| {
            let rule = "the corners of a triangle with heights of at least 1e-9 of its size";
            ShapeError::number("points", rule, height, Unit::Metre)
        })?;
        Ok(Self { points, ..Self::in_plane(corners, basis, radius)? })
    }
}

impl Sheet<4> {
    /// The convex quadrilateral of four points in a plane [m], in their order around
    /// it, with a `radius` [m].
    ///
    /// Points that are off the plane by no more than a millionth of their size are
    /// moved into it.
    ///
    /// # Errors
    ///
    /// If there are not four points, a coordinate is not finite, they are not in one
    /// plane, one is not a corner of their convex hull or they are not in order, or the
    /// radius is negative.
    pub fn new(points: Vec<Point<3>>, radius: f64) -> Result<Self, ShapeError> {
        let corners: [_; 4] = checked(points)?;
        let diagonals = [corners[2] - corners[0], corners[3] - corners[1]];
        let lengths = diagonals.map(|diagonal| diagonal.norm());
        // Counter-clockwise, the second diagonal points to the left of the first.
        let (longer, left) = if lengths[1] > lengths[0] {
            (diagonals[1], -diagonals[0])
        } else {
            (diagonals[0], diagonals[1])
        };
        let size = lengths[0].max(lengths[1]);
        let flat = |height: f64| {
            let rule = "the corners of a convex quadrilateral in order, each at least 1e-9 \
                        of its size outside the line of its neighbours";
            ShapeError::number("points", rule, height, Unit::Metre)
        };
        let basis = basis(longer, left).map_err(flat)?;
        let normal = basis[0].cross(basis[1]);
        let apart = normal.dot(corners[1] - corners[0]).abs();
        for i in 0..4 {
            let [before, corner, after] = [0, 1, 2].map(|k| corners[(i + k) % 4]);
            let line = (after - before).normalized().unwrap_or(basis[0]);
            let height = (corner - before).dot(line.cross(normal));
            if height <= FLAT * size {
                return Err(flat(height));
            }
        }
        if apart > PLANAR * size {
            let rule = "in one plane, with diagonals that pass each other at no more than a \
                        millionth of their length";
            return Err(ShapeError::number("points", rule, apart, Unit::Metre));
        }
        Self::in_plane(corners, basis, radius)
    }
}

impl<const N: usize> Sheet<N> {
    /// The polygon of `corners` moved into their middle plane, counter-clockwise in
    /// the orthonormal `basis`.
    fn in_plane(
        corners: [Point<3>; N],
        [along, across]: [Vector<f64, 3>; 2],
        radius: f64,
    ) -> Result<Self, ShapeError> {
        not_negative("radius", radius, Unit::Metre)?;
        let centre = corners.iter().fold(Vector::ZERO, |sum, c| sum + *c * (1.0 / N as f64));
        // y × x = −z: seen against y, from x to z is clockwise.
        let rows = [along, across.cross(along), across];
        let rotation = Rotation::from_matrix(rows.map(|row| row.0))?.inverse();
        let pose = Pose::new(rotation, centre);
        let flat = corners.map(|c| Vector([(c - centre).dot(along), (c - centre).dot(across)]));
        let edges = std::array::from_fn(|i| Edge::new(flat[i], flat[(i + 1) % N]));
        let moved = flat.map(|c| pose.transform_point(Vector([c[0], 0.0, c[1]])));
        let aabb = Aabb::around(moved).unwrap_or(Aabb { min: centre, max: centre });
        let middle = aabb.centre();
        let around = moved.iter().fold(0.0_f64, |m, c| m.max((*c - middle).norm()));
        let slack = 8.0 * f64::EPSILON * (middle.norm() + around);
        let ball = BoundingBall { centre: middle, radius: around + slack };
        let bounds = Bounds { aabb: aabb.grown(slack), ball }.grown(radius);
        let placement = Placement::new(pose);
        let size = bounds.radius_about_origin();
        Ok(Self { points: corners, edges, placement, radius, bounds, size })
    }
}

/// `N` points with finite coordinates.
fn checked<const N: usize>(points: Vec<Point<3>>) -> Result<[Point<3>; N], ShapeError> {
    let count = points.len();
    let points: [_; N] = points.try_into().map_err(|_| ShapeError::Count {
        parameter: "points".into(),
        rule: format!("exactly {N} points").into(),
        count,
    })?;
    for x in points.iter().flat_map(|p| p.0) {
        finite("points", x, Unit::Metre)?;
    }
    Ok(points)
}

/// Unit vectors along `first` and at right angles to it, on the side of `second`.
///
/// # Errors
///
/// The height of `second` over `first`, if it is less than [`FLAT`].
fn basis(first: Vector<f64, 3>, second: Vector<f64, 3>) -> Result<[Vector<f64, 3>; 2], f64> {
    let along = first.normalized().ok_or(0.0)?;
    let across = second - along * second.dot(along);
    let height = across.norm();
    if height <= FLAT * first.norm() {
        return Err(height);
    }
    // Orthogonalised twice, so that it is perpendicular for nearly parallel vectors too.
    let across = (across - along * across.dot(along)).normalized().ok_or(height)?;
    Ok([along, across])
}

impl<const N: usize> Kernel<3> for Sheet<N> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = self.placement.to_body(p).0;
        let q = Vector([x, z]);
        let zero = S::constant(0.0);
        // The nearest edge is chosen by its distance in the plane, since far above it a rounding of
        // the whole distance hides the distance in the plane, and with it the direction.
        // It is one of those that the point is not behind. Next to a corner two are as near to
        // within a rounding, but their directions differ: the one that the point is beside goes
        // first.
        let farther = 1.0 + 8.0 * S::epsilon();
        let of = |edge: &Edge| {
            let [across, past] = edge.offsets(q);
            let distance = S::norm([across, past]);
            let rank = S::select_less(zero, past, distance.scale(farther), distance);
            (across, distance, S::select_less(across, zero, S::constant(f64::INFINITY), rank))
        };
        let (mut behind, mut beside, mut rank) = of(&self.edges[0]);
        for edge in &self.edges[1..] {
            let (across, distance, its_rank) = of(edge);
            behind = behind.max(across);
            beside = S::select_less(its_rank, rank, distance, beside);
            rank = rank.min(its_rank);
        }
        let above = y.abs();
        let beside = face_if_on_it(S::norm([y, beside]), above, self.size);
        S::select_less(behind, zero, above, beside) - S::constant(self.radius)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const M: usize>(&self, cell: Vector<AffineModel<M>, 3>) -> AffineModel<M> {
        tangent_model(self, cell, OPERATIONS, self.size)
    }

    fn promise(&self) -> Promise<3> {
        Promise {
            has_interior: self.radius > 0.0,
            ..Promise::exact_convex(Some(self.bounds), OPERATIONS, self.size)
        }
    }
}

primitive! {
    Sheet<3>, triangle_sheet, 3,
    about: "All points within a radius of a triangle in space.",
    origin: "given by its points",
    parameters: {
        points: Points = "the three corners",
        radius: LengthOrZero = "the radius, zero for a sheet without inside",
    },
    marks: |kernel| sets::sheet(kernel.points(), kernel.radius()),
    example: (
        vec![Vector([-0.8, -0.5, 0.3]), Vector([0.7, -0.4, -0.2]), Vector([0.1, 0.8, 0.1])],
        0.15,
    ),
}

primitive! {
    Sheet<4>, quad_sheet, 3,
    about: "All points within a radius of a flat convex quadrilateral in space.",
    origin: "given by its points",
    parameters: {
        points: Points = "the four corners, in their order around it, in one plane",
        radius: LengthOrZero = "the radius, zero for a sheet without inside",
    },
    marks: |kernel| sets::sheet(kernel.points(), kernel.radius()),
    example: (
        vec![
            Vector([-0.7, -0.5, -0.25]),
            Vector([0.8, -0.4, -0.2]),
            Vector([0.6, 0.6, 0.3]),
            Vector([-0.5, 0.4, 0.2]),
        ],
        0.15,
    ),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, cross, slab};

    impl Evidence<3> for Sheet<3> {
        const SAMPLE: &'static str = r#"{ "points": [[-0.04, -0.03, -0.03], [0.04, -0.03, 0], [0, 0.04, 0.03]],
             "radius": 0.006 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Triangle", "three `points`, `radius` 0", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            sheet(self.points(), self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            let at = |x: f64, y: f64, z: f64| Vector([x, y, z]);
            vec![
                Self::new(
                    vec![
                        at(0.0, 0.0, 0.0),
                        at(1.0, 0.0, 0.0),
                        at(1.0, 1.0, 0.0),
                        at(0.0, 1.0, 0.0),
                    ],
                    0.1,
                ),
                Self::new(vec![at(1.0, 1.0, 1.0), at(2.0, 2.0, 2.0), at(5.0, 5.0, 5.0)], 0.1),
            ]
        }
    }

    impl Evidence<3> for Sheet<4> {
        const SAMPLE: &'static str = r#"{ "points": [[-0.04, -0.03, -0.03], [0.04, -0.03, -0.03],
             [0.03, 0.03, 0.03], [-0.03, 0.03, 0.03]], "radius": 0.006 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Quad", "four `points` in one plane, `radius` 0", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            sheet(self.points(), self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            let corners = |last: [f64; 3]| {
                let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], last];
                square.map(Vector).to_vec()
            };
            let crossed = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            vec![
                Self::new(corners([0.0, 1.0, 0.25]), 0.1),
                Self::new(corners([0.75, 0.5, 0.0]), 0.1),
                Self::new(crossed.map(Vector).to_vec(), 0.1),
                Self::new(corners([0.0, 1.0, 0.0]), -0.1),
            ]
        }
    }

    /// The slab without height on `corners`, in their own plane.
    fn sheet(corners: &[Point<3>], r: f64) -> Definition<3> {
        let origin = corners[0];
        let crossing = (2..corners.len())
            .map(|i| cross(corners[i - 1] - origin, corners[i] - origin))
            .fold(Vector::ZERO, |sum, area| sum + area);
        let normal = crossing.normalized().unwrap_or(Vector::unit(0));
        let flat = corners.iter().map(|c| *c - origin).collect();
        let slab = slab(flat, normal, 0.0, r);
        let boundary =
            slab.boundary.into_iter().map(|piece| piece.moved(move |p| p + origin)).collect();
        let contains = slab.contains;
        Definition::new(boundary, move |p| contains(p - origin))
    }
}
