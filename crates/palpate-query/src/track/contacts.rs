// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The contacts of a solver, carried from step to step.
//!
//! A solver needs to know once that no contact is missed, and then where the contacts are. So a region is
//! searched up to a gap beyond the margin. A motion that moves no point by more than δ changes no gap
//! by more than δ. While the bodies have moved by less than what the search went beyond the margin, every part
//! of the region within the margin is known. Its contacts
//! move with the bodies, and Newton's method puts each where the gap is least.

use palpate_field::{Point, Pose};

use super::history::KnownContact;
use super::names::{Named, Names, TURNED};
use super::{Track, displacement};
use crate::certified::Limits;
use crate::contact::Contact;
use crate::error::QueryError;
use crate::manifold::{
    Edge, ManifoldSettings, Offer, Polish, Polished, SeparatedPair, Spanned, Touch, carried,
    choose, distance, offer, polished,
};
use crate::pair::PairWorkspace;
use crate::pair::body_pair::BodyPair;
use crate::sampler::Placed;

/// A search covers gaps up to this many margins.
const FARTHER: f64 = 1.5;

/// Bodies that move by at most this share of the margin in a step are at rest.
const AT_REST: f64 = 1e-4;

/// Bodies at rest are searched again if they have moved by more than this share of the margin since the search.
const SETTLED: f64 = 0.02;

/// The slop of settings without one, as a share of the margin.
const SLOP: f64 = 0.2;

/// The contacts are rejected if the fields prove a gap that is smaller than that of every contact by more than
/// this share of the margin.
const HIDDEN: f64 = 0.05;

/// Places to which both bodies carry a contact are one if they differ by less than this share of the
/// spacing.
const ONE_PLACE: f64 = 1e-3;

/// The contacts of a step, as [`Track::contacts`] finds them.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TrackedContacts<const D: usize> {
    /// The contacts, by group; in each group the deepest comes first.
    pub contacts: Vec<Contact<D>>,
    /// The number of contacts in each group. A group is one flat patch.
    pub groups: Vec<usize>,
    /// `false` if the last search ended before it had seen the whole region.
    pub is_whole: bool,
    /// A proven lower bound of the separation at this step [m].
    pub separation_at_least: f64,
    /// Whether the region was searched in this step.
    pub is_searched: bool,
    /// How many field values this step took of both bodies together; a gradient counts twice.
    pub evaluations: u32,
    offers: Vec<Offer<D>>,
}

impl<const D: usize> TrackedContacts<D> {
    fn clear(&mut self) {
        self.contacts.clear();
        self.groups.clear();
        self.offers.clear();
        (self.is_searched, self.evaluations) = (false, 0);
    }
}

/// What a search has proven, and the contacts that it found.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Carried<const D: usize> {
    /// The second body in the first one's coordinates, at the search and in the last step.
    found_at: Pose<D>,
    last_at: Pose<D>,
    /// Where the search found the bodies nearest or deepest.
    best: Point<D>,
    /// All parts of the region up to this gap are spanned [m].
    searched: f64,
    /// A lower bound of the separation at the search [m].
    lower: f64,
    spacing: f64,
    budget: u32,
    is_whole: bool,
    /// Whether the contacts were carried at least once.
    has_moved: bool,
    followers: Vec<Follower<D>>,
}

/// A contact that is carried, in the first body's coordinates.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Follower<const D: usize> {
    /// As the search found it, in the last step, and in the step under way, which may fail.
    found: Touch<D>,
    last: Touch<D>,
    now: Touch<D>,
    is_deepest: bool,
    id: u64,
    /// For how many steps before the last one the solver had it; `None` if it had not in the last one.
    age: Option<u32>,
    polish: Polish<D>,
    edge: Option<Edge<D>>,
}

impl<const D: usize> Follower<D> {
    /// The contact where the bodies have moved since the search.
    fn moved(
        &mut self,
        pair: &mut BodyPair<'_, D>,
        (found_at, second_to_frame, is_new): (Pose<D>, Pose<D>, bool),
        settings: &ManifoldSettings,
    ) -> Option<Polished<D>> {
        if let Some(found) = self.edge.and_then(|edge| edge.contact(pair, settings)) {
            return Some(found);
        }
        let Touch { point, normal, .. } = self.found;
        let with_second = second_to_frame.transform_point(found_at.transform_point(point));
        let is_one_place = distance(with_second, point) <= ONE_PLACE * settings.spacing;
        let carried = if is_one_place {
            Some(self.found.at_place(with_second))
        } else {
            carried(pair, [point, with_second], normal, settings)
        };
        let Some(start) = carried else {
            return self.found.at_place(with_second).found_again(pair, settings);
        };
        let found = polished(pair, &start, self.is_deepest, &mut self.polish, settings);
        found.or_else(|| {
            if is_new {
                Some(start.usual(pair, settings))
            } else {
                start.found_again(pair, settings)
            }
        })
    }

