// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts that span the region in which two bodies touch.
//!
//! Two bodies touch along the surface `g_a = g_b` between them, where both are at most half
//! the margin. Values and models rule out boxes that cannot hold a part of this surface; the
//! others are halved down to the spacing, and each gives a candidate on the surface.
//! Neighbouring candidates with like normals form a patch. The contacts of a patch are its
//! deepest point, the corners that span it, and more points where the corners do not span
//! all of it.
//!
//! `region` finds the candidates with their normals, `Touch` the normal of a point that is found
//! otherwise, `patch` chooses the contacts, `cover` adds those that they leave out, `moved` carries them
//! with the bodies; the separation and its bounds come from `pair/search.rs`.

mod cover;
mod edge;
mod patch;
mod polish;
mod region;
mod solver;

use palpate_field::{LARGEST_LENGTH, Point, Vector};

use crate::certified::{Certified, Goal, Limits, Stop, Verdict};
use crate::contact::{Contact, NormalSource};
use crate::error::QueryError;
use crate::pair::body_pair::{BodyPair, Face};
use crate::pair::search::PairSearch;
use crate::pair::{Nearest, PairWorkspace};
use crate::sampler::{Placed, arbitrary};
pub(crate) use edge::Edge;
use patch::Patches;
pub(crate) use patch::{carried, followed};
pub(crate) use polish::{Polish, Polished, polished};
use region::Region;
pub(crate) use region::distance;
pub(crate) use solver::{Offer, choose, offer};

/// Contacts closer than this many spacings, with normals within 37°, are copies.
const COPIES: f64 = 1.5;
const LIKE: f64 = 0.8;

/// Contacts that were moved are at one place if they are nearer than this many spacings, times [`COPIES`].
const ONE_PLACE: f64 = 0.1;

/// The first step to the deepest point of an edge, as a multiple of the gap.
const EDGE: f64 = 4.0;

/// Contacts whose gaps differ by less than this share of the precision are as deep.
const SAME_DEPTH: f64 = 1e-3;

/// Precisions are shares of the margin, but of no less than this share of the spacing: with
/// a margin of zero no point would be precise enough.
const SHALLOW: f64 = 1e-3;

/// Which contacts a [`manifold`] has.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ManifoldSettings {
    /// The largest gap of a contact [m]. The deepest contact is kept even if its gap exceeds this: by the
    /// tolerance of the search, or by more where a field is a bound.
    pub margin: f64,
    /// The size of the smallest boxes searched [m]. Thinner parts of the region are looked for where they
    /// may be farther than two spacings from the convex hull of the contacts; nearer ones may be missed,
    /// except for the certified deepest point. Contacts with like normals are at least a spacing apart.
    pub spacing: f64,
    /// The largest number of contacts: the deepest is kept, and those farthest apart. Zero counts
    /// as one.
    pub most: usize,
    /// The penetration that a solver leaves to resting bodies [m], for contacts that a solver can stand on;
    /// `None` for contacts that span the region. See [`for_solver`](Self::for_solver).
    pub solver_slop: Option<f64>,
}

impl ManifoldSettings {
    /// For bodies of about `size` [m]: a margin of 0.2 %, a spacing of 4 %, 32 contacts.
    #[must_use]
    pub const fn of_size(size: f64) -> Self {
        Self { margin: 0.002 * size, spacing: 0.04 * size, most: 32, solver_slop: None }
    }

