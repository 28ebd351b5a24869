// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Names of contacts that last.

use palpate_field::{Point, Pose, Vector};

use crate::contact::Contact;
use crate::manifold::distance;

/// A contact that moved farther than this many spacings on both bodies is a new one.
const SAME: f64 = 2.0;

/// The cosine of how far its normal may turn, 45°.
pub(super) const TURNED: f64 = 0.7;

/// The contacts of the last step, and where they were on both bodies.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Names<const D: usize> {
    known: Vec<Named<D>>,
    next: u64,
}

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Named<const D: usize> {
    pub(super) id: u64,
    /// Where it was in the coordinates of each body.
    pub(super) points: [Point<D>; 2],
    /// In the first body's coordinates.
    pub(super) normal: Vector<f64, D>,
    /// For how many steps it was there before the last one; `None` if it was not there in the last one.
    pub(super) age: Option<u32>,
}

impl<const D: usize> Names<D> {
    /// Takes these as the contacts of the last step.
    pub(super) fn replace(&mut self, known: impl Iterator<Item = Named<D>>) {
        self.known.clear();
        self.known.extend(known);
    }

    /// A new id if the contact with this id turned too far since the last step, to a `normal` in the first
    /// body's coordinates. `before` are the contacts of the last step.
    pub(super) fn new_if_turned(
        &mut self,
        before: &Self,
        (id, normal): (u64, Vector<f64, D>),
    ) -> Option<u64> {
        let old = before.known.iter().find(|old| old.id == id)?;
        if normal.dot(old.normal) > TURNED {
            return None;
        }
        let new = self.next;
        self.next += 1;
        Some(new)
    }

    /// Gives each contact the id of the nearest contact of the last step, or a new id; and its age. Near
    /// means near on either body: a contact that slides along one may rest on the other.
    pub(super) fn name(
        &mut self,
        contacts: &mut [Contact<D>],
        poses: [Pose<D>; 2],
        spacing: f64,
    ) {
        let from_world = poses.map(|pose| pose.inverse());
        let now: Vec<Named<D>> = contacts
            .iter()
            .map(|contact| Named {
                id: 0,
                points: [
                    from_world[0].transform_point(contact.point_a),
                    from_world[1].transform_point(contact.point_b),
                ],
                normal: from_world[0].transform_vector(contact.normal),
                age: None,
            })
            .collect();
        let mut pairs = Vec::new();
        for (i, new) in now.iter().enumerate() {
            for (k, old) in self.known.iter().enumerate() {
                let apart = distance(new.points[0], old.points[0])
                    .min(distance(new.points[1], old.points[1]));
                if apart < SAME * spacing && new.normal.dot(old.normal) > TURNED {
                    pairs.push((apart, i, k));
                }
            }
        }
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut names = vec![None; now.len()];
        let mut is_taken = vec![false; self.known.len()];
        for (_, i, k) in pairs {
            if names[i].is_none() && !is_taken[k] {
                (names[i], is_taken[k]) = (Some(self.known[k]), true);
            }
        }
        self.known.clear();
        for ((contact, new), name) in contacts.iter_mut().zip(now).zip(names) {
            contact.id = name.map_or(self.next, |name| name.id);
            self.next += u64::from(name.is_none());
            let age = name.and_then(|name| name.age);
            contact.age = age.map_or(0, |age| age.saturating_add(1));
            self.known.push(Named { id: contact.id, age: Some(contact.age), ..new });
        }
    }
}
