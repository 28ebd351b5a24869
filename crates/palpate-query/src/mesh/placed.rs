// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes that are somewhere in the world.

use palpate_field::{LARGEST_LENGTH, Pose};
use palpate_mesh::Mesh;

use crate::error::QueryError;
use crate::placed::Placed;

/// A mesh and where it is. A plain `&Mesh` is one where it was made.
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

    /// From the mesh's coordinates to those of a shape, and how large coordinates become
    /// on the way [m].
    pub(super) fn seen_from(
        &self,
        field: &Placed<'_, D>,
    ) -> Result<(Pose<D>, f64), QueryError> {
        let poses = [field.world_from_body, self.world_from_mesh];
        if !poses.iter().all(Pose::is_finite) {
            return Err(QueryError::Pose);
        }
        let [body, mesh] = poses.map(|pose| pose.translation.norm());
        let bounds = self.mesh.bounds();
        let reach = body + mesh + bounds.centre().norm() + bounds.half_extents().norm();
        if reach > LARGEST_LENGTH {
            return Err(QueryError::Coordinate { what: "a mesh in the world", value: reach });
        }
        Ok((field.world_from_body.inverse() * self.world_from_mesh, reach))
    }
}

impl<'a, const N: usize, const D: usize> From<&'a Mesh<N, D>> for PlacedMesh<'a, N, D> {
    fn from(mesh: &'a Mesh<N, D>) -> Self {
        Self::new(mesh, Pose::identity())
    }
}