    /// Contacts for a solver, of bodies of about `size` [m]: a margin of 1 %, a spacing of 8 %, 32 contacts,
    /// a slop of 0.2 %.
    ///
    /// - Normals of a group are within 5° of that of its deepest contact, which comes first.
    /// - A group has at most two contacts in the plane and four in space: the deepest, and those that make
    ///   the patch largest.
    /// - A further contact is within 1° of the normal of the deepest one, or its gap is larger by at most a
    ///   quarter of the slop. So a ball on a floor has one contact, and a cube has four.
    /// - Each contact is where the gap is least: there the unit gradients of both bodies have a sum of length
    ///   1e-6 at most, whatever the tolerance. Along a direction in which the gap has no least point, as
    ///   on flat faces, the contact spans the patch. At an edge the normal is that of the other body's face.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_query::{Limits, ManifoldSettings, PairWorkspace, manifold};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)?;
    /// let settings = ManifoldSettings::for_solver(1.0);
    /// let limits = Limits::new(settings.usual_tolerance());
    /// let mut workspace = PairWorkspace::new();
    /// let ball = Shape::ball(0.5)?.translated([0.0, 0.499, 0.0])?;
    /// let under_ball = manifold(&floor, &ball, &settings, &limits, &mut workspace)?;
    /// assert_eq!(under_ball.contacts.len(), 1);
    /// let cube = Shape::cuboid([1.0, 1.0, 1.0])?.translated([0.0, 0.499, 0.0])?;
    /// let under_cube = manifold(&floor, &cube, &settings, &limits, &mut workspace)?;
    /// assert_eq!(under_cube.contacts.len(), 4);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub const fn for_solver(size: f64) -> Self {
        Self {
            margin: 0.01 * size,
            spacing: 0.08 * size,
            most: 32,
            solver_slop: Some(0.002 * size),
        }
    }
}

/// The contacts of two bodies.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Manifold<const D: usize> {
    /// The contacts, by group; in each group the deepest comes first, by the fields' values.
    pub contacts: Vec<Contact<D>>,
    /// The number of contacts in each group. A group is one patch with like normals.
    pub groups: Vec<usize>,
    /// The separation. Its point is the deepest contact, except when (a) the separation exceeds the
    /// margin, (b) the contact was moved to an edge, or (c) [`normal_from`](Contact::normal_from) is not
    /// the gradients. Its evaluations are those of both searches; steps to points of surfaces do not
    /// count.
    pub separation: Certified<Nearest<D>>,
    /// The distance of the bodies is at most this [m]: zero if they overlap, the separation where both
    /// fields are exact outside, else that of two points found in the bodies. Infinite where none of
    /// these is known, as a separation made of bounds does not tell how far the bodies are apart at most,
    /// and of bodies that are proven farther apart than the margin.
    pub distance_at_most: f64,
    /// How many contacts were left out beyond the most that were asked for.
    pub dropped: usize,
    /// `false` if the search ended before it had seen the whole region, or bounds leave thin parts
    /// of it open.
    pub is_whole: bool,
    /// Why the search of the region ended: `converged` if it is whole.
    pub region_stop: Stop,
}

/// Contacts that span the region in which two bodies touch, up to a gap of
/// `settings.margin`.
///
/// The search finds the separation to `limits.tolerance` first, and stops with no contacts once it
/// is proven to exceed the margin. The deepest point is certified. No part of the region is farther
/// than two spacings from the convex hull of the contacts, or [`is_whole`](Manifold::is_whole) is
/// `false`; unless more contacts than asked for were left out.
/// [`Track::manifold`](crate::Track::manifold) keeps the ids of contacts from step to step.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Cuboid};
/// use palpate_query::{Limits, ManifoldSettings, PairWorkspace, Placed, manifold};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let table = Shape::from_kernel(Cuboid::new(Vector([1.2, 0.8, 0.6]))?);
/// let cube = Shape::from_kernel(Cuboid::new(Vector([0.4, 0.4, 0.4]))?);
/// // One millimetre into its top.
/// let there = Placed::new(&cube, Pose::translation(Vector([0.1, 0.0, 0.499])));
/// let limits = Limits::new(1e-3);
/// let settings = ManifoldSettings::of_size(1.0);
/// let touching = manifold(&table, there, &settings, &limits, &mut PairWorkspace::new())?;
/// assert_eq!(touching.groups.len(), 1);
/// for contact in &touching.contacts {
///     assert!((contact.gap + 0.001).abs() < 1e-4);
///     assert!((contact.normal - Vector([0.0, 0.0, 1.0])).norm() < 1e-6);
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, or a pose, the margin, the spacing or the tolerance is NaN or out of range.
pub fn manifold<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    settings: &ManifoldSettings,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Manifold<D>, QueryError> {
    settings.check()?;
    let pair = BodyPair::new(a.into(), b.into())?;
    let goal = settings.goal(limits);
    let mut search = PairSearch::new(pair, goal, limits)?;
    let separation = search.run(workspace);
    let budget = limits.budget;
    let separated = SeparatedPair { pair, best: search.best, separation };
    Ok(spanning(separated, settings, budget, workspace))
}

