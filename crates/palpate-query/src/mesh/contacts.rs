// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the elements of a mesh touch a field.

use super::hits::{MeshWorkspace, Undecided, find};
use super::placed::PlacedMesh;
use crate::certified::Limits;
use crate::contact::Contact;
use crate::contacts::{self, ElementContacts, level};
use crate::element_search::Terms;
use crate::error::QueryError;
use crate::goal::Goal;
use crate::placed::Placed;

/// A contact of an element of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshContact<const D: usize> {
    /// The contact, from the field to the mesh, in world coordinates.
    pub contact: Contact<D>,
    /// The index of the element in the mesh.
    pub element: u32,
}

/// All contacts of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshContacts<const D: usize> {
    /// The contacts, by ascending elements, and of each element from the deepest.
    pub contacts: Vec<MeshContact<D>>,
    /// The elements that touch, ascending; each has at least one contact.
    pub hits: Vec<u32>,
    /// The elements that could not be decided, ascending. All others are proven free.
    pub undecided: Vec<Undecided>,
    /// How often the field was evaluated; a gradient counts twice.
    pub evaluations: u32,
}

/// All contacts of a field with the elements of a mesh, up to a gap [m].
///
/// Of each element that [`mesh_hits`](crate::mesh_hits) names, all that
/// [`contacts`](crate::contacts) finds, with the same promises; `limits` are those of each
/// element. Body `a` of a contact is the field, body `b` the mesh.
///
/// # Errors
///
/// If `gap` or the tolerance is negative, NaN or too large, or a pose is not finite or
/// beyond 1e15 m.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_mesh::TriangleMesh;
/// use palpate_query::{Limits, MeshWorkspace, Placed, mesh_contacts};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[-4.0, 0.0, -3.0], [5.0, 0.0, -3.0], [0.0, 0.0, 4.0]].map(Vector).to_vec();
/// let floor = TriangleMesh::new(corners, vec![[0, 2, 1]])?;
/// let ball = Shape::from_kernel(Ball::new(1.0)?);
/// let above = Placed::new(&ball, Pose::translation(Vector([0.5, 0.75, 0.0])));
/// let limits = Limits::new(1e-6);
/// let mut workspace = MeshWorkspace::new();
/// let touching = mesh_contacts(above, &floor, 0.0, &limits, &mut workspace)?;
/// let [touch] = touching.contacts.as_slice() else { panic!("one contact") };
/// assert_eq!(touch.element, 0);
/// assert!((touch.contact.gap + 0.25).abs() < 1e-6);
/// assert!((touch.contact.normal - Vector([0.0, -1.0, 0.0])).norm() < 1e-2);
/// # Ok(())
/// # }
/// ```
pub fn mesh_contacts<'a, 'w, const N: usize, const D: usize>(
    field: impl Into<Placed<'a, D>>,
    mesh: impl Into<PlacedMesh<'a, N, D>>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut MeshWorkspace<N, D>,
) -> Result<&'w MeshContacts<D>, QueryError> {
    contacts_of(field.into(), mesh.into(), gap, limits, workspace)
}

#[inline(never)]
pub(crate) fn contacts_of<'w, const N: usize, const D: usize>(
    field: Placed<'_, D>,
    placed: PlacedMesh<'_, N, D>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut MeshWorkspace<N, D>,
) -> Result<&'w MeshContacts<D>, QueryError> {
    find(&field, &placed, gap, limits, workspace)?;
    let mut evaluations = workspace.hits.evaluations;
    let view = placed.seen_from(&field)?;
    let terms = Terms {
        goal: Goal::least(limits.tolerance),
        budget: limits.budget,
        level: level(field.shape, gap)?,
        reach: view.reach,
    };
    let MeshWorkspace { hits, contacts: all, search, .. } = workspace;
    all.contacts.clear();
    for &element in &hits.hits {
        let first = all.contacts.len() as u64;
        contacts::find(field.shape, &view.element(element), &terms, search);
        let ElementContacts { contacts, least } = &mut search.found;
        evaluations += least.evaluations;
        if contacts.is_empty() {
            // The element touches, and the budget ended before its deepest point was found.
            contacts.push(contacts::at(field.shape, least.best));
        }
        all.contacts.extend(contacts.iter().zip(first..).map(|(contact, id)| MeshContact {
            contact: contact.placed(&field.world_from_body).with_id(id),
            element,
        }));
    }
    all.hits.clone_from(&hits.hits);
    all.undecided.clone_from(&hits.undecided);
    all.evaluations = evaluations;
    Ok(all)
}
