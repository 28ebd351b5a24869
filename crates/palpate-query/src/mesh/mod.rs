// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes against fields.

mod contacts;
mod hits;
mod placed;

pub(crate) use contacts::contacts_of;
pub use contacts::{MeshContact, MeshContacts, mesh_contacts};
pub(crate) use hits::find;
pub use hits::{MeshHits, MeshWorkspace, Undecided, mesh_hits};
pub use placed::PlacedMesh;