/// The deepest contact of two bodies, as a manifold has it, from where their separation is found; and
/// how often fields were evaluated.
#[inline(never)]
pub(crate) fn deepest<const D: usize>(
    a: Placed<'_, D>,
    b: Placed<'_, D>,
    nearest: &Nearest<D>,
    margin: f64,
) -> Result<(Contact<D>, u32), QueryError> {
    let mut pair = BodyPair::new(a, b)?;
    let settings =
        ManifoldSettings { margin, ..ManifoldSettings::of_size(pair.smaller_size()) };
    let there = pair.world_from_frame.inverse().transform_point(nearest.point);
    let touch = Touch::at(&mut pair, there);
    let touch = touch.along_surface(&mut pair, &settings).unwrap_or(touch);
    Ok((touch.contact(&pair, settings.spacing), pair.evaluations))
}

/// A pair whose separation was found at the point `best`, in its frame.
pub(crate) struct SeparatedPair<'a, const D: usize> {
    pub(crate) pair: BodyPair<'a, D>,
    pub(crate) best: Point<D>,
    pub(crate) separation: Certified<Nearest<D>>,
}

/// The manifold of a pair.
#[inline(never)]
pub(crate) fn spanning<const D: usize>(
    mut separated: SeparatedPair<'_, D>,
    settings: &ManifoldSettings,
    budget: u32,
    workspace: &mut PairWorkspace<D>,
) -> Manifold<D> {
    if separated.separation.lower > settings.margin {
        return Manifold::apart(separated.separation);
    }
    let spanned = Spanned::find(&mut separated, settings, budget, workspace);
    spanned.manifold(&separated, settings)
}

/// Points that span the region in which two bodies touch, in the pair's frame, the deepest first.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Spanned<const D: usize> {
    members: Vec<Member<D>>,
    /// Points that span parts of the region where the gap exceeds the margin, of a search that went
    /// farther.
    beyond: Vec<Member<D>>,
    /// Why the search of the region ended.
    stop: Stop,
}

impl<const D: usize> Spanned<D> {
    pub(crate) fn find(
        separated: &mut SeparatedPair<'_, D>,
        settings: &ManifoldSettings,
        budget: u32,
        workspace: &mut PairWorkspace<D>,
    ) -> Self {
        let SeparatedPair { pair, best, .. } = separated;
        let first = Touch::at(pair, *best);
        let mut region = region::find(pair, settings, budget, workspace, first);
        if region.candidates.len() > 1 && first.gap > settings.margin {
            // It is beside the region, and would be no contact in its corner.
            region.candidates.remove(0);
        }
        let mut patches = Patches { pair: *pair, settings, candidates: &region.candidates };
        let mut members = patches.contacts();
        patches.fill(&mut region.middles, &mut members);
        *pair = patches.pair;
        drop_copies(&mut members, settings.spacing);
        let members = whole(pair, settings, (budget, workspace), members, &mut region);
        Self { members, beyond: Vec::new(), stop: region.stop }
    }

    /// The same, with what spans the parts of the region up to a gap of `farther` margins, which bodies
    /// that move on come to.
    pub(crate) fn find_farther(
        separated: &mut SeparatedPair<'_, D>,
        settings: &ManifoldSettings,
        farther: f64,
        budget: u32,
        workspace: &mut PairWorkspace<D>,
    ) -> Self {
        let found = Self::find(separated, settings, budget, workspace);
        let wider = ManifoldSettings { margin: farther * settings.margin, ..*settings };
        let SeparatedPair { pair, best, .. } = separated;
        let first = Touch::at(pair, *best);
        let Region { mut candidates, mut middles, stop, .. } =
            region::find(pair, &wider, budget, workspace, first);
        candidates.retain(|touch| touch.gap > settings.margin);
        let mut patches = Patches { pair: *pair, settings: &wider, candidates: &candidates };
        let groups = found.members.iter().map(|member| member.group + 1).max().unwrap_or(0);
        let count = found.members.len();
        let mut all = found.members;
        all.extend(
            patches
                .contacts()
                .into_iter()
                .map(|member| Member { group: groups + member.group, ..member }),
        );
        patches.fill(&mut middles, &mut all);
        *pair = patches.pair;
        let mut beyond = all.split_off(count);
        drop_copies(&mut beyond, settings.spacing);
        let is_new = |member: &Member<D>| {
            all.iter().all(|other| !is_copy(&other.touch, &member.touch, settings.spacing))
        };
        beyond.retain(is_new);
        let stop = if found.stop.is_early() { found.stop } else { stop };
        Self { members: all, beyond, stop }
    }

