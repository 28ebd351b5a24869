// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that are deep in each other when they are first seen.
//!
//! No step before says on which side they came in. So a short translation that separates them decides: their
//! contacts are those at its end, as if the second body had come from there.

use palpate_field::{Pose, Shape};

use super::history::KnownContact;
use crate::certified::Limits;
use crate::error::QueryError;
use crate::manifold::{ManifoldSettings, manifold};
use crate::pair::{PairWorkspace, way_out};
use crate::sampler::Placed;

/// The contacts at the end of a translation that separates the bodies, in the coordinates of each, and how often
/// fields were evaluated. Without such a translation there are none.
#[inline(never)]
pub(super) fn contacts_outside<const D: usize>(
    [a, b]: &[Shape<D>; 2],
    poses: [Pose<D>; 2],
    (settings, limits): (&ManifoldSettings, &Limits),
    workspace: &mut PairWorkspace<D>,
) -> Result<(Vec<KnownContact<D>>, u32), QueryError> {
    let placed = [Placed::new(a, poses[0]), Placed::new(b, poses[1])];
    // The other half is for the contacts at its end.
    let half = limits.with_budget(limits.budget / 2);
    let way = way_out(placed, &half, workspace)?;
    let spent = way.evaluations;
    let Some(direction) = way.best.direction else { return Ok((Vec::new(), spent)) };
    let mut outside = poses[1];
    outside.translation += direction * way.upper;
    let rest = limits.less(spent);
    let found = manifold(placed[0], Placed::new(b, outside), settings, &rest, workspace)?;
    let from_world = [poses[0].inverse(), outside.inverse()];
    let known = found.contacts.iter().map(|contact| KnownContact::of(contact, &from_world));
    Ok((known.collect(), spent.saturating_add(found.separation.evaluations)))
}
