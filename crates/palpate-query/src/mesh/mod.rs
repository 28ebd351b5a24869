// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes against fields.

mod hits;
mod placed;

pub use hits::{MeshHits, MeshWorkspace, Undecided, mesh_hits};
pub use placed::PlacedMesh;