    /// The points that span the region, the deepest first.
    pub(crate) fn touches(&self) -> impl Iterator<Item = &Touch<D>> {
        self.members.iter().map(|member| &member.touch)
    }

    /// Whether the search ended before it had seen the whole region.
    pub(crate) fn is_cut_off(&self) -> bool {
        self.stop.is_early()
    }

    /// The manifold of those points whose gap is within the margin.
    pub(crate) fn manifold(
        &self,
        separated: &SeparatedPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Manifold<D> {
        let (mut pair, is_whole) = (separated.pair, !self.is_cut_off());
        let mut found = Manifold {
            is_whole,
            region_stop: self.stop,
            ..Manifold::apart(separated.separation)
        };
        if let Some(deepest) = self.members.first() {
            found.deepen(&deepest.touch, &mut pair);
        }
        if let Some(slop) = settings.solver_slop {
            found.keep_for_solver(&self.members, &mut pair, (settings, slop));
            found.bound_distance(&mut pair, separated, (&self.members, settings));
            return found;
        }
        let mut members = self.members.clone();
        let mut are_moved = false;
        for member in &mut members {
            if let Some(touch) = member.touch.along_surface(&mut pair, settings) {
                (member.touch, are_moved) = (touch, true);
            }
        }
        if are_moved {
            // Several lead to one deepest point. To drop more would leave parts of the region out.
            drop_inner_copies(&mut members, settings);
        }
        found.bound_distance(&mut pair, separated, (&self.members, settings));
        let contact = |member: &Member<D>| member.touch.contact(&pair, settings.spacing);
        let spanning = members.iter().map(|member| (*member, contact(member)));
        found.keep(spanning.collect(), settings);
        found
    }
}

impl<const D: usize> Manifold<D> {
    /// Of bodies that are farther apart than the margin.
    pub(crate) fn apart(separation: Certified<Nearest<D>>) -> Self {
        Self {
            contacts: Vec::new(),
            groups: Vec::new(),
            separation,
            distance_at_most: f64::INFINITY,
            dropped: 0,
            is_whole: true,
            region_stop: Stop::Converged,
        }
    }

    /// Whether the bodies touch, up to `margin` [m]: what the bounds of their separation and of their
    /// distance prove.
    #[must_use]
    pub fn verdict(&self, margin: f64) -> Verdict {
        Verdict::of_bounds([self.separation.lower, self.distance_at_most], margin)
    }

    /// Keeps the contacts within the margin, the deepest first.
    fn keep(
        &mut self,
        mut spanning: Vec<(Member<D>, Contact<D>)>,
        settings: &ManifoldSettings,
    ) {
        // Where a field is a bound, surfaces may be farther apart than its values.
        let mut is_deepest = true;
        spanning.retain(|(_, contact)| {
            std::mem::take(&mut is_deepest) || contact.gap <= settings.margin
        });
        self.dropped = spanning.len().saturating_sub(settings.most.max(1));
        keep_spread(&mut spanning, settings.most.max(1));
        spanning.sort_by(|(one, _), (other, _)| {
            one.group.cmp(&other.group).then(one.touch.gap.total_cmp(&other.touch.gap))
        });
        for (i, (member, contact)) in spanning.iter().enumerate() {
            if i == 0 || spanning[i - 1].0.group != member.group {
                self.groups.push(0);
            }
            if let Some(count) = self.groups.last_mut() {
                *count += 1;
            }
            self.contacts.push(contact.with_id(i as u64));
        }
    }

