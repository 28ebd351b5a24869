// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The defects and the measures of a mesh.

use std::fmt;

use palpate_field::{Aabb, Point};

use crate::mesh::{Mesh, weld};
use crate::solid::across;

/// An element is degenerate if its height is at most this times its largest coordinate: the
/// rounding of its vertices.
const FLAT: f64 = 4.0 * f64::EPSILON;

/// The defects and the measures of a mesh.
///
/// Elements meet in *rims*: triangles in edges, segments in end points. The indices of its
/// vertices identify a rim: two vertices at one place with two indices join no elements until
/// they are [welded](Mesh::welded).
///
/// ```
/// use palpate_field::Vector;
/// use palpate_mesh::{MeshError, Outline};
///
/// # fn main() -> Result<(), MeshError> {
/// let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]].map(Vector).to_vec();
/// let open = Outline::new(corners, vec![[0, 1], [1, 2]])?;
/// let said = "2 elements of 3 vertices, not watertight, 2 rims at a boundary";
/// assert_eq!(open.report().to_string(), said);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report<const D: usize> {
    /// The number of triangles or segments.
    pub elements: usize,
    /// The number of vertices, unused ones included.
    pub vertices: usize,
    /// Vertices that no element uses.
    pub unreferenced: usize,
    /// Vertices equal to an earlier one.
    pub coincident: usize,
    /// Elements without extent: with a vertex twice, or flat up to rounding.
    pub degenerate: usize,
    /// Elements with the same vertices as an earlier one, in any order.
    pub duplicates: usize,
    /// Rims of one element alone.
    pub boundary: usize,
    /// Rims of more than two elements.
    pub non_manifold: usize,
    /// Rims that two elements pass in the same direction: one of the two is inside out.
    pub inconsistent: usize,
    /// The smallest box around the elements.
    pub bounds: Aabb<D>,
    /// The area of all triangles [m²]; the length of all segments [m].
    pub surface: f64,
    /// The volume that triangles in space enclose [m³], or the area within segments in
    /// the plane [m²]; negative if the mesh is inside out, `None` if it is not watertight.
    pub enclosed: Option<f64>,
}

impl<const D: usize> Report<D> {
    /// `true` if each rim joins two elements that agree on the inside.
    #[must_use]
    pub fn is_watertight(&self) -> bool {
        self.boundary == 0 && self.non_manifold == 0 && self.inconsistent == 0
    }
}

impl<const D: usize> fmt::Display for Report<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} elements of {} vertices, ", self.elements, self.vertices)?;
        f.write_str(if self.is_watertight() { "watertight" } else { "not watertight" })?;
        for (count, what) in [
            (self.unreferenced, "unreferenced vertices"),
            (self.coincident, "coincident vertices"),
            (self.degenerate, "degenerate elements"),
            (self.duplicates, "duplicates"),
            (self.boundary, "rims at a boundary"),
            (self.non_manifold, "rims of more than two"),
            (self.inconsistent, "rims inside out"),
        ] {
            if count > 0 {
                write!(f, ", {count} {what}")?;
            }
        }
        Ok(())
    }
}

impl<const N: usize, const D: usize> Mesh<N, D> {
    /// Measures all elements, and counts their defects.
    #[must_use]
    #[inline(never)]
    pub fn report(&self) -> Report<D> {
        let mut named = vec![false; self.vertices().len()];
        for &index in self.elements().iter().flatten() {
            named[index as usize] = true;
        }
        let (kept, _) = weld(self.vertices());
        let mut report = Report {
            elements: self.elements().len(),
            vertices: named.len(),
            unreferenced: named.iter().filter(|&&is_named| !is_named).count(),
            coincident: named.len() - kept.len(),
            degenerate: 0,
            duplicates: self.duplicates(),
            boundary: 0,
            non_manifold: 0,
            inconsistent: 0,
            bounds: self.bounds(),
            surface: 0.0,
            enclosed: None,
        };
        // From the middle, so that little cancels.
        let (middle, mut enclosed) = (self.bounds().centre(), 0.0);
        for (element, indices) in self.elements().iter().enumerate() {
            let corners = self.corners(element);
            let is_repeated = (1..N).any(|i| indices[..i].contains(&indices[i]));
            report.degenerate += usize::from(is_repeated || is_flat(&corners, FLAT));
            report.surface += size(&corners).0;
            enclosed += signed_volume(&corners, middle);
        }
        for rim in self.rims().chunk_by(|a, b| a.0 == b.0) {
            match rim {
                [_] => report.boundary += 1,
                [(_, a), (_, b)] => report.inconsistent += usize::from(a == b),
                _ => report.non_manifold += 1,
            }
        }
        if N == D && report.is_watertight() {
            report.enclosed = Some(enclosed);
        }
        report
    }

    /// The rims of all elements, sorted, with the direction in which each is passed.
    fn rims(&self) -> Vec<([u32; 2], bool)> {
        let mut rims = Vec::with_capacity(N * self.elements().len());
        for indices in self.elements() {
            for i in 0..N {
                let (from, to) = (indices[i], indices[(i + 1) % N]);
                rims.push(match N {
                    2 => ([from; 2], i == 0),
                    _ => ([from.min(to), from.max(to)], from < to),
                });
            }
        }
        rims.sort_unstable();
        rims
    }

