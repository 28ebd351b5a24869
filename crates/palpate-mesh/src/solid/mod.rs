// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes as solids: the distance to their surface, with a sign by normals or winding numbers.

mod boxes;
mod error;
mod field;
mod findings;
mod foot;
mod normals;
mod repair;
mod winding;

use palpate_field::{
    Aabb, LARGEST_LENGTH, Point, Promise, Quality, Rounding, SMALLEST_LENGTH, Vector,
};

use crate::mesh::Mesh;
use crate::report::is_flat;
use crate::tree::{BallTree, FAN};
use boxes::Boxes;
pub use error::SolidError;
pub use findings::Findings;
use foot::{Foot, Part, across, foot};
use normals::Normals;
pub use repair::Opening;
pub(crate) use repair::crossing_faces;
use repair::{Crossings, Pieces, Repair};
use winding::WindingTree;

/// Rounded operations of a distance on numbers up to `|p| + size`.
const OPERATIONS: f64 = 64.0;

/// The normal of a face of at most this height, as a share of its largest coordinate, may be off by more than 1e-3:
/// the rounding of its corners.
const DOUBTFUL: f64 = 1e-12;

/// A mesh whose caps are larger than this share of its faces is a sheet.
const SHEET: f64 = 0.9;

/// The solid that a mesh bounds: the points of winding number above one half.
///
/// Its field is the distance to the nearest face, negative inside. Where faces bound the solid alone, that is
/// exact; where faces cross or lie within the solid, the values inside are bounds. The sign is that of the
/// nearest face, and where faces cross or meet in more than pairs, that of the winding number, which is
/// bounded until it is certain.
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_mesh::{Solid, TriangleMesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// // One face faces the wrong way.
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]];
/// let mesh = TriangleMesh::new(corners.map(Vector).to_vec(), faces)?;
/// let (solid, findings) = Solid::from_mesh(&mesh)?;
/// assert_eq!(findings.to_string(), "1 face faced the wrong way and was turned");
/// let shape: Shape<3> = solid.into();
/// assert_eq!(shape.promise().in_words(), "exact outside, exact inside");
/// assert_eq!(shape.distance([0.1, 0.2, -0.5]), 0.5);
/// assert_eq!(shape.distance([0.1, 0.2, 0.2]), -0.1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Solid<const N: usize, const D: usize> {
    /// The corners of each face, in the order of the boxes.
    faces: Vec<[Point<D>; N]>,
    boxes: Boxes<D>,
    normals: Normals<N, D>,
    /// `None` if the nearest face alone tells the sign.
    winding: Option<WindingTree<N, D>>,
    promise: Promise<D>,
}

impl<const N: usize, const D: usize> Solid<N, D> {
    /// The solid of a mesh, and what was found and mended.
    ///
    /// Equal vertices are merged; faces without area and doubled faces are dropped; neighbours are turned to agree
    /// on the inside; openings are closed by flat caps; pieces inside out are turned.
    ///
    /// # Errors
    ///
    /// If no face is left, or the faces bound no solid: a piece is not orientable, faces around an edge do not
    /// cancel even with caps, or the caps are as large as the faces, as of a sheet.
    pub fn from_mesh(mesh: &Mesh<N, D>) -> Result<(Self, Findings<D>), SolidError> {
        let Repair { vertices, elements, mut findings, pieces } = Repair::of(mesh);
        let given = mesh.elements().len();
        if elements.is_empty() {
            return Err(SolidError::NoFaces { given });
        }
        let size =
            mesh.bounds().half_extents().0.iter().fold(0.0, |size, half| half.max(size)) * 2.0;
        if !(SMALLEST_LENGTH..=LARGEST_LENGTH).contains(&size) {
            return Err(SolidError::Size { size });
        }
        if findings.one_sided > 0 {
            return Err(SolidError::OneSided { pieces: findings.one_sided });
        }
        let area = |elements: &[[u32; N]]| -> f64 {
            let corners = |element: &[u32; N]| element.map(|index| vertices[index as usize]);
            elements.iter().map(|element| across(&corners(element)).norm()).sum()
        };
        let (own, caps) = (area(&elements[..findings.own]), area(&elements[findings.own..]));
        if caps > SHEET * own {
            return Err(SolidError::Sheet);
        }
        let order = BallTree::new(&vertices, &elements);
        let (mut ordered, mut of_piece) = (Vec::new(), Vec::new());
        for element in order.order() {
            ordered.push(elements[*element as usize]);
            of_piece.push(pieces.of_element[*element as usize]);
        }
        let faces: Vec<_> = ordered
            .iter()
            .map(|element| element.map(|index| vertices[index as usize]))
            .collect();
        let boxes = Boxes::new(&faces);
        let are_solids = |a: usize, b: usize| {
            let [a, b] = [of_piece[a], of_piece[b]];
            a != b && !pieces.is_cavity[a] && !pieces.is_cavity[b]
        };
        let crossings = Crossings::of(&vertices, &ordered, &boxes, are_solids);
        (findings.crossings, findings.touching) = (crossings.crossings, crossings.touching);
        findings.crossing_at = crossings.at;
        findings.flat = faces.iter().filter(|face| is_flat(face, DOUBTFUL)).count();
        let winding = findings.has_inner_faces().then(|| WindingTree::new(&faces));
        let normals = Normals::new(vertices.len(), &ordered, &faces);
        let promise = promise(&faces, &quality(&findings, &crossings, &pieces));
        Ok((Self { faces, boxes, normals, winding, promise }, findings))
    }