    /// Bounds the distance, and counts the evaluations of the pair.
    fn bound_distance(
        &mut self,
        pair: &mut BodyPair<'_, D>,
        separated: &SeparatedPair<'_, D>,
        (members, settings): (&[Member<D>], &ManifoldSettings),
    ) {
        let places = members.iter().map(|member| member.touch.point);
        let places = std::iter::once(separated.best).chain(places);
        let upper = self.separation.upper;
        self.distance_at_most = pair.distance_at_most(upper, places, settings.margin);
        self.separation.evaluations += pair.evaluations;
    }

    /// Keeps the contacts that a solver needs.
    fn keep_for_solver(
        &mut self,
        members: &[Member<D>],
        pair: &mut BodyPair<'_, D>,
        (settings, slop): (&ManifoldSettings, f64),
    ) {
        let mut offers = Vec::with_capacity(members.len());
        for (i, member) in members.iter().enumerate() {
            let found = polished(pair, &member.touch, i == 0, &mut Polish::default(), settings)
                .unwrap_or_else(|| member.touch.usual(pair, settings));
            let contact = found.contact.placed(&pair.world_from_frame).with_id(i as u64);
            // Where a field is a bound, surfaces may be farther apart than its values.
            if i == 0 || contact.gap <= settings.margin {
                let is_slope = found.is_slope;
                offer(&mut offers, Offer { contact, is_held: false, is_slope }, settings);
            }
        }
        let chosen = (&mut self.contacts, &mut self.groups);
        self.dropped = choose(&mut offers, settings, slop, chosen);
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            *contact = contact.with_id(i as u64);
        }
    }

    /// Chooses and groups the contacts anew, whose normals history has changed.
    pub(crate) fn regroup(&mut self, settings: &ManifoldSettings, slop: f64) {
        let mut offers = Vec::with_capacity(self.contacts.len());
        for contact in self.contacts.drain(..) {
            let is_held = contact.age > 0;
            offer(&mut offers, Offer { contact, is_held, is_slope: false }, settings);
        }
        self.groups.clear();
        let chosen = (&mut self.contacts, &mut self.groups);
        self.dropped += choose(&mut offers, settings, slop, chosen);
    }

    /// Takes a contact as the best point if it is deeper by the fields' values.
    fn deepen(&mut self, deepest: &Touch<D>, pair: &mut BodyPair<'_, D>) {
        let slack = pair.slack(deepest.point.norm() + deepest.gap.abs());
        let upper = pair.gap_at(deepest.point) + 2.0 * slack;
        if upper < self.separation.upper {
            let pose = &pair.world_from_frame;
            self.separation.best = Nearest {
                point: pose.transform_point(deepest.point),
                normal: Some(pose.transform_vector(deepest.normal)),
            };
            self.separation.upper = upper;
            self.separation.lower = self.separation.lower.min(upper);
        }
    }
}

impl ManifoldSettings {
    /// The tolerance of the separation that serves these settings [m]: half of the margin, or of the slop
    /// of a solver if that is less.
    ///
    /// ```
    /// use palpate_query::ManifoldSettings;
    ///
    /// let settings = ManifoldSettings { margin: 1e-3, ..ManifoldSettings::of_size(0.1) };
    /// assert_eq!(settings.usual_tolerance(), 5e-4);
    /// ```
    #[must_use]
    pub fn usual_tolerance(&self) -> f64 {
        0.5 * self.solver_slop.map_or(self.margin, |slop| slop.min(self.margin))
    }

    /// The separation, if it is within the margin.
    pub(crate) fn goal(&self, limits: &Limits) -> Goal {
        Goal::separation_within(self.margin, limits)
    }

    pub(crate) fn check(&self) -> Result<(), QueryError> {
        QueryError::check_length(self.margin)?;
        let is_size = self.spacing > 0.0 && self.spacing <= LARGEST_LENGTH;
        if !is_size {
            return Err(QueryError::Setting { what: "spacing", value: self.spacing });
        }
        if let Some(slop) = self.solver_slop {
            QueryError::check_length(slop)?;
        }
        Ok(())
    }

    /// The length of which precisions are shares [m]: the margin, or a share of the spacing if
    /// that is more.
    fn precision_length(&self) -> f64 {
        self.margin.max(SHALLOW * self.spacing)
    }
}

/// A point between two bodies, in the pair's frame.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Touch<const D: usize> {
    pub(crate) point: Point<D>,
    pub(crate) normal: Vector<f64, D>,
    pub(crate) gap: f64,
    source: NormalSource,
}