    /// The contacts of a search, with the names of those of the last step that are near.
    fn named(
        names: &mut Names<D>,
        spanned: &Spanned<D>,
        pair: &BodyPair<'_, D>,
        (poses, settings): ([Pose<D>; 2], &ManifoldSettings),
    ) -> Vec<Self> {
        let touches = || spanned.touches().copied();
        let mut contacts: Vec<_> =
            touches().map(|touch| touch.contact(pair, settings.spacing)).collect();
        names.name(&mut contacts, poses, settings.spacing);
        let followers = touches().zip(contacts).enumerate().map(|(i, (touch, contact))| Self {
            found: touch,
            last: touch,
            now: touch,
            is_deepest: i == 0,
            id: contact.id,
            age: contact.age.checked_sub(1),
            polish: Polish::default(),
            edge: None,
        });
        followers.collect()
    }
}

/// Whether a contact has turned too far to be the same one.
fn is_turned<const D: usize>(now: &Touch<D>, last: &Touch<D>) -> bool {
    now.normal.dot(last.normal) <= TURNED
}

impl<const D: usize> Carried<D> {
    /// Whether the contacts of the search last for these poses and settings: no part of the region is new,
    /// and the bodies have not turned by so much that another point is the deepest. Bodies that have come to
    /// rest elsewhere are searched there.
    fn lasts(&self, pair: &BodyPair<'_, D>, settings: &ManifoldSettings, budget: u32) -> bool {
        let more = !self.is_whole && budget > self.budget;
        if self.spacing != settings.spacing || more {
            return false;
        }
        let moved = self.moved(pair);
        if self.followers.is_empty() {
            return moved <= self.searched - settings.margin;
        }
        let limit = (self.searched - settings.margin).min((FARTHER - 1.0) * settings.margin);
        let step =
            displacement(&self.last_at, &pair.second_from_frame, &pair.root(self.searched));
        let is_at_rest = step <= AT_REST * settings.margin;
        moved <= if is_at_rest { limit.min(SETTLED * settings.margin) } else { limit }
    }

    /// Whether the bodies are proven to be nearer, or to overlap deeper, than all these contacts say.
    fn is_hiding(
        &self,
        pair: &mut BodyPair<'_, D>,
        second_to_frame: Pose<D>,
        settings: &ManifoldSettings,
        offers: &[Offer<D>],
    ) -> bool {
        let with_second =
            second_to_frame.transform_point(self.found_at.transform_point(self.best));
        let mut upper = pair.gap_at(with_second);
        if distance(with_second, self.best) > ONE_PLACE * settings.spacing {
            upper = upper.min(pair.gap_at(self.best));
        }
        let gaps = offers.iter().map(|offer| offer.contact.gap);
        let deepest = gaps.fold(settings.margin, f64::min);
        deepest > upper + HIDDEN * settings.margin
    }

    /// How far the bodies have moved since the search at most [m].
    fn moved(&self, pair: &BodyPair<'_, D>) -> f64 {
        displacement(&self.found_at, &pair.second_from_frame, &pair.root(self.searched))
    }

    /// Gives new ids to contacts whose normals the polish has turned too far from those of the last step.
    fn rename_turned(
        &mut self,
        contacts: &mut [Contact<D>],
        names: &mut Names<D>,
        before: &Names<D>,
    ) {
        for follower in &mut self.followers {
            let now = (follower.id, follower.last.normal);
            let Some(new) = names.new_if_turned(before, now) else { continue };
            for contact in contacts.iter_mut().filter(|contact| contact.id == follower.id) {
                (contact.id, contact.age) = (new, 0);
            }
            (follower.id, follower.age) = (new, follower.age.map(|_| 0));
        }
    }

