// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes with a pose in the world.

use palpate_field::{LARGEST_LENGTH, Pose};
use palpate_mesh::Mesh;

use crate::element::Element;
use crate::error::QueryError;
use crate::placed::Placed;

/// A mesh and its pose. A plain `&Mesh` converts to one at the identity.
#[derive(Clone, Copy, Debug)]
pub struct PlacedMesh<'a, const N: usize, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<N, D>,
    /// From the mesh's coordinates to the world's.
    pub world_from_mesh: Pose<D>,
}

impl<'a, const N: usize, const D: usize> PlacedMesh<'a, N, D> {
    /// `mesh` moved by `world_from_mesh`.
    #[must_use]
    pub fn new(mesh: &'a Mesh<N, D>, world_from_mesh: Pose<D>) -> Self {
        Self { mesh, world_from_mesh }
    }

    /// The mesh in the coordinates of a field.
    pub(super) fn seen_from(
        &self,
        field: &Placed<'_, D>,
    ) -> Result<View<'a, N, D>, QueryError> {
        let poses = [field.world_from_body, self.world_from_mesh];
        if let Some(index) = poses.iter().position(|pose| !pose.is_finite()) {
            return Err(QueryError::Pose { index });
        }
        let [body, mesh] = poses.map(|pose| pose.translation.norm());
        let reach = body + mesh + self.mesh.bounds().radius_about_origin();
        if reach > LARGEST_LENGTH {
            return Err(QueryError::Coordinate { what: "mesh", value: reach });
        }
        let field_from_mesh = field.world_from_body.inverse() * self.world_from_mesh;
        Ok(View { mesh: self.mesh, field_from_mesh, reach })
    }
}

/// A mesh in the coordinates of a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a, const N: usize, const D: usize> {
    pub(super) mesh: &'a Mesh<N, D>,
    pub(super) field_from_mesh: Pose<D>,
    /// An upper bound of the coordinates in the conversion [m].
    pub(super) reach: f64,
}

impl<const N: usize, const D: usize> View<'_, N, D> {
    /// An element in the field's coordinates.
    #[inline]
    pub(super) fn element(&self, name: u32) -> Element<N, D> {
        let mut vertices = self.mesh.corners(name as usize);
        for vertex in &mut vertices {
            *vertex = self.field_from_mesh.transform_point(*vertex);
        }
        Element { vertices }
    }
}

impl<'a, const N: usize, const D: usize> From<&'a Mesh<N, D>> for PlacedMesh<'a, N, D> {
    fn from(mesh: &'a Mesh<N, D>) -> Self {
        Self::new(mesh, Pose::identity())
    }
}