/// A contact and its patch.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Member<const D: usize> {
    touch: Touch<D>,
    group: usize,
}

impl<const D: usize> Touch<D> {
    /// The touch at a point. Where no gradient gives a normal, the line between the bodies'
    /// centres does, if they differ.
    fn at(pair: &mut BodyPair<'_, D>, point: Point<D>) -> Self {
        let (normal, [a, b]) = pair.normal(point);
        let (normal, source) = match normal {
            Some(normal) => (normal, NormalSource::Gradients),
            None => {
                let between = pair.between_centres().normalized();
                (between.unwrap_or_else(arbitrary), NormalSource::Assumed)
            }
        };
        Self { point, normal, gap: 2.0 * a.max(b), source }
    }

    /// The touch along the surface of one body, where gradients of both lead elsewhere: in a thin body, and
    /// at an edge. `None` where they do not.
    fn along_surface(
        &self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        if self.source == NormalSource::ThickerBody {
            return None;
        }
        let on_face = |pair| self.on_face(pair, settings).map(|(_, touch)| touch);
        patch::pushed(pair, self, settings).or_else(|| on_face(pair))
    }

    /// The touch at a face of one body where the other has an edge: along the face's normal, and where
    /// the bodies are apart, from the edge. And which body has the face.
    fn on_face(
        &self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Option<(usize, Self)> {
        if self.source != NormalSource::Gradients {
            return None;
        }
        let slopes = pair.slopes(self.point);
        let Face { body, normal } = pair.face(self.point, slopes)?;
        let turned = Self { normal, ..*self };
        if self.gap <= 0.0 {
            // The edge is deeper along the normal than the widest ball in the overlap is wide.
            // A longer step would lead along the edge.
            let first = (self.point, EDGE * self.gap.abs());
            let deepest = patch::in_host(pair, body, first, settings);
            let deepest = deepest.filter(|found| found.gap <= self.gap);
            let touch =
                deepest.map_or(turned, |Self { point, gap, .. }| Self { point, gap, ..turned });
            return Some((body, touch));
        }
        let near = settings.spacing.max(self.gap);
        let edge = pair.surface_point(1 - body, self.point)?;
        let gap = pair.slopes(edge)[body].0;
        let to_face = if body == 0 { -normal } else { normal };
        let point = edge + to_face * (0.5 * gap);
        (distance(edge, self.point) <= near).then_some((body, Self { point, gap, ..turned }))
    }

    /// The same touch at another place.
    pub(crate) fn at_place(self, point: Point<D>) -> Self {
        Self { point, ..self }
    }

    /// The contact in world coordinates, where the bodies overlap no less deep than the values say.
    /// Points of the surfaces count only within `near` and 45° of the normal: in the middle of a body
    /// the gradient may lead to any side.
    pub(crate) fn contact(&self, pair: &BodyPair<'_, D>, near: f64) -> Contact<D> {
        self.contact_in_frame(pair, near).placed(&pair.world_from_frame)
    }

    fn contact_in_frame(&self, pair: &BodyPair<'_, D>, near: f64) -> Contact<D> {
        let near = near.max(2.0 * self.gap.abs());
        let by_values = Contact::estimated(self.point, self.normal, self.gap);
        let is_near = |p: &Point<D>| {
            let away = *p - self.point;
            let along = away.dot(self.normal);
            away.norm() <= near && 2.0 * along * along >= away.dot(away)
        };
        let on = |body: usize| pair.surface_point(body, self.point).filter(is_near);
        let by_surfaces = || Some(Contact::new(on(0)?, on(1)?, self.normal));
        // Of an edge in a corner, the nearest points of the surfaces are not along the normal: a solver
        // that closes their distance along it would leave the bodies in each other.
        let is_deep = |contact: &Contact<D>| self.gap >= 0.0 || contact.gap <= self.gap;
        let contact = match self.source {
            NormalSource::ThickerBody | NormalSource::History => by_values,
            _ => by_surfaces().filter(is_deep).unwrap_or(by_values),
        };
        contact.with_normal_from(self.source)
    }
}

/// The contacts, with further ones where they leave out a part of the region: a candidate, or what is in
/// a box that may hold a part of it.
fn whole<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    settings: &ManifoldSettings,
    (budget, workspace): (u32, &mut PairWorkspace<D>),
    members: Vec<Member<D>>,
    region: &mut Region<D>,
) -> Vec<Member<D>> {
    let mut members = members;
    let mut patches = Patches { pair: *pair, settings, candidates: &region.candidates };
    patches.cover(&region.candidates, &mut members);
    *pair = patches.pair;
    let mut doubtful = std::mem::take(&mut region.doubtful);
    doubtful.retain(|cell| cover::is_box_left_out(cell, &members, settings.spacing));
    if !doubtful.is_empty() {
        let found = region.decide(pair, settings, (budget, workspace), (doubtful, &members));
        let mut patches = Patches { pair: *pair, settings, candidates: &region.candidates };
        patches.cover(&found, &mut members);
        *pair = patches.pair;
    }
    members
}