    fn duplicates(&self) -> usize {
        let mut sets = self.elements().to_vec();
        for set in &mut sets {
            set.sort_unstable();
        }
        sets.sort_unstable();
        sets.windows(2).filter(|pair| pair[0] == pair[1]).count()
    }
}

/// Whether the height of an element is at most this share of its largest coordinate.
pub(crate) fn is_flat<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    share: f64,
) -> bool {
    let largest = corners.iter().flat_map(|p| p.0).fold(0.0_f64, |m, x| m.max(x.abs()));
    size(corners).1 <= share * largest
}

/// The length of a segment or the area of a triangle, and its least extent: its length,
/// or its height over its longest edge.
fn size<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> (f64, f64) {
    let edge = |i: usize| corners[(i + 1) % N] - corners[i];
    let longest = (1..N).fold(0, |l, i| if edge(i).norm() > edge(l).norm() { i } else { l });
    let base = edge(longest);
    let length = base.norm();
    if N == 2 || length == 0.0 {
        return (length, length);
    }
    let along = base * (1.0 / length);
    let side = edge((longest + 1) % N);
    let height = (side - along * side.dot(along)).norm();
    (0.5 * length * height, height)
}

/// The signed volume of the simplex of an element and `apex`, by its determinant over D!;
/// zero if the element is not one less in dimension than the space.
///
/// With the inside on the left of a segment, and triangles counter-clockwise seen from
/// outside, those of a closed mesh add up to what it encloses.
pub(crate) fn signed_volume<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    apex: Point<D>,
) -> f64 {
    let simplices = if D == 2 { 2.0 } else { 6.0 };
    (corners[0] - apex).dot(across(corners)) / simplices
}

#[cfg(test)]
mod tests {
    use crate::mesh::{Outline, TriangleMesh};
    use palpate_field::Vector;

    /// A cube of side 2 about (1, 2, 3), counter-clockwise seen from outside.
    fn cube() -> (Vec<Vector<f64, 3>>, Vec<[u32; 3]>) {
        let corner = |i: u32| {
            let side = |k: u32| f64::from((i >> k) & 1) * 2.0;
            Vector([side(0), 1.0 + side(1), 2.0 + side(2)])
        };
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let halves = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        ((0..8).map(corner).collect(), halves.collect())
    }

    #[test]
    fn a_cube_is_watertight_and_has_its_volume_and_area() {
        let (vertices, elements) = cube();
        let report = TriangleMesh::new(vertices, elements).unwrap().report();
        assert!(report.is_watertight());
        assert_eq!(report.enclosed, Some(8.0));
        // A square root for each of twelve triangles.
        assert!((report.surface - 24.0).abs() < 24.0 * 12.0 * f64::EPSILON);
        assert_eq!((report.degenerate, report.duplicates, report.unreferenced), (0, 0, 0));
        assert_eq!(
            (report.bounds.min, report.bounds.max),
            (Vector([0.0, 1.0, 2.0]), Vector([2.0, 3.0, 4.0]))
        );
    }

    #[test]
    fn a_cube_inside_out_has_a_negative_volume() {
        let (vertices, mut elements) = cube();
        elements.iter_mut().for_each(|element| element.swap(0, 1));
        let report = TriangleMesh::new(vertices, elements).unwrap().report();
        assert_eq!(report.enclosed, Some(-8.0));
    }

    #[test]
    fn every_flaw_of_a_mesh_is_counted() {
        let (vertices, elements) = cube();
        let report = |vertices: &[_], elements: &[_]| {
            TriangleMesh::new(vertices.to_vec(), elements.to_vec()).unwrap().report()
        };
        let open = report(&vertices, &elements[1..]);
        assert_eq!((open.boundary, open.enclosed), (3, None));
        let mut turned = elements.clone();
        turned[4].swap(0, 1);
        assert_eq!(report(&vertices, &turned).inconsistent, 3);
        let mut more = elements.clone();
        more.push([elements[2][1], elements[2][0], elements[2][2]]);
        let doubled = report(&vertices, &more);
        assert_eq!((doubled.duplicates, doubled.non_manifold), (1, 3));
        let mut flat = elements.clone();
        flat.push([0, 0, 3]);
        assert_eq!(report(&vertices, &flat).degenerate, 1);
        let mut lonely = vertices.clone();
        lonely.push(vertices[3]);
        let report = report(&lonely, &elements);
        assert_eq!(
            (report.unreferenced, report.coincident, report.is_watertight()),
            (1, 1, true)
        );
    }

    #[test]
    fn three_points_on_a_line_are_a_degenerate_triangle() {
        let points = [0.1, 0.2, 0.7].map(|t| Vector([1.0 + t, 2.0 - 3.0 * t, 0.5 * t]));
        let mesh = TriangleMesh::new(points.to_vec(), vec![[0, 1, 2]]).unwrap();
        assert_eq!(mesh.report().degenerate, 1);
    }

    #[test]
    fn an_open_outline_has_two_ends() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(Vector).to_vec();
        let open = Outline::new(points.clone(), vec![[0, 1], [1, 2]]).unwrap().report();
        assert_eq!((open.boundary, open.surface, open.enclosed), (2, 2.0, None));
        let turned = Outline::new(points, vec![[0, 1], [1, 2], [0, 2]]).unwrap().report();
        assert_eq!((turned.boundary, turned.inconsistent), (0, 2));
    }
}