    /// Moves the contacts with the bodies and chooses those of the solver. `false` if one of them is lost, or
    /// the bodies overlap by more than the margin.
    fn follow(
        &mut self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
        slop: f64,
        into: &mut TrackedContacts<D>,
    ) -> bool {
        let now = pair.second_from_frame;
        let second_to_frame = now.inverse();
        let (before, is_new) = (pair.evaluations, !self.has_moved);
        for follower in &mut self.followers {
            let Some(Polished { touch, contact, edge, is_slope }) =
                follower.moved(pair, (self.found_at, second_to_frame, is_new), settings)
            else {
                if follower.age.is_some() {
                    return false;
                }
                continue;
            };
            follower.edge = edge;
            // The solver's normal: where no polish succeeds it is not that of the touch.
            let mut touch = touch;
            touch.normal = contact.normal;
            let is_lost =
                follower.age.is_some() && !is_new && is_turned(&touch, &follower.last);
            if contact.gap < -settings.margin || is_lost {
                return false;
            }
            follower.now = touch;
            if contact.gap <= settings.margin {
                let contact = contact.placed(&pair.world_from_frame).with_id(follower.id);
                let is_held = follower.age.is_some();
                offer(&mut into.offers, Offer { contact, is_held, is_slope }, settings);
            }
        }
        if self.is_hiding(pair, second_to_frame, settings, &into.offers) {
            return false;
        }
        let chosen = (&mut into.contacts, &mut into.groups);
        choose(&mut into.offers, settings, slop, chosen);
        for follower in &mut self.followers {
            follower.last = follower.now;
            let mut contacts = into.contacts.iter_mut();
            let contact = contacts.find(|contact| contact.id == follower.id);
            follower.age = contact.map(|contact| {
                contact.age = follower.age.map_or(0, |age| age.saturating_add(1));
                contact.age
            });
        }
        let slack = pair.slack(pair.root(self.searched).radius_about_origin());
        into.separation_at_least = self.lower - self.moved(pair) - 2.0 * slack;
        into.is_whole = self.is_whole;
        into.evaluations += pair.evaluations - before;
        (self.last_at, self.has_moved) = (now, true);
        true
    }
}

