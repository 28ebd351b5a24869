// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes without an inside, as plates.

use palpate_field::scalar::AffineModel;
use palpate_field::{
    Aabb, Bounds, CustomField, LARGEST_LENGTH, Point, Promise, Quality, SMALLEST_LENGTH, Shape,
    Vector,
};

use super::field::content;
use super::foot::{Foot, across};
use super::surface::Surface;
use super::{OPERATIONS, Ordered, SolidError};
use crate::mesh::Mesh;

/// The plate about the faces of a mesh: all points at most half its thickness away from one.
///
/// Its field is the distance to the nearest face less half the thickness: exact outside, a bound inside. The mesh may
/// be open, cross itself or face anywhere; nothing is mended.
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_mesh::{MeshSheet, TriangleMesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// let mesh = TriangleMesh::new(corners.map(Vector).to_vec(), vec![[0, 1, 2]])?;
/// let plate: Shape<3> = MeshSheet::from_mesh(&mesh, 0.002)?.into(); // 2 mm
/// assert_eq!(plate.promise().in_words(), "exact outside, bound inside");
/// assert_eq!(plate.distance([0.2, 0.5, 0.2]), 0.499);
/// assert_eq!(plate.distance([0.2, -0.0005, 0.2]), -0.0005);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct MeshSheet<const N: usize, const D: usize> {
    /// The vertices and faces as they came.
    mesh: Mesh<N, D>,
    surface: Surface<N, D>,
    /// Half the thickness [m].
    half: f64,
    promise: Promise<D>,
}

impl<const N: usize, const D: usize> MeshSheet<N, D> {
    /// The plate of a thickness [m] about the faces of a mesh.
    ///
    /// # Errors
    ///
    /// If the mesh or the thickness is too small or too large.
    #[inline(never)]
    pub fn from_mesh(mesh: &Mesh<N, D>, thickness: f64) -> Result<Self, SolidError> {
        let lengths = SMALLEST_LENGTH..=LARGEST_LENGTH;
        if !lengths.contains(&thickness) {
            return Err(SolidError::Thickness { thickness });
        }
        let aabb = mesh.bounds().grown(0.5 * thickness);
        let size = aabb.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        if !lengths.contains(&size) {
            return Err(SolidError::Size { size });
        }
        let Ordered { faces, .. } = Ordered::of(mesh.vertices(), mesh.elements());
        let surface = Surface::new(&faces);
        let promise = promise(aabb);
        Ok(Self { mesh: mesh.clone(), surface, half: 0.5 * thickness, promise })
    }

    /// The mesh, as it came.
    #[must_use]
    pub fn mesh(&self) -> &Mesh<N, D> {
        &self.mesh
    }

    /// The thickness of the plate [m].
    #[must_use]
    pub fn thickness(&self) -> f64 {
        2.0 * self.half
    }

    /// The signed distance at a point [m], and its gradient.
    fn at(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        if p.0.iter().any(|x| !x.is_finite()) {
            return (f64::NAN, Vector::ZERO);
        }
        let (face, foot) = self.surface.nearest(p, None);
        let (distance, gradient) = self.at_foot(p, face, &foot);
        (distance - self.half, gradient)
    }

    /// The distance to the nearest face [m], from its nearest point, and its gradient.
    fn at_foot(&self, p: Point<D>, face: usize, foot: &Foot<D>) -> (f64, Vector<f64, D>) {
        let distance = foot.squared.sqrt();
        let is_known = distance > self.promise.rounding.within(p.norm());
        let gradient = if is_known {
            (p - foot.point) * (1.0 / distance)
        } else {
            let normal = across(self.surface.faces.corners(face)).normalized();
            normal.unwrap_or(Vector::unit(0))
        };
        (distance, gradient)
    }
}

fn promise<const D: usize>(aabb: Aabb<D>) -> Promise<D> {
    let bounds = Bounds::of_box(aabb);
    let size = bounds.radius_about_origin();
    let mut promise = Promise::exact(Some(bounds), OPERATIONS, size);
    promise.inside = Quality::Bound;
    promise
}

impl<const N: usize, const D: usize> CustomField<D> for MeshSheet<N, D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.at(p).0
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p)
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn model<const M: usize>(&self, cell: &[AffineModel<M>; D]) -> AffineModel<M> {
        let centre = Vector(cell.map(|x| x.value));
        let radius = AffineModel::radius(cell);
        let rounding = self.promise.rounding.within(centre.norm() + radius);
        if !centre.is_finite() {
            return AffineModel::lipschitz(f64::NAN, 1.0, cell, rounding);
        }
        let (face, foot) = self.surface.nearest(centre, None);
        let (distance, away) = self.at_foot(centre, face, &foot);
        let f = distance - self.half;
        let nearest = (face, distance, away);
        let model = (distance > radius + rounding)
            .then(|| self.surface.model_of_distance(cell, nearest, radius, rounding));
        match model.flatten() {
            Some(model) => AffineModel { value: model.value - self.half, ..model },
            None => AffineModel::lipschitz(f, 1.0, cell, rounding),
        }
    }

    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        content(self.mesh.vertices(), self.mesh.elements(), sink);
        sink(&self.half.to_le_bytes());
        true
    }
}

impl<const N: usize, const D: usize> From<MeshSheet<N, D>> for Shape<D> {
    #[inline(never)]
    fn from(sheet: MeshSheet<N, D>) -> Self {
        Self::custom(sheet)
    }
}
