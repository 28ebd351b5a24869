// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the elements of a mesh touch a field.

use super::hits::{MeshWorkspace, Undecided, find};
use super::placed::PlacedMesh;
use crate::certified::Limits;
use crate::contact::Contact;
use crate::contacts::{append, at, level};
use crate::error::QueryError;
use crate::goal::Goal;
use crate::placed::Placed;
use crate::search::Terms;

/// All contacts of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshContacts<'a, const D: usize> {
    /// The contacts, by their ids, in world coordinates. The upper 32 bits of an id are the
    /// element, the lower ones count its contacts from the deepest on.
    pub contacts: &'a [Contact<D>],
    /// The elements that touch, ascending; each has a contact.
    pub hits: &'a [u32],
    /// Those of which it is not known, ascending. All others are proven free.
    pub undecided: &'a [Undecided],
    /// How often the field was asked; a gradient counts twice.
    pub evaluations: u32,
}

/// All contacts of a field with the elements of a mesh, up to a gap [m].
///
/// Of each element that [`mesh_hits`](crate::mesh_hits) names, all that
/// [`contacts`](crate::contacts) finds, with the same promises; `limits` are those of each
/// element. The first thing of a contact is the field, the second the mesh.
///
/// # Errors
///
/// If `gap` is negative or no number, or a pose is not finite or beyond 1e15 m.
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
/// let limits = Limits { tolerance: 1e-6, ..Limits::default() };
/// let mut workspace = MeshWorkspace::new();
/// let touching = mesh_contacts(above, &floor, 0.0, &limits, &mut workspace)?;
/// let [contact] = touching.contacts else { panic!("one contact") };
/// assert!((contact.gap + 0.25).abs() < 1e-6);
/// assert!((contact.normal - Vector([0.0, -1.0, 0.0])).norm() < 1e-2);
/// # Ok(())
/// # }
/// ```
pub fn mesh_contacts<'a, 'w, const N: usize, const D: usize>(
    field: impl Into<Placed<'a, D>>,
    mesh: impl Into<PlacedMesh<'a, N, D>>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut MeshWorkspace<N, D>,
) -> Result<MeshContacts<'w, D>, QueryError> {
    let (field, placed) = (field.into(), mesh.into());
    let mut evaluations = find(&field, &placed, gap, limits, workspace)?;
    let view = placed.seen_from(&field)?;
    let terms = Terms {
        goal: Goal::least(limits.tolerance),
        budget: limits.budget,
        level: level(field.shape, gap)?,
        reach: view.reach,
    };
    let MeshWorkspace { hits, contacts, search, .. } = &mut *workspace;
    contacts.clear();
    for &name in &*hits {
        let first = contacts.len();
        let element = view.element(name);
        let answer = append(field.shape, &element, &terms, search, contacts);
        evaluations += answer.evaluations;
        if contacts.len() == first {
            // It touches, and the budget did not suffice to see where it does most.
            contacts.push(at(field.shape, answer.best));
        }
        for contact in &mut contacts[first..] {
            contact.point_a = field.world_from_body.transform_point(contact.point_a);
            contact.point_b = field.world_from_body.transform_point(contact.point_b);
            contact.normal = field.world_from_body.transform_vector(contact.normal);
            contact.id |= u64::from(name) << 32;
        }
    }
    let MeshWorkspace { hits, undecided, contacts, .. } = &*workspace;
    Ok(MeshContacts { contacts, hits, undecided, evaluations })
}
