// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Simplices: triangles in 2D, tetrahedra in 3D.

use std::sync::Arc;

use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit};
use crate::kernel::mark::Mark;
use crate::kernel::{Kernel, face_if_on_it, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector, array};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 18.0;

/// The convex hull of `D + 1` points: a solid triangle in 2D, a tetrahedron in
/// 3D. Exact.
///
/// # Derivation
///
/// Inside, the nearest facet is the one with the largest signed distance to its plane. Outside,
/// the nearest point lies in the relative interior of exactly one face (facet, edge or corner).
/// It is the face that holds the point of its span nearest to `p`, and that has all other
/// corners behind it, as seen from `p`. For a facet the distance is that from its plane, for
/// lower faces the norm of the offset from the span. The least of the distances to all faces
/// would give wrong gradients: next to the end of a face two distances differ by less than
/// their rounding, but their directions do not.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Simplex};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let corners = vec![Vector([0.0, 0.0]), Vector([4.0, 0.0]), Vector([0.0, 2.0])];
/// let triangle = Shape::from_kernel(Simplex::new(corners)?);
/// assert_eq!(triangle.distance(Vector([1.0, 0.5])), -0.5);
/// assert_eq!(triangle.distance(Vector([-3.0, -4.0])), 5.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Simplex<const D: usize> {
    points: Arc<[Point<D>]>,
    facets: Arc<[Facet<D>]>,
    faces: Arc<[Face<D>]>,
    bounds: Bounds<D>,
    /// The largest distance of a corner from the origin [m].
    size: f64,
}

/// A face of `D − 1` dimensions, with its outward plane.
#[derive(Clone, Debug)]
struct Facet<const D: usize> {
    normal: [f64; D],
    offset: f64,
    face: Face<D>,
}

/// The convex hull of some of the corners.
#[derive(Clone, Debug)]
struct Face<const D: usize> {
    origin: [f64; D],
    /// From the first corner to each other.
    edges: Vec<[f64; D]>,
    /// `duals[i]·edges[j]` is one for `i = j`, else zero: they give the
    /// barycentric coordinates.
    duals: Vec<[f64; D]>,
    /// From the first corner to each corner of the simplex that is not the face's.
    others: Vec<[f64; D]>,
    /// The error of a barycentric coordinate of a point near the face, in units in the last place
    /// of one.
    coordinate_ulp: f64,
}

impl<const D: usize> Face<D> {
    /// The hull of the `points` whose index `is_corner` accepts.
    fn new(points: &[Point<D>], is_corner: impl Fn(usize) -> bool) -> Self {
        let (mut corners, mut others) = (Vec::new(), Vec::new());
        for (i, point) in points.iter().enumerate() {
            if is_corner(i) { corners.push(*point) } else { others.push(*point) }
        }
        let origin = corners[0];
        let edges: Vec<_> = corners[1..].iter().map(|c| *c - origin).collect();
        // Each dual is its edge less its projection on all other edges, scaled.
        let duals: Vec<_> = (0..edges.len())
            .map(|i| {
                let mut basis: Vec<Vector<f64, D>> = Vec::new();
                for (_, edge) in edges.iter().enumerate().filter(|(j, _)| *j != i) {
                    let rest = without(*edge, &basis);
                    basis.extend(rest.normalized());
                }
                let across = without(edges[i], &basis);
                (across * (1.0 / across.dot(edges[i]))).0
            })
            .collect();
        let longest = points.iter().fold(0.0_f64, |m, p| m.max((*p - origin).norm()));
        let steepest = duals.iter().fold(0.0_f64, |m, dual| m.max(Vector(*dual).norm()));
        let edges = edges.iter().map(|e| e.0).collect();
        let others = others.iter().map(|c| (*c - origin).0).collect();
        let coordinate_ulp = 4.0 * longest * steepest;
        Self { origin: origin.0, edges, duals, others, coordinate_ulp }
    }

    /// The offset of `p` from the face's span, and the least barycentric coordinate of the
    /// span's nearest point, which is negative if this point is not in the face.
    #[inline(always)]
    fn rest<S: Scalar>(&self, p: Vector<S, D>) -> (Vector<S, D>, S) {
        let mut rest = p - Vector::of(&self.origin);
        let from_origin = rest;
        let mut first = S::constant(1.0);
        let mut least = S::constant(1.0);
        for (edge, dual) in self.edges.iter().zip(&self.duals) {
            let share = from_origin.dot_constant(dual);
            first = first - share;
            least = least.min(share);
            rest = Vector(array!(k < D => rest.0[k] - share.scale(edge[k])));
        }
        (rest, least.min(first))
    }

    /// What the least barycentric coordinate is on the border of the face, less its rounding: else
    /// neither of two faces that meet might hold a point above their common border, and a third
    /// face, with another gradient, would be taken for the nearest.
    #[inline(always)]
    fn border<S: Scalar>(&self) -> S {
        S::constant(-self.coordinate_ulp * S::epsilon())
    }

    /// Not negative if all other corners lie behind the face, seen from a point at the offset
    /// `rest` from the face's span.
    #[inline(always)]
    fn before_others<S: Scalar>(&self, rest: Vector<S, D>) -> S {
        let mut least = S::constant(1.0);
        for other in &self.others {
            least = least.min(-rest.dot_constant(other));
        }
        least
    }
}

/// `v` without its parts along an orthonormal `basis`.
fn without<const D: usize>(v: Vector<f64, D>, basis: &[Vector<f64, D>]) -> Vector<f64, D> {
    basis.iter().fold(v, |v, b| v - *b * v.dot(*b))
}

