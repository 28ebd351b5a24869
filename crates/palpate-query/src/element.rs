// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Segments and triangles.

use palpate_field::{BoundingBall, Point, Vector};

use crate::error::QueryError;

/// A triangle counts as without area if its height is at most this many roundings of its
/// largest coordinate: fewer than searches allow for.
const FLAT_ROUNDINGS: f64 = 4.0;

/// The convex hull of `N` points: a segment of 2 or a triangle of 3, in `D` dimensions.
/// Points may coincide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<const N: usize, const D: usize> {
    pub(crate) vertices: [Point<D>; N],
}

impl<const N: usize, const D: usize> Element<N, D> {
    /// The segment or triangle with these `vertices` [m].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m.
    pub fn new(vertices: [impl Into<Point<D>>; N]) -> Result<Self, QueryError> {
        const { assert!(N == 2 || N == 3, "segments and triangles") };
        let vertices = vertices.map(Into::into);
        for vertex in vertices {
            QueryError::check_point("vertex", vertex)?;
        }
        Ok(Self { vertices })
    }

    /// The vertices [m].
    #[must_use]
    pub fn vertices(&self) -> &[Point<D>; N] {
        &self.vertices
    }

    /// The length of the longest edge [m].
    #[must_use]
    pub fn longest_edge(&self) -> f64 {
        self.vertices.iter().map(|vertex| self.farthest(*vertex)).fold(0.0, f64::max)
    }

    /// The smallest ball around the element, its radius rounded up. A field of steepness 1 that
    /// is greater at the centre than the radius is positive on the whole element.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_query::Element;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sliver = [Vector([0.0, 0.0]), Vector([1.0, 0.0]), Vector([0.5, 0.01])];
    /// let element = Element::new(sliver)?;
    /// assert_eq!(element.smallest_ball().centre, Vector([0.5, 0.0]));
    /// let around = element.circumscribed_ball().ok_or("the corners lie on a line")?;
    /// assert!(around.radius > 12.0);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn smallest_ball(&self) -> BoundingBall<D> {
        palpate_mesh::smallest_ball(&self.vertices)
    }

    /// The ball about the circumcentre of a triangle that its vertices lie on, its radius rounded
    /// up; the smallest ball of a segment. `None` if the vertices of a triangle lie on a line.
    #[must_use]
    pub fn circumscribed_ball(&self) -> Option<BoundingBall<D>> {
        palpate_mesh::circumscribed_ball(&self.vertices)
    }

    /// The barycentric weights of the centre of the smallest ball around the element.
    #[inline]
    pub(crate) fn centre_weights(&self) -> [f64; N] {
        palpate_mesh::centre_weights(&self.vertices)
    }

    /// A triangle without area as its longest edge with the second end doubled, so that its
    /// first two halves are all of it; `weights` are those of the triangle's centre.
    pub(crate) fn flattened(&self, weights: &[f64; N]) -> Option<Self> {
        let middle = (0..N).find(|&k| N == 3 && weights[k] == 0.0)?;
        let v = |k: usize| self.vertices[(middle + k) % N];
        let (edge, side) = (v(2) - v(1), v(0) - v(1));
        let squared = edge.dot(edge);
        let share = if squared > 0.0 { side.dot(edge) / squared } else { 0.0 };
        let off = side - edge * share;
        let largest = self.vertices.iter().fold(0.0_f64, |m, v| m.max(v.dot(*v)));
        let rounding = FLAT_ROUNDINGS * f64::EPSILON;
        let is_flat = off.dot(off) <= rounding * rounding * largest;
        let mut vertices = [v(2); N];
        vertices[0] = v(1);
        is_flat.then_some(Self { vertices })
    }

    /// The point with these barycentric weights of the vertices [m].
    #[must_use]
    #[inline]
    pub fn at(&self, weights: &[f64; N]) -> Point<D> {
        let mut point = Vector::ZERO;
        for (vertex, weight) in self.vertices.iter().zip(weights) {
            point += *vertex * *weight;
        }
        point
    }

    /// The vertex that is lowest along `way`.
    #[inline]
    pub(crate) fn lowest_along(&self, way: Vector<f64, D>) -> Point<D> {
        let (mut lowest, mut least) = (self.vertices[0], f64::INFINITY);
        for vertex in &self.vertices {
            let along = way.dot(*vertex);
            (lowest, least) = if along < least { (*vertex, along) } else { (lowest, least) };
        }
        lowest
    }

    /// The distance of `p` from the farthest point of the element, a vertex [m].
    #[must_use]
    #[inline]
    pub fn farthest(&self, p: Point<D>) -> f64 {
        let mut farthest = 0.0;
        for vertex in &self.vertices {
            let apart = *vertex - p;
            let squared = apart.dot(apart);
            farthest = if squared > farthest { squared } else { farthest };
        }
        farthest.sqrt()
    }

    /// The parts of half the size that make up the element, all similar to it: two of a
    /// segment, four of a triangle. Unused places hold the last. Of a triangle with two
    /// equal last vertices, the first two are all of it.
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn halves(&self) -> [Self; 4] {
        let v = &self.vertices;
        let middle = |i: usize, k: usize| (v[i] + v[k]) * 0.5;
        let part = |points: [Point<D>; 3]| {
            let mut vertices = *v;
            vertices.copy_from_slice(&points[..N]);
            Self { vertices }
        };
        if N == 2 {
            let centre = middle(0, 1);
            let last = part([centre, v[1], centre]);
            return [part([v[0], centre, centre]), last, last, last];
        }
        // The middle one is turned by half a turn: each vertex is across from its own.
        let across = [middle(1, 2), middle(2, 0), middle(0, 1)];
        [
            part([v[0], across[2], across[1]]),
            part([across[2], v[1], across[0]]),
            part([across[1], across[0], v[2]]),
            part(across),
        ]
    }
}

/// How many [halves](Element::halves) an element has.
#[must_use]
pub const fn parts_of_one<const N: usize>() -> usize {
    if N == 2 { 2 } else { 4 }
}
