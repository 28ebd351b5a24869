// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Vertices and the elements between them.

use std::collections::HashMap;

use palpate_field::{Aabb, LARGEST_LENGTH, Point, Vector};

use crate::error::MeshError;
use crate::tree::BallTree;

/// Elements of `N` vertices each in `D` dimensions: triangles or segments.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_mesh::{MeshError, Outline};
///
/// # fn main() -> Result<(), MeshError> {
/// let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]].map(Vector).to_vec();
/// let triangle = Outline::new(corners, vec![[0, 1], [1, 2], [2, 0]])?;
/// let report = triangle.report();
/// assert_eq!((report.surface, report.enclosed), (12.0, Some(6.0))); // [m], [m²]
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Mesh<const N: usize, const D: usize> {
    vertices: Vec<Point<D>>,
    elements: Vec<[u32; N]>,
    bounds: Aabb<D>,
    tree: BallTree<D>,
}

/// Triangles in space.
pub type TriangleMesh = Mesh<3, 3>;

/// Segments in the plane; the inside is on their left.
pub type Outline = Mesh<2, 2>;

impl<const N: usize, const D: usize> Mesh<N, D> {
    /// The mesh of `elements` between `vertices` [m], and its tree of balls.
    ///
    /// Elements with a vertex twice or without extent are allowed; [`report`](Self::report)
    /// counts them.
    ///
    /// # Errors
    ///
    /// If there are no elements, a coordinate is not finite or beyond 1e15 m, an element
    /// names a vertex that does not exist, or there are more vertices or elements than `u32::MAX`.
    #[inline(never)]
    pub fn new(vertices: Vec<Point<D>>, elements: Vec<[u32; N]>) -> Result<Self, MeshError> {
        for (what, count) in [("vertices", vertices.len()), ("faces", elements.len())] {
            if u32::try_from(count).is_err() {
                return Err(MeshError::TooMany { what, count });
            }
        }
        for (vertex, point) in vertices.iter().enumerate() {
            for value in point.0 {
                if value.is_nan() || value.abs() > LARGEST_LENGTH {
                    return Err(MeshError::Coordinate { vertex, value });
                }
            }
        }
        for (element, indices) in elements.iter().enumerate() {
            for &index in indices {
                if index as usize >= vertices.len() {
                    let (index, vertices) = (u64::from(index), vertices.len());
                    return Err(MeshError::Index { element, index, vertices });
                }
            }
        }
        let empty = MeshError::Empty { vertices: vertices.len() };
        let named = elements.iter().flatten().map(|&index| vertices[index as usize]);
        let bounds = Aabb::around(named).ok_or(empty)?;
        let tree = BallTree::new(&vertices, &elements);
        Ok(Self { vertices, elements, bounds, tree })
    }

    /// The vertices [m].
    #[must_use]
    pub fn vertices(&self) -> &[Point<D>] {
        &self.vertices
    }

    /// The vertices of each element, as indices; never empty.
    #[must_use]
    pub fn elements(&self) -> &[[u32; N]] {
        &self.elements
    }

    /// The vertices of an element [m].
    ///
    /// # Panics
    ///
    /// If there is no such element.
    #[inline]
    #[must_use]
    pub fn corners(&self, element: usize) -> [Point<D>; N] {
        let mut corners = [Vector::ZERO; N];
        for (corner, index) in corners.iter_mut().zip(&self.elements[element]) {
            *corner = self.vertices[*index as usize];
        }
        corners
    }

    /// The smallest box around the elements [m]; unused vertices do not count.
    #[must_use]
    #[inline(never)]
    pub fn bounds(&self) -> Aabb<D> {
        self.bounds
    }

    /// The tree of balls around the elements.
    #[doc(hidden)]
    #[must_use]
    #[inline(never)]
    pub fn tree(&self) -> &BallTree<D> {
        &self.tree
    }

    /// The mesh `factor` times as large: `0.001` converts millimetres to metres.
    ///
    /// # Errors
    ///
    /// If the factor is not positive and finite, or makes a coordinate too large.
    #[inline(never)]
    pub fn scaled(self, factor: f64) -> Result<Self, MeshError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(MeshError::Scale { value: factor });
        }
        let vertices = self.vertices.into_iter().map(|vertex| vertex * factor).collect();
        Self::new(vertices, self.elements)
    }

    /// The mesh with equal vertices merged into one, in the order in which they first appear.
    #[must_use]
    #[inline(never)]
    pub fn welded(self) -> Self {
        let (vertices, names) = weld(&self.vertices);
        let mut elements = self.elements;
        for index in elements.iter_mut().flatten() {
            *index = names[*index as usize];
        }
        // The same points in the same elements have the same bounds and the same tree.
        Self { vertices, elements, bounds: self.bounds, tree: self.tree }
    }
}

/// A point in single precision.
pub(crate) fn single<const D: usize>(p: Point<D>) -> Point<D> {
    Vector(p.0.map(|x| f64::from(x as f32)))
}

/// The distinct points, and the index into them of each of `points`; zero equals minus zero.
pub(crate) fn weld<const D: usize>(points: &[Point<D>]) -> (Vec<Point<D>>, Vec<u32>) {
    let mut places = HashMap::with_capacity(points.len());
    let (mut kept, mut names) = (Vec::new(), Vec::with_capacity(points.len()));
    for point in points {
        let key = point.0.map(|x| (x + 0.0).to_bits());
        let name = *places.entry(key).or_insert_with(|| {
            kept.push(*point);
            kept.len() as u32 - 1
        });
        names.push(name);
    }
    (kept, names)
}