impl<const D: usize> Track<D> {
    /// The contacts of both shapes at these poses for a solver, `world_from_body`, as
    /// [`ManifoldSettings::for_solver`] describes them, with lasting ids and ages.
    ///
    /// A search finds the region of contact up to a gap of 1.5 margins. The track uses this region until the
    /// bodies have moved by half a margin since the search. If the bodies come to rest at other poses than
    /// those of the search, the track searches there once more. Until then no part of the region is new. A
    /// step moves the contacts with the bodies and polishes them, for a few evaluations each. Another point of a patch may
    /// become the deepest meanwhile: the next search finds it. Where bodies overlap by more than the margin, each
    /// step is one of [`manifold`](Self::manifold), with its history.
    ///
    /// The margin may change from step to step; a smaller one asks for no search. Equal calls from the first
    /// one on give equal contacts, ids and ages. The returned reference points into the track; the next call
    /// overwrites it. A step without a search does not allocate. If `solver_slop` is `None`, the slop is a
    /// fifth of the margin.
    ///
    /// Choose a margin of at least the distance by which the bodies approach in a step, plus
    /// [`ManifoldSettings::for_solver`]'s own: a body that comes faster is first seen deep. A contact enters
    /// at the margin, so an age of zero does not say that the bodies touch: compare `gap` with the slop.
    /// A contact keeps its id only while its normal turns by less than 45° in a step. Ids are those of one
    /// track.
    ///
    /// ```
    /// use palpate_field::{Pose, Shape, Vector};
    /// use palpate_query::{Limits, ManifoldSettings, PairWorkspace, Track};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)?;
    /// let mut track = Track::new(floor, Shape::cuboid([1.0, 1.0, 1.0])?);
    /// let settings = ManifoldSettings::for_solver(track.size());
    /// let limits = Limits::new(settings.usual_tolerance());
    /// let mut workspace = PairWorkspace::new();
    /// let mut searches = 0;
    /// for step in 0..100 {
    ///     let pose = Pose::translation(Vector([1e-5 * f64::from(step), 0.499, 0.0]));
    ///     let poses = [Pose::identity(), pose];
    ///     let found = track.contacts(poses, &settings, &limits, &mut workspace)?;
    ///     searches += u32::from(found.is_searched);
    ///     assert_eq!(found.contacts.len(), 4);
    ///     assert!(found.contacts.iter().all(|contact| contact.age == step as u32));
    /// }
    /// assert_eq!(searches, 1);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As of [`manifold`](crate::manifold).
    #[inline(never)]
    pub fn contacts(
        &mut self,
        poses: [Pose<D>; 2],
        settings: &ManifoldSettings,
        limits: &Limits,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<&TrackedContacts<D>, QueryError> {
        settings.check()?;
        limits.check()?;
        let slop = settings.solver_slop.unwrap_or(SLOP * settings.margin);
        let settings = ManifoldSettings { solver_slop: Some(slop), ..*settings };
        let [a, b] = &self.shapes;
        let mut pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
        self.found.clear();
        let is_carried = self.memory.carried.as_mut().is_some_and(|carried| {
            carried.lasts(&pair, &settings, limits.budget)
                && carried.follow(&mut pair, &settings, slop, &mut self.found)
        });
        if !is_carried {
            self.search_contacts(poses, (&settings, slop), limits, workspace)?;
        }
        Ok(&self.found)
    }

    /// The same by a search.
    #[inline(never)]
    fn search_contacts(
        &mut self,
        poses: [Pose<D>; 2],
        (settings, slop): (&ManifoldSettings, f64),
        limits: &Limits,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<(), QueryError> {
        self.put_down();
        self.found.clear();
        let wide = ManifoldSettings { margin: FARTHER * settings.margin, ..*settings };
        let (separation, best) = self.search(poses, wide.goal(limits), limits, workspace)?;
        let mut spent = separation.evaluations;
        let mut before = Names::default();
        if separation.upper >= -settings.margin {
            let [a, b] = &self.shapes;
            let pair = BodyPair::new(Placed::new(a, poses[0]), Placed::new(b, poses[1]))?;
            let now = pair.second_from_frame;
            let mut separated = SeparatedPair { pair, best, separation };
            let mut carried = Carried {
                found_at: now,
                last_at: now,
                best,
                searched: wide.margin.max(separation.lower),
                lower: separation.lower,
                spacing: settings.spacing,
                budget: limits.budget,
                is_whole: true,
                has_moved: false,
                followers: Vec::new(),
            };
            if separation.lower <= wide.margin {
                let spanned = Spanned::find(&mut separated, &wide, limits.budget, workspace);
                before = self.memory.names.clone();
                carried.is_whole = !spanned.is_cut_off();
                let names = &mut self.memory.names;
                carried.followers =
                    Follower::named(names, &spanned, &separated.pair, (poses, settings));
            }
            spent += separated.pair.evaluations;
            let found = &mut self.found;
            if carried.follow(&mut separated.pair, settings, slop, found) {
                carried.rename_turned(&mut found.contacts, &mut self.memory.names, &before);
                (found.is_searched, found.evaluations) = (true, found.evaluations + spent);
                let is_bounded = carried.lower.is_finite();
                self.memory.carried = Some(carried);
                if !is_bounded {
                    // Nothing lasts, but the names do.
                    self.put_down();
                }
                return Ok(());
            }
            spent += found.evaluations;
            if !carried.followers.is_empty() {
                self.memory.names = before;
            }
        }
        let manifold = self.manifold(poses, settings, &limits.less(spent), workspace)?;
        let found = &mut self.found;
        found.clear();
        found.contacts.extend_from_slice(&manifold.contacts);
        found.groups.extend_from_slice(&manifold.groups);
        found.is_whole = manifold.is_whole;
        found.separation_at_least = manifold.separation.lower;
        found.is_searched = true;
        found.evaluations = spent + manifold.separation.evaluations;
        Ok(())
    }

    /// Stops carrying contacts. The next search knows their names and sides.
    pub(super) fn put_down(&mut self) {
        let Some(carried) = self.memory.carried.take() else { return };
        let second = carried.last_at;
        let followers = || carried.followers.iter();
        let named = followers().map(|follower| Named {
            id: follower.id,
            points: [follower.last.point, second.transform_point(follower.last.point)],
            normal: follower.last.normal,
            age: follower.age,
        });
        self.memory.names.replace(named);
        let known = followers().filter(|follower| follower.age.is_some()).map(|follower| {
            let Follower { last, id, .. } = follower;
            let half = last.normal * (0.5 * last.gap);
            KnownContact {
                id: *id,
                points: [last.point - half, second.transform_point(last.point + half)],
                normals: [last.normal, second.transform_vector(last.normal)],
                missed: 0,
            }
        });
        self.memory.history.replace(known);
    }
}
