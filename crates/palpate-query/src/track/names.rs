// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lasting ids of contacts.

use palpate_field::{Point, Pose, Vector};

use crate::contact::Contact;
use crate::manifold::grid::distance;

/// A contact that moved farther than this many spacings on both bodies is a new one.
const SAME: f64 = 2.0;

/// The cosine of how far its normal may turn, 45°.
const TURNED: f64 = 0.7;

/// The contacts of the last step, and where they were on both bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Names<const D: usize> {
    known: Vec<Known<D>>,
    next: u64,
}

#[derive(Clone, Copy, Debug)]
struct Known<const D: usize> {
    id: u64,
    points: [Point<D>; 2],
    normal: Vector<f64, D>,
}

impl<const D: usize> Names<D> {
    pub(super) fn new() -> Self {
        Self { known: Vec::new(), next: 0 }
    }

    /// Gives each contact the id of the nearest contact of the last step, or a new id. Near
    /// means near on either body: a contact that slides along one may rest on the other.
    pub(super) fn name(
        &mut self,
        contacts: &mut [Contact<D>],
        poses: [Pose<D>; 2],
        spacing: f64,
    ) {
        let from_world = poses.map(|pose| pose.inverse());
        let now: Vec<Known<D>> = contacts
            .iter()
            .map(|contact| Known {
                id: 0,
                points: [
                    from_world[0].transform_point(contact.point_a),
                    from_world[1].transform_point(contact.point_b),
                ],
                normal: from_world[0].transform_vector(contact.normal),
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
                (names[i], is_taken[k]) = (Some(self.known[k].id), true);
            }
        }
        self.known.clear();
        for ((contact, new), name) in contacts.iter_mut().zip(now).zip(names) {
            contact.id = name.unwrap_or(self.next);
            self.next += u64::from(name.is_none());
            self.known.push(Known { id: contact.id, ..new });
        }
    }
}
