// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Triangle meshes and polygons.

use std::collections::HashMap;

use palpate_field::{Aabb, LARGEST_LENGTH, Point, Vector};

use crate::solid::rounding_of;
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
    /// The rounding of the coordinates, relative to the largest; `None` if they tell it themselves.
    rounding: Option<f64>,
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
        Ok(Self { vertices, elements, bounds, tree, rounding: None })
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
        let rounding = Some(self.rounding());
        let vertices = self.vertices.into_iter().map(|vertex| vertex * factor).collect();
        Ok(Self { rounding, ..Self::new(vertices, self.elements)? })
    }

    /// The same mesh of coordinates with another rounding, relative to the largest.
    #[cfg(feature = "files")]
    pub(crate) fn with_rounding(self, rounding: f64) -> Self {
        Self { rounding: Some(rounding), ..self }
    }

    /// The rounding of the coordinates, relative to the largest: that of the file or of the numbers themselves.
    pub(crate) fn rounding(&self) -> f64 {
        self.rounding.unwrap_or_else(|| rounding_of(&self.vertices))
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
        Self { vertices, elements, ..self }
    }
}

/// Half a unit in the last place of 1, in single precision.
pub(crate) const SINGLE_ROUNDING: f64 = 1.0 / 16_777_216.0;

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

/// Why vertices and elements are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No elements.
    #[error("the mesh has {vertices} vertices and no faces: at least one is needed")]
    Empty {
        /// How many vertices it has.
        vertices: usize,
    },
    /// A coordinate is not a number, or too large to compute with.
    #[error(
        "vertex {vertex} must be finite and at most {LARGEST_LENGTH:e} m in size, got {value:?} m"
    )]
    Coordinate {
        /// The vertex, counted from 0.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// An element names a vertex that does not exist.
    #[error("face {element} names vertex {index}, and there are {vertices}, counted from 0")]
    Index {
        /// The element, counted from 0.
        element: usize,
        /// The vertex that it names.
        index: u64,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More vertices or elements than can be counted.
    #[error("the mesh has {count} {what}: {} at most; cut it into parts", u32::MAX)]
    TooMany {
        /// Vertices or faces.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A factor that is no scale.
    #[error("a scale must be positive and finite, got {value:?}")]
    Scale {
        /// The factor.
        value: f64,
    },
}

/// The largest number of corners of a polygon. Cutting takes up to the cube of the number in time.
pub const MOST_CORNERS: usize = 1024;

/// Cuts a polygon into triangles, two fewer than it has corners and with its orientation, and
/// appends them.
///
/// Ear clipping (Meisters 1975): it cuts off a corner whose triangle has the polygon's
/// orientation and holds no other corner. Corners on a straight edge stay, since a neighbour
/// may end there. If a polygon that crosses itself has no ear left, any corner is cut off.
pub(crate) fn triangulate(
    corners: &[u32],
    vertices: &[Point<3>],
    triangles: &mut Vec<[u32; 3]>,
) {
    let at = |i: u32| vertices[i as usize];
    let normal = newell(corners.iter().map(|&i| at(i)));
    let turn = |a: Point<3>, b: Point<3>, c: Point<3>| (b - a).cross(c - a).dot(normal);
    let mut rest = corners.to_vec();
    while rest.len() > 3 {
        let count = rest.len();
        let neighbours =
            |i: usize| [rest[(i + count - 1) % count], rest[i], rest[(i + 1) % count]];
        let is_ear = |&i: &usize| {
            let ear = neighbours(i);
            let [a, b, c] = ear.map(at);
            let holds = |p: Point<3>| {
                turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 0.0
                && !rest.iter().any(|k| {
                    let p = at(*k);
                    !ear.contains(k) && p != a && p != b && p != c && holds(p)
                })
        };
        let ear = (0..count).find(is_ear).unwrap_or(0);
        triangles.push(neighbours(ear));
        rest.remove(ear);
    }
    if let [a, b, c] = rest[..] {
        triangles.push([a, b, c]);
    }
}

/// The normal of a polygon with a length of twice its area (Newell).
pub(crate) fn newell(corners: impl Iterator<Item = Point<3>> + Clone) -> Vector<f64, 3> {
    let next = corners.clone().skip(1);
    let Some(first) = corners.clone().next() else { return Vector::ZERO };
    let mut normal = Vector::ZERO;
    for (a, b) in corners.zip(next) {
        normal += (a - first).cross(b - first);
    }
    normal
}

#[cfg(test)]
mod polygon_tests {
    use super::*;

    fn cut(outline: &[[f64; 2]]) -> (Vec<[u32; 3]>, Vec<f64>) {
        // In the plane z = 2 x − y, so that nothing depends on an axis.
        let vertices: Vec<_> =
            outline.iter().map(|&[x, y]| Vector([x, y, 2.0 * x - y])).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&corners, &vertices, &mut triangles);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| outline[i as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        };
        let areas = triangles.iter().map(area).collect();
        (triangles, areas)
    }

    #[test]
    fn a_polygon_with_a_notch_is_cut_without_overlap() {
        let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]];
        let (triangles, areas) = cut(&notched);
        assert_eq!(triangles.len(), 3);
        assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 8.0);
    }

    #[test]
    fn a_corner_on_a_straight_edge_is_kept() {
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let (triangles, areas) = cut(&square);
        assert!(areas.iter().all(|area| *area > 0.0), "{triangles:?} {areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 4.0);
    }

    #[test]
    fn a_spiral_is_cut_into_its_area() {
        // Ten corners out along a spiral arm, and back along a narrower one.
        let arm = |i: u32, r: f64| {
            let angle = 0.6 * f64::from(i);
            [(r + 0.2 * angle) * angle.cos(), (r + 0.2 * angle) * angle.sin()]
        };
        let mut outline: Vec<_> = (0..16).map(|i| arm(i, 1.0)).collect();
        outline.extend((0..16).rev().map(|i| arm(i, 0.5)));
        let shoelace: f64 = (0..outline.len())
            .map(|i| {
                let ([ax, ay], [bx, by]) = (outline[i], outline[(i + 1) % outline.len()]);
                0.5 * (ax * by - ay * bx)
            })
            .sum();
        let (triangles, areas) = cut(&outline);
        assert_eq!(triangles.len(), 30);
        assert!(areas.iter().all(|area| *area > 0.0));
        assert!((areas.iter().sum::<f64>() - shoelace).abs() < 1e-12);
    }

    #[test]
    fn a_polygon_that_crosses_itself_still_gives_triangles() {
        assert_eq!(
            cut(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [1.0, 1.0]]).0.len(),
            3
        );
        assert_eq!(cut(&[[1.0, 1.0]; 6]).0.len(), 4);
    }
}
