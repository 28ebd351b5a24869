// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The few contacts that a solver needs.
//!
//! A solver treats the contacts of a group as points of one flat patch, with one normal. Two contacts hold
//! such a patch in the plane and four in space. A contact where the bodies curve apart is no point of the
//! patch: it would stop a ball that rolls.

use palpate_field::{Point, Vector};

use super::ManifoldSettings;
use super::patch::square_to;
use crate::contact::Contact;

/// The cosine of how far normals of a group are from that of its deepest contact, 5°.
const GROUP: f64 = 0.996_194_698_091_745_5;

/// The cosine of how far the normal of a contact may be from that of the deepest one, 1°, if its gap is
/// larger by more than a share of the slop.
const PARALLEL: f64 = 0.999_847_695_156_391_3;
const SLOP_SHARE: f64 = 0.25;

/// Contacts are as deep as the deepest if their gaps differ by less than this share of the margin.
const AS_DEEP: f64 = 1e-3;

/// Contacts nearer to each other than this share of the spacing are one; so are those that widen a patch by
/// less.
const ONE: f64 = 0.25;

/// The measure of a contact that the solver had in the last step is multiplied by this factor. Otherwise equally
/// good contacts would alternate from step to step.
const HELD: f64 = 1.1;

/// A contact that a solver may get.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Offer<const D: usize> {
    pub(crate) contact: Contact<D>,
    /// Whether the solver had it in the step before.
    pub(crate) is_held: bool,
    /// Whether the gap falls from here to a least point elsewhere: it leads no group.
    pub(crate) is_slope: bool,
}

/// Adds an offer, or joins it with one at the same place: the deeper contact stays, with the id of the one that
/// the solver has.
pub(crate) fn offer<const D: usize>(
    offers: &mut Vec<Offer<D>>,
    new: Offer<D>,
    settings: &ManifoldSettings,
) {
    let is_one = |old: &&mut Offer<D>| {
        (old.place() - new.place()).norm() <= ONE * settings.spacing
            && old.contact.normal.dot(new.contact.normal) > PARALLEL
    };
    match offers.iter_mut().find(is_one) {
        Some(old) => {
            let held = if old.is_held || !new.is_held { *old } else { new };
            let deeper = if new.contact.gap < old.contact.gap { new } else { *old };
            let contact = deeper.contact.with_id(held.contact.id);
            let is_slope = old.is_slope && new.is_slope;
            *old = Offer { contact, is_held: held.is_held, is_slope };
        }
        None => offers.push(new),
    }
}

impl<const D: usize> Offer<D> {
    fn place(&self) -> Point<D> {
        (self.contact.point_a + self.contact.point_b) * 0.5
    }

    /// How much a contact counts that is so far out [m].
    fn worth(&self, far: f64) -> f64 {
        if self.is_held { HELD * far } else { far }
    }
}

/// Chooses the contacts of a solver, by group, in each the deepest first. Appends them to `contacts`
/// and the sizes of the groups to `groups`, and returns how many it left out beyond the most that are asked
/// for. The order of the offers changes.
pub(crate) fn choose<const D: usize>(
    offers: &mut [Offer<D>],
    settings: &ManifoldSettings,
    slop: f64,
    (contacts, groups): (&mut Vec<Contact<D>>, &mut Vec<usize>),
) -> usize {
    offers.sort_unstable_by(|one, other| {
        let [one, other] = [one, other].map(|offer| offer.contact);
        one.gap.total_cmp(&other.gap).then(one.id.cmp(&other.id))
    });
    let most = settings.most.max(1);
    let (mut rest, mut dropped) = (offers, 0);
    // A slope leads no group. A deeper one is of a group only with nearly the same normal: an end of a line.
    while let Some(leader) = rest.iter().find(|offer| !offer.is_slope).copied() {
        let alike = |offer: &Offer<D>| offer.contact.normal.dot(leader.contact.normal);
        let deeper = |offer: &Offer<D>| offer.contact.gap - leader.contact.gap;
        let is_of_group = |offer: &Offer<D>| {
            alike(offer) > if deeper(offer) < 0.0 { PARALLEL } else { GROUP }
        };
        let count = gather(rest, is_of_group);
        let (group, others) = rest.split_at_mut(count);
        rest = others;
        let is_flat =
            |offer: &Offer<D>| alike(offer) > PARALLEL || deeper(offer) <= SLOP_SHARE * slop;
        let flat = gather(group, is_flat);
        let patch = &mut group[..flat];
        let count = spread(patch, settings, slop);
        let room = most - contacts.len();
        dropped += count.saturating_sub(room);
        let kept = &patch[..count.min(room)];
        if !kept.is_empty() {
            groups.push(kept.len());
            contacts.extend(kept.iter().map(|offer| offer.contact));
        }
    }
    dropped
}