    /// The promise of its field.
    #[must_use]
    pub fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    /// The face nearest to a point, in the order of the boxes, and its nearest point.
    fn nearest(&self, p: Point<D>) -> (usize, Foot<D>) {
        let mut best = (0, foot(&self.faces[0], p));
        self.boxes.nearest_first(p, best.1.squared, |group| {
            let first = group * FAN;
            for (i, face) in self.faces.iter().enumerate().skip(first).take(FAN) {
                let found = foot(face, p);
                if found.squared < best.1.squared {
                    best = (i, found);
                }
            }
            best.1.squared
        });
        best
    }

    /// The signed distance at a point [m], and its gradient.
    fn at(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        if p.0.iter().any(|x| !x.is_finite()) {
            return (f64::NAN, Vector::ZERO);
        }
        let (face, foot) = self.nearest(p);
        let away = p - foot.point;
        let distance = foot.squared.sqrt();
        let normal = self.normals.at(face, foot.part);
        let is_inside = match &self.winding {
            None => away.dot(normal) < 0.0,
            Some(winding) => winding.is_inside(&self.faces, p),
        };
        let side = if is_inside { -1.0 } else { 1.0 };
        // Near the surface the way to the foot is rounding alone; over a face it is the normal.
        let is_known = distance > self.promise.rounding.within(p.norm());
        let gradient = match foot.part {
            Part::Face if is_known && side * away.dot(normal) < 0.0 => -normal,
            Part::Face => normal,
            _ if is_known => away * (side / distance),
            _ => normal,
        };
        (side * distance, gradient)
    }
}

/// The qualities outside and inside.
///
/// The winding number is a sum over pieces. Of one whose faces do not cross each other it is 1 within and 0
/// without, of a cavity −1: it is nowhere negative unless a cavity crosses a piece, and the nearest face
/// bounds the solid. Faces within the solid are nearer than its surface, never farther.
fn quality<const D: usize>(
    findings: &Findings<D>,
    crossings: &Crossings<D>,
    pieces: &Pieces,
) -> [Quality; 2] {
    let exact_if = |is_exact: bool| if is_exact { Quality::Exact } else { Quality::Bound };
    let cavities = pieces.is_cavity.iter().any(|is_cavity| *is_cavity);
    let is_outside_exact =
        crossings.only_solids && (!cavities || findings.touching + findings.nested == 0);
    [exact_if(is_outside_exact), exact_if(!findings.has_inner_faces())]
}

fn promise<const N: usize, const D: usize>(
    faces: &[[Point<D>; N]],
    [outside, inside]: &[Quality; 2],
) -> Promise<D> {
    let aabb = Aabb::around(faces.iter().flatten().copied())
        .unwrap_or(Aabb { min: Vector::ZERO, max: Vector::ZERO });
    let bounds = palpate_field::Bounds::of_box(aabb);
    let size = bounds.radius_about_origin();
    let mut promise = Promise::exact(Some(bounds), OPERATIONS, size)
        .with_rounding(Rounding::of_operations(OPERATIONS, size));
    (promise.outside, promise.inside) = (*outside, *inside);
    promise
}