impl<const D: usize> Simplex<D> {
    /// The convex hull of `D + 1` points [m], in any order.
    ///
    /// # Errors
    ///
    /// If there are not `D + 1` points, or they are flat: in 2D on a line, in 3D
    /// in a plane.
    pub fn new(points: Vec<Point<D>>) -> Result<Self, ShapeError> {
        if points.len() != D + 1 {
            let rule = format!("exactly {} points", D + 1).into();
            let count = points.len();
            return Err(ShapeError::Count { parameter: "points".into(), rule, count });
        }
        for x in points.iter().flat_map(|p| p.0) {
            crate::error::finite("points", x, Unit::Metre)?;
        }
        let longest = points.iter().fold(0.0_f64, |m, p| m.max((*p - points[0]).norm()));
        let mut facets = Vec::new();
        for (i, opposite) in points.iter().enumerate() {
            let corners: Vec<_> = (0..=D).filter(|j| *j != i).map(|j| points[j]).collect();
            let mut basis: Vec<Vector<f64, D>> = Vec::new();
            for corner in &corners[1..] {
                basis.extend(without(*corner - corners[0], &basis).normalized());
            }
            // Orthogonalised twice, so that normals of a thin simplex are perpendicular too.
            let height = without(without(corners[0] - *opposite, &basis), &basis);
            let flat = height.norm() <= 1e-9 * longest || basis.len() < D - 1;
            let (Some(normal), false) = (height.normalized(), flat) else {
                let rule = "the corners of a body with a volume, with heights of at least \
                            1e-9 of its size";
                let height = height.norm();
                return Err(ShapeError::number("points", rule, height, Unit::Metre));
            };
            let offset = normal.dot(corners[0]);
            let face = Face::new(&points, |j| j != i);
            facets.push(Facet { normal: normal.0, offset, face });
        }
        let faces = (1..(1_usize << (D + 1)) - 1)
            .filter(|set| (set.count_ones() as usize) < D)
            .map(|set| Face::new(&points, |j| set >> j & 1 == 1))
            .collect();
        let bounds = Aabb::around(points.iter().copied()).map(Bounds::of_box);
        let bounds = bounds.unwrap_or_else(|| Bounds::centred(Vector::ZERO, 0.0));
        let size = bounds.radius_about_origin();
        Ok(Self { points: points.into(), facets: facets.into(), faces, bounds, size })
    }
}

impl<const D: usize> Kernel<D> for Simplex<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        let zero = S::constant(0.0);
        let mut inside = S::constant(-1e30);
        let none = S::constant(1e30);
        let (mut nearest, mut least_of_all) = (none, none);
        for facet in self.facets.iter() {
            let height = p.dot_constant(&facet.normal) - S::constant(facet.offset);
            inside = inside.max(height);
            let (_, least) = facet.face.rest(p);
            let border = facet.face.border::<S>();
            let here = S::select_less(least, border, none, height.abs());
            least_of_all = least_of_all.min(here);
            nearest = nearest.min(S::select_less(height, zero, none, here));
        }
        for face in self.faces.iter() {
            let (rest, least) = face.rest(p);
            let here = S::select_less(least, face.border(), none, rest.norm());
            least_of_all = least_of_all.min(here);
            let is_nearest = face.before_others(rest);
            nearest = nearest.min(S::select_less(is_nearest, zero, none, here));
        }
        // Where a face and a corner of it meet, rounding may let neither be the nearest.
        let outside = S::select_less(nearest, none, nearest, least_of_all);
        let outside = face_if_on_it(outside, inside, self.size);
        S::select_less(inside, zero, inside, outside)
    }

    const HAS_OWN_MODEL: bool = true;

    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, D>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.size)
    }

    fn promise(&self) -> Promise<D> {
        Promise::exact_convex(Some(self.bounds), OPERATIONS, self.size)
    }
}

primitive! {
    Simplex<2>, triangle, 2,
    about: "The solid triangle of three points.",
    origin: "given by its points",
    parameters: { points: Points = "the three corners" },
    marks: |kernel| Mark::positions("points", kernel.points()),
    example: (vec![Vector([-0.6, -0.4]), Vector([0.7, -0.3]), Vector([0.1, 0.6])]),
}

primitive! {
    Simplex<3>, tetrahedron, 3,
    about: "The solid tetrahedron of four points.",
    origin: "given by its points",
    parameters: { points: Points = "the four corners" },
    marks: |kernel| Mark::positions("points", kernel.points()),
    example: (vec![
        Vector([-0.6, -0.4, -0.3]),
        Vector([0.7, -0.3, -0.4]),
        Vector([0.1, -0.2, 0.6]),
        Vector([0.0, 0.7, 0.1]),
    ]),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, hull, polygon};

    impl Evidence<2> for Simplex<2> {
        const SAMPLE: &'static str =
            r#"{ "points": [[-0.05, -0.04], [0.05, -0.02], [0.01, 0.05]] }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Triangle", "three `points`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            polygon(vec![self.points().to_vec()])
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            let on_a_line = [[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]].map(Vector).to_vec();
            vec![Self::new(vec![Vector([0.0, 0.0])]), Self::new(on_a_line)]
        }
    }

    impl Evidence<3> for Simplex<3> {
        const SAMPLE: &'static str = r#"{ "points": [[-0.05, -0.04, -0.03], [0.05, -0.04, -0.03],
             [0, -0.04, 0.05], [0, 0.05, 0]] }"#;

        fn definition(&self) -> Definition<3> {
            tetrahedron(self.points())
        }
    }

    fn tetrahedron(corners: &[Point<3>]) -> Definition<3> {
        let centre = corners.iter().fold(Vector::ZERO, |sum, c| sum + *c * 0.25);
        let triangles = (0..4)
            .map(|i| [corners[(i + 1) % 4], corners[(i + 2) % 4], corners[(i + 3) % 4]])
            .collect();
        hull(triangles, centre)
    }
}
