// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The sides on which contacts came in.

use palpate_field::{Point, Pose, Vector};

use crate::contact::{Contact, NormalSource};
use crate::manifold::{ManifoldSettings, followed};
use crate::pair::body_pair::BodyPair;

/// The cosine of how far the normal of a contact may be from that of the step before, 45°.
const SAME_SIDE: f64 = 0.7;

/// If a contact is less deep than this share of the depth that its history gives, its gradient points to another
/// side.
const SHALLOW: f64 = 0.5;

/// A contact takes the side of the nearest contact of the last step. That contact is at most this many times the
/// sum of spacing and depth away.
const NEAR: f64 = 2.0;

/// A contact that is lost is remembered for so many steps.
const REMEMBERED: u32 = 10;

/// Contacts that have been followed since the bodies overlapped by no more than the margin.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct History<const D: usize> {
    known: Vec<KnownContact<D>>,
    /// Whether a way out of this overlap was searched for.
    has_looked: bool,
}

/// A contact of the last step, its points and normal in the coordinates of the first body and of the
/// second.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct KnownContact<const D: usize> {
    pub(super) id: u64,
    pub(super) points: [Point<D>; 2],
    pub(super) normals: [Vector<f64, D>; 2],
    /// In how many of the last steps it was not there.
    pub(super) missed: u32,
}

impl<const D: usize> KnownContact<D> {
    /// A contact of bodies at the inverses of these poses.
    pub(super) fn of(contact: &Contact<D>, from_world: &[Pose<D>; 2]) -> Self {
        Self {
            id: contact.id,
            points: [
                from_world[0].transform_point(contact.point_a),
                from_world[1].transform_point(contact.point_b),
            ],
            normals: from_world.map(|from_world| from_world.transform_vector(contact.normal)),
            missed: 0,
        }
    }
}

impl<const D: usize> History<D> {
    /// Whether a contact is deeper than the margin and there is no history. It is `true` at most once in an
    /// overlap.
    pub(super) fn is_first_deep(&mut self, contacts: &[Contact<D>], margin: f64) -> bool {
        let is_deep = contacts.iter().any(|contact| contact.gap < -margin);
        let is_first = is_deep && self.known.is_empty() && !self.has_looked;
        self.has_looked = is_deep && (self.has_looked || is_first);
        is_first
    }

    /// Takes these contacts as those with which the bodies came.
    pub(super) fn came_from(&mut self, outside: Vec<KnownContact<D>>) {
        self.known = outside;
    }

    /// Forgets where the bodies came from: they overlap deeper than that explains.
    pub(super) fn refute(&mut self) {
        self.known.clear();
    }

    /// Takes these as the contacts of the last step. Those that were there before stay for a while.
    pub(super) fn replace(&mut self, known: impl Iterator<Item = KnownContact<D>>) {
        let mut known: Vec<_> = known.collect();
        for lost in &self.known {
            let is_there = known.iter().any(|contact| contact.id == lost.id);
            if !is_there && lost.missed < REMEMBERED {
                known.push(KnownContact { missed: lost.missed + 1, ..*lost });
            }
        }
        self.known = known;
    }

    /// Takes those of these contacts whose sides are known as the contacts of the last step.
    pub(super) fn remember(
        &mut self,
        contacts: &[Contact<D>],
        are_known: &[bool],
        poses: [Pose<D>; 2],
    ) {
        let from_world = poses.map(|pose| pose.inverse());
        let known = contacts.iter().zip(are_known).filter(|(_, is_known)| **is_known);
        self.replace(known.map(|(contact, _)| KnownContact::of(contact, &from_world)));
    }

    /// Turns deep contacts back to the sides on which they came in: they get normals and gaps from their
    /// history. Returns of which contacts the side is known, and how often fields were evaluated.
    pub(super) fn follow(
        &self,
        contacts: &mut [Contact<D>],
        pair: BodyPair<'_, D>,
        poses: [Pose<D>; 2],
        settings: &ManifoldSettings,
    ) -> (Vec<bool>, u32) {
        let mut pair = pair;
        pair.evaluations = 0;
        let are_known = contacts
            .iter_mut()
            .map(|contact| {
                contact.gap >= -settings.margin
                    || self.turn_back(contact, &mut pair, poses, settings).is_some()
            })
            .collect();
        (are_known, pair.evaluations)
    }

    /// Turns a deep contact back to the side on which it came in. `None` if that is not known.
    fn turn_back(
        &self,
        contact: &mut Contact<D>,
        pair: &mut BodyPair<'_, D>,
        poses: [Pose<D>; 2],
        settings: &ManifoldSettings,
    ) -> Option<()> {
        let (last, apart) = self.nearest(contact, poses)?;
        let normals = [0, 1].map(|i| poses[i].transform_vector(last.normals[i]));
        let points = [0, 1].map(|i| poses[i].transform_point(last.points[i]));
        // How deep the points are that touched, by how they have moved past each other.
        let carried = (points[1] - points[0]).dot(normals[0]);
        let is_other_side = normals.iter().all(|normal| normal.dot(contact.normal) < SAME_SIDE);
        if is_other_side || contact.gap > SHALLOW * carried {
            let far = NEAR * (settings.spacing - contact.gap.min(carried));
            // Where no field gives a direction, the place says as little.
            if apart > far && contact.normal_from != NormalSource::Assumed {
                return None;
            }
            // The frame of the pair is the first body.
            let frame = poses[0].inverse();
            let touch = followed(
                pair,
                points.map(|p| frame.transform_point(p)),
                normals.map(|normal| frame.transform_vector(normal)),
                settings,
            )?;
            *contact = touch.contact(pair, settings.spacing);
        }
        Some(())
    }

    /// The contact of the last step that is nearest on either body, and how far it is [m].
    fn nearest(
        &self,
        contact: &Contact<D>,
        poses: [Pose<D>; 2],
    ) -> Option<(KnownContact<D>, f64)> {
        let apart = |known: &KnownContact<D>| {
            let [a, b] = [0, 1].map(|i| poses[i].transform_point(known.points[i]));
            (a - contact.point_a).norm().min((b - contact.point_b).norm())
        };
        let all = self.known.iter().map(|known| (*known, apart(known)));
        all.min_by(|one, other| one.1.total_cmp(&other.1))
    }
}