/// Whether two contacts are next to each other, with like normals.
fn is_copy<const D: usize>(one: &Touch<D>, other: &Touch<D>, spacing: f64) -> bool {
    distance(one.point, other.point) < COPIES * spacing && one.normal.dot(other.normal) > LIKE
}

/// Sorts contacts from the deepest, and drops those next to a deeper one with a like
/// normal.
fn drop_copies<const D: usize>(touches: &mut Vec<Member<D>>, spacing: f64) {
    touches.sort_by(|one, other| one.touch.gap.total_cmp(&other.touch.gap));
    keep_first(touches, spacing);
}

/// Drops contacts that are nearer than a spacing to a deeper one with a like normal, or to one as deep that
/// is farther out: the ends of an edge stay. The deepest comes first.
fn drop_inner_copies<const D: usize>(
    touches: &mut Vec<Member<D>>,
    settings: &ManifoldSettings,
) {
    // Of those at about one place the deepest stays.
    drop_copies(touches, ONE_PLACE * settings.spacing);
    let gap = |member: &Member<D>| member.touch.gap;
    let deepest = touches.iter().map(gap).fold(f64::INFINITY, f64::min);
    let precise = patch::DEEP_PRECISE * settings.precision_length();
    let level = |member: &Member<D>| ((gap(member) - deepest) / precise).floor();
    let share = 1.0 / touches.len() as f64;
    let centre =
        touches.iter().fold(Vector::ZERO, |sum, member| sum + member.touch.point * share);
    let apart = |member: &Member<D>| distance(member.touch.point, centre);
    touches.sort_by(|one, other| {
        let is_deeper = level(one).total_cmp(&level(other));
        is_deeper.then(apart(other).total_cmp(&apart(one)))
    });
    keep_first(touches, settings.spacing / COPIES);
    let first =
        (0..touches.len()).min_by(|&i, &k| gap(&touches[i]).total_cmp(&gap(&touches[k])));
    if let Some(first) = first {
        touches.swap(0, first);
    }
}

/// Drops contacts next to one before them with a like normal.
fn keep_first<const D: usize>(touches: &mut Vec<Member<D>>, spacing: f64) {
    let mut kept = 0;
    for i in 0..touches.len() {
        let touch = touches[i].touch;
        if !touches[..kept].iter().any(|other| is_copy(&other.touch, &touch, spacing)) {
            touches.swap(kept, i);
            kept += 1;
        }
    }
    touches.truncate(kept);
}

/// Keeps the first `most` contacts in this order: the first, and then always the one
/// that is farthest from those kept.
fn keep_spread<const D: usize>(touches: &mut Vec<(Member<D>, Contact<D>)>, most: usize) {
    if touches.len() <= most {
        return;
    }
    // How far each is from those kept.
    let mut apart = vec![f64::INFINITY; touches.len()];
    for kept in 1..most {
        let last = touches[kept - 1].0.touch.point;
        for (apart, (member, _)) in apart.iter_mut().zip(&*touches).skip(kept) {
            *apart = apart.min(distance(last, member.touch.point));
        }
        let farthest = (kept..touches.len())
            .max_by(|&i, &k| apart[i].total_cmp(&apart[k]).then(k.cmp(&i)));
        if let Some(farthest) = farthest {
            touches.swap(kept, farthest);
            apart.swap(kept, farthest);
        }
    }
    touches.truncate(most);
}