/// Moves those that are wanted to the front, in the same order, and returns how many they are.
fn gather<const D: usize>(
    offers: &mut [Offer<D>],
    is_wanted: impl Fn(&Offer<D>) -> bool,
) -> usize {
    let mut count = 0;
    for i in 0..offers.len() {
        if is_wanted(&offers[i]) {
            offers[count..=i].rotate_right(1);
            count += 1;
        }
    }
    count
}

/// Moves the contacts that hold a patch to the front: the deepest, and those that make the patch largest. At
/// most two in the plane and four in space. Those whose gap is within the slop come first: they carry, and the
/// others do not touch yet. Returns how many they are.
fn spread<const D: usize>(
    patch: &mut [Offer<D>],
    settings: &ManifoldSettings,
    slop: f64,
) -> usize {
    let least = ONE * settings.spacing;
    let deepest = patch[0].contact.gap;
    let within = |patch: &[Offer<D>], far: f64| {
        patch.iter().take_while(|offer| offer.contact.gap <= deepest + far).count()
    };
    let as_deep = within(patch, AS_DEEP * settings.margin);
    let mut carrying = within(patch, slop);
    let mut centre = Vector::ZERO;
    for offer in &patch[..carrying] {
        centre += offer.place() * (1.0 / carrying as f64);
    }
    take(patch, 0, as_deep, |offer| (offer.place() - centre).norm());
    // The next one that is at least `least` out, of those that carry if there is one.
    let mut next =
        |patch: &mut [Offer<D>], count: usize, measure: &dyn Fn(&Offer<D>) -> f64| {
            if take(patch, count, carrying, measure) >= least {
                return true;
            }
            carrying += 1;
            take(patch, count, patch.len(), measure) >= least
        };
    let first = patch[0].place();
    if !next(patch, 1, &|offer| (offer.place() - first).norm()) {
        return 1;
    }
    if D == 2 {
        return 2;
    }
    let normal = patch[0].contact.normal;
    let second = patch[1].place();
    let side = across(second - first, normal);
    if !next(patch, 2, &|offer| (offer.place() - first).dot(side).abs()) {
        // Of a line the middle may carry and the ends not yet: each end beyond the two holds it too.
        let (line, along) = (second - first, (second - first).normalized());
        let beyond = |offer: &Offer<D>| {
            let far = along.map_or(0.0, |along| (offer.place() - first).dot(along));
            (-far).max(far - line.norm())
        };
        return if next(patch, 2, &beyond) { 3 } else { 2 };
    }
    let corners = [first, second, patch[2].place()];
    let turn = if (corners[2] - first).dot(side) > 0.0 { -1.0 } else { 1.0 };
    // How much larger the patch is with a contact beyond one of its sides.
    let beyond = |offer: &Offer<D>| {
        (0..3).fold(0.0_f64, |most, i| {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            let outwards = across(to - from, normal) * turn;
            most.max((offer.place() - from).dot(outwards))
        })
    };
    if next(patch, 3, &beyond) { 4 } else { 3 }
}

/// Moves the offer with the largest measure [m] of those from `first` to `end` to `first`, and returns
/// its measure; zero if there is none. Of equal ones it is the first.
fn take<const D: usize>(
    offers: &mut [Offer<D>],
    first: usize,
    end: usize,
    measure: impl Fn(&Offer<D>) -> f64,
) -> f64 {
    let mut best: Option<(usize, f64)> = None;
    for (i, offer) in offers.iter().enumerate().take(end).skip(first) {
        let worth = offer.worth(measure(offer));
        if best.is_none_or(|(_, most)| worth > most) {
            best = Some((i, worth));
        }
    }
    let Some((i, _)) = best else { return 0.0 };
    let far = measure(&offers[i]);
    offers[first..=i].rotate_right(1);
    far
}

/// The unit vector square to a side of a patch, along the patch.
fn across<const D: usize>(side: Vector<f64, D>, normal: Vector<f64, D>) -> Vector<f64, D> {
    square_to(side, normal).and_then(Vector::normalized).unwrap_or(Vector::ZERO)
}
