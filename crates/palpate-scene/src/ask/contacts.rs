// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the bodies of a scene touch.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::atomic::AtomicBool;

use palpate_field::Vector;
use palpate_query::{
    Contact, Limits, ManifoldSettings, Neighbours, NormalSource, PairWorkspace, Placed, Proof,
    Stop, Verdict, World, WorldSettings, penetration, proof, separation,
};
use serde::{Deserialize, Serialize};

use super::{AskError, FEW_PAIRS, is_set, pairs_of, write_bound_fields};
use crate::build::{BuiltBody, BuiltScene};
use crate::emptiness::is_empty;
use crate::text::{counted, decimal, decimals, shown};

/// Where do bodies touch?
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ContactsQuestion {
    /// Only pairs with one of these bodies; all pairs if there are none.
    pub bodies: Vec<String>,
    /// Whether pairs that are apart are listed too, with the bounds of their separation. They
    /// always are where at most [`FEW_PAIRS`] pairs are asked about.
    pub every_pair: bool,
    /// The largest gap at which bodies count as touching [m]; 0.2 % of the smallest body if left
    /// out.
    pub margin: Option<f64>,
    /// The size of the smallest boxes in a region of contact [m]; 4 % of the smallest body if
    /// left out.
    pub spacing: Option<f64>,
    /// How far apart the bounds of a separation may be [m]. Default: half of `margin`; if
    /// `margin` is zero, half of the default margin.
    pub tolerance: Option<f64>,
    /// The most evaluations of fields in each search: a pair takes one for its separation and one for
    /// its contacts. Default: 200 000 ([`Limits::BUDGET`]).
    pub budget: Option<u32>,
    /// The time at which motions have moved the bodies [s]; their own poses if left out.
    pub time: Option<f64>,
    /// Whether the boxes that prove each separation are wanted.
    pub proof: bool,
}

/// Where the bodies of a scene touch.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ContactsAnswer<const D: usize> {
    /// The largest gap at which bodies count as touching [m].
    pub margin: f64,
    /// The size of the smallest boxes in a region of contact [m].
    pub spacing: f64,
    /// How far apart the bounds of a separation may be [m].
    pub tolerance: f64,
    /// The most evaluations in each search: of a separation, or of contacts.
    pub budget: u32,
    /// The time that was asked about [s].
    pub time: Option<f64>,
    /// Whether no body of the scene moves.
    pub still: bool,
    /// The names of all bodies.
    pub bodies: Vec<String>,
    /// Bodies that are proven to have no point.
    pub empty: Vec<String>,
    /// Bodies whose fields are bounds outside: separations from others are lower bounds of
    /// distances.
    pub bound_fields: Vec<String>,
    /// How many pairs were asked about.
    pub asked: usize,
    /// How many pairs touch.
    pub touching: usize,
    /// How many pairs are apart, listed or not.
    pub apart: usize,
    /// For how many pairs neither is proven.
    pub undecided: usize,
    /// The pairs that touch or may touch, and those that are apart if they are listed.
    pub pairs: Vec<PairContacts<D>>,
    /// Whether no pair is missing; `false` if the search was stopped.
    pub is_whole: bool,
}

/// The share of the budget that the penetration of a pair may take: of bodies that are not convex its
/// bounds come together slowly.
const SHARE_OF_PENETRATION: u32 = 10;

/// The bounds of the separation of two bodies. It is negative if they overlap: then it is minus the
/// diameter of the largest ball in both, and not the penetration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Separation {
    /// The separation is at least this [m].
    pub lower: f64,
    /// The separation is at most this [m].
    pub upper: f64,
    /// Why the search ended.
    pub stop: Stop,
    /// How often the fields were evaluated, contacts included.
    pub evaluations: u32,
}

/// The bounds of the penetration of two bodies that overlap: how far the second must move to leave the
/// first, by the shortest way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct PenetrationBounds<const D: usize> {
    /// No shorter translation separates the bodies [m].
    pub lower: f64,
    /// A translation of this length separates them [m]; `None` if none was found.
    pub upper: Option<f64>,
    /// The unit vector along which it does.
    pub direction: Option<Vector<f64, D>>,
    /// Why the search ended.
    pub stop: Stop,
    /// How often the fields were evaluated.
    pub evaluations: u32,
}

/// What is known of two bodies.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct PairContacts<const D: usize> {
    /// Their names.
    pub bodies: [String; 2],
    /// Their places in the scene.
    #[serde(skip)]
    pub indices: [usize; 2],
    /// Whether they touch.
    pub verdict: Verdict,
    /// The one that is proven to have no point: nothing touches it.
    pub empty: Option<String>,
    /// Their separation; `None` if neither has bounds, or one has no point.
    pub separation: Option<Separation>,
    /// Their penetration; `None` if they are not proven to overlap.
    pub penetration: Option<PenetrationBounds<D>>,
    /// Their distance is at most this, if anything is known [m].
    pub distance_at_most: Option<f64>,
    /// Where they touch or may touch.
    pub contacts: Vec<Contact<D>>,
    /// Of bodies that are apart, the points that are nearest each other, if they were found.
    pub witness: Option<Contact<D>>,
    /// How many contacts each patch has.
    pub groups: Vec<usize>,
    /// How many contacts were dropped.
    pub dropped: usize,
    /// Why the search of the region of contact ended.
    pub region_stop: Stop,
    /// The boxes that prove the separation, if they were asked for.
    pub proof: Option<Proof<D>>,
}

impl ContactsQuestion {
    /// The settings of the search in a scene. Lengths that are left out are shares of the
    /// smallest body.
    #[must_use]
    pub fn settings<const D: usize>(&self, scene: &BuiltScene<D>) -> WorldSettings {
        let usual = scene.world_settings().manifold;
        let margin = self.margin.unwrap_or(usual.margin);
        let spacing = self.spacing.unwrap_or(usual.spacing);
        let precise = if margin > 0.0 { margin } else { usual.margin };
        let tolerance = (ManifoldSettings { margin: precise, ..usual }).usual_tolerance();
        let limits = Limits::new(self.tolerance.unwrap_or(tolerance))
            .with_budget(self.budget.unwrap_or(Limits::BUDGET));
        WorldSettings::new(ManifoldSettings { margin, spacing, ..usual }, limits)
    }

    pub(super) fn answer<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        stop: &AtomicBool,
    ) -> Result<ContactsAnswer<D>, AskError> {
        if let [body] = scene.bodies.as_slice() {
            return Err(AskError::Refused(format!(
                "contact is about two bodies or more, and the scene has only {:?}; add another to \
                 its `bodies`",
                body.name
            )));
        }
        let settings = self.settings(scene);
        let bodies = scene.numbers_of(&self.bodies)?;
        let still = scene.motions.is_empty();
        let scene = match self.time {
            Some(time) => Cow::Owned(scene.at(time)?),
            None => Cow::Borrowed(scene),
        };
        let asked = pairs_of(scene.bodies.len(), bodies.len());
        let search = Search {
            scene: &scene,
            settings,
            empty: scene
                .bodies
                .iter()
                .map(|body| is_empty(&body.shape_in_body) == Some(true))
                .collect(),
            bodies: &bodies,
        };
        let is_every = self.every_pair || asked <= FEW_PAIRS;
        let (mut pairs, is_whole) = search.pairs(is_every, stop)?;
        if self.proof {
            for pair in pairs.iter_mut().filter(|pair| pair.separation.is_some()) {
                pair.proof = Some(search.proof(pair.indices)?);
            }
        }
        let count = |verdict| pairs.iter().filter(|pair| pair.verdict == verdict).count();
        let (touching, undecided) = (count(Verdict::Touching), count(Verdict::Undecided));
        let empty = scene.bodies.iter().zip(&search.empty).filter(|(_, is_empty)| **is_empty);
        Ok(ContactsAnswer {
            margin: settings.manifold.margin,
            spacing: settings.manifold.spacing,
            tolerance: settings.limits.tolerance,
            budget: settings.limits.budget,
            time: self.time,
            still,
            bodies: scene.names(),
            empty: empty.map(|(body, _)| body.name.clone()).collect(),
            bound_fields: scene.bound_fields(),
            asked,
            touching,
            apart: asked - touching - undecided,
            undecided,
            pairs,
            is_whole,
        })
    }
}

/// A search for contacts in a scene.
struct Search<'a, const D: usize> {
    scene: &'a BuiltScene<D>,
    settings: WorldSettings,
    /// Which bodies are proven to have no point.
    empty: Vec<bool>,
    /// Only pairs with one of these; all if there are none.
    bodies: &'a [usize],
}

impl<const D: usize> Search<'_, D> {
    /// The pairs that touch or are undecided; if wanted, those that are apart too, and whether
    /// all of them are here.
    fn pairs(
        &self,
        is_every: bool,
        stop: &AtomicBool,
    ) -> Result<(Vec<PairContacts<D>>, bool), AskError> {
        let mut world = self.world()?;
        let near = world.step().into_iter();
        let mut pairs: Vec<_> = near.map(|found| self.near(found)).collect();
        for pair in &mut pairs {
            if is_set(stop) {
                return Ok((pairs, false));
            }
            if pair.separation.is_some_and(|found| found.upper < 0.0) {
                pair.penetration = Some(self.penetration(pair.indices)?);
            }
        }
        if !is_every {
            return Ok((pairs, true));
        }
        let ids = world.bodies().collect::<Vec<_>>();
        let known: BTreeSet<[usize; 2]> = pairs.iter().map(|pair| pair.indices).collect();
        let all = (0..ids.len()).flat_map(|k| (0..k).map(move |i| [i, k]));
        for indices @ [i, k] in all {
            if !self.asks_about(indices) || known.contains(&indices) {
                continue;
            }
            if is_set(stop) {
                return Ok((pairs, false));
            }
            pairs.push(match indices.into_iter().find(|body| self.empty[*body]) {
                Some(empty) => PairContacts {
                    empty: Some(self.scene.bodies[empty].name.clone()),
                    ..self.pair(indices, Verdict::Apart)
                },
                None => self.apart(indices, world.lower_bound(ids[i], ids[k])?)?,
            });
        }
        Ok((pairs, true))
    }

    fn asks_about(&self, pair: [usize; 2]) -> bool {
        self.bodies.is_empty() || pair.iter().any(|body| self.bodies.contains(body))
    }

    fn world(&self) -> Result<World<D>, AskError> {
        let mut world = self.scene.world_with(self.settings)?;
        for (i, id) in world.bodies().collect::<Vec<_>>().into_iter().enumerate() {
            // Bodies of the second group touch those of the first alone, empty ones none.
            let is_asked = self.bodies.is_empty() || self.bodies.contains(&i);
            let (groups, mask) = match (self.empty[i], is_asked) {
                (true, _) => (0, 0),
                (false, true) => (1, u32::MAX),
                (false, false) => (2, 1),
            };
            world.set_groups(id, groups, mask)?;
        }
        Ok(world)
    }

    /// A pair about which nothing but the verdict is known.
    fn pair(&self, indices: [usize; 2], verdict: Verdict) -> PairContacts<D> {
        PairContacts {
            bodies: indices.map(|body| self.scene.bodies[body].name.clone()),
            indices,
            verdict,
            empty: None,
            separation: None,
            penetration: None,
            distance_at_most: None,
            contacts: Vec::new(),
            witness: None,
            groups: Vec::new(),
            dropped: 0,
            region_stop: Stop::Converged,
            proof: None,
        }
    }

    /// A pair that the world found.
    fn near(&self, found: &Neighbours<D>) -> PairContacts<D> {
        let verdict = found.verdict(self.settings.manifold.margin);
        let mut pair = self.pair(found.bodies.map(|body| body.index()), verdict);
        if verdict == Verdict::Apart {
            pair.witness = found.contacts().first().copied();
        } else {
            pair.contacts = found.contacts().to_vec();
        }
        if let Some(manifold) = &found.manifold {
            let found = manifold.separation;
            pair.separation = Some(Separation {
                lower: found.lower,
                upper: found.upper,
                stop: found.stop,
                evaluations: found.evaluations,
            });
            let at_most = manifold.distance_at_most;
            pair.distance_at_most = at_most.is_finite().then_some(at_most);
            pair.groups.clone_from(&manifold.groups);
            pair.dropped = manifold.dropped;
            pair.region_stop = manifold.region_stop;
        }
        pair
    }

    /// A pair that the world did not find near, and a `lower` bound of its separation that is
    /// known.
    fn apart(&self, indices: [usize; 2], lower: f64) -> Result<PairContacts<D>, AskError> {
        let [a, b] = indices.map(|i| placed(&self.scene.bodies[i]));
        let found = separation(a, b, &self.settings.limits, &mut PairWorkspace::new())?;
        // What is proven stays proven, whatever the budget allowed now.
        let lower = found.lower.max(lower);
        // The world finds all pairs that touch.
        let verdict = Verdict::of_bounds([lower, f64::INFINITY], self.settings.manifold.margin);
        let mut pair = self.pair(indices, verdict);
        pair.witness = found.best.contact(a, b);
        let (upper, stop, evaluations) = (found.upper, found.stop, found.evaluations);
        pair.separation = Some(Separation { lower, upper, stop, evaluations });
        Ok(pair)
    }

    /// The penetration of two bodies.
    fn penetration(&self, indices: [usize; 2]) -> Result<PenetrationBounds<D>, AskError> {
        let [a, b] = indices.map(|i| placed(&self.scene.bodies[i]));
        let limits = self.settings.limits;
        let limits = limits.with_budget(limits.budget / SHARE_OF_PENETRATION);
        let found = penetration(a, b, &limits, &mut PairWorkspace::new())?;
        let (lower, stop, evaluations) = (found.lower, found.stop, found.evaluations);
        let upper = found.upper.is_finite().then_some(found.upper);
        let direction = found.best.direction;
        Ok(PenetrationBounds { lower, upper, direction, stop, evaluations })
    }

    /// The separation of two bodies with its proof.
    fn proof(&self, indices: [usize; 2]) -> Result<Proof<D>, AskError> {
        let [a, b] = indices.map(|i| placed(&self.scene.bodies[i]));
        Ok(proof(a, b, &self.settings.limits, &mut PairWorkspace::new())?)
    }
}

fn placed<const D: usize>(body: &BuiltBody<D>) -> Placed<'_, D> {
    Placed::new(&body.shape_in_body, body.world_from_body)
}

impl<const D: usize> fmt::Display for ContactsAnswer<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(time) = self.time {
            let still = if self.still { ", as at any time: no body moves" } else { "" };
            writeln!(f, "at {time} s{still}")?;
        }
        for pair in &self.pairs {
            self.write_pair(f, pair)?;
        }
        let is_open = |found: Separation| found.upper - found.lower > self.tolerance;
        if self.pairs.iter().any(|pair| pair.separation.is_some_and(is_open)) {
            writeln!(
                f,
                "Each separation lies between its bounds; of searches that ended early they may \
                 be farther apart than the tolerance, {} mm.",
                millimetres(self.tolerance)
            )?;
        }
        if self.pairs.iter().any(|pair| pair.penetration.is_some()) {
            writeln!(
                f,
                "Of bodies that overlap, the separation is minus the diameter of the largest ball in \
                 both, and not the penetration, which is the shortest way out."
            )?;
        }
        let is_above =
            |pair: &&PairContacts<D>| pair.separation.is_some_and(|found| found.upper > 0.0);
        let above = self.pairs.iter().filter(is_above).map(|pair| &pair.bodies);
        write_bound_fields(f, &self.bound_fields, above)?;
        writeln!(
            f,
            "{}: {} (gap up to {} mm), {} apart, {} undecided",
            counted(self.bodies.len(), "body", "bodies"),
            counted(self.touching, "pair touches", "pairs touch"),
            millimetres(self.margin),
            self.apart,
            self.undecided,
        )
    }
}

/// The penetration of a pair, and the way out.
fn write_penetration<const D: usize>(
    f: &mut fmt::Formatter<'_>,
    found: &PenetrationBounds<D>,
) -> fmt::Result {
    let digits = digits_of(found.upper.map_or(found.lower, |upper| upper - found.lower));
    let lower = decimal(1e3 * found.lower, digits);
    let (stop, evaluations) = (found.stop, found.evaluations);
    match (found.upper, found.direction) {
        (Some(upper), Some(direction)) => {
            let upper = decimal(1e3 * upper, digits);
            let direction = decimals(&direction.0, 3);
            write!(f, "penetration {lower} to {upper} mm, out along [{direction}]")?;
        }
        (Some(upper), None) => {
            write!(f, "penetration {lower} to {} mm", decimal(1e3 * upper, digits))?;
        }
        (None, _) => write!(f, "penetration at least {lower} mm, no way out was found")?,
    }
    write!(f, " ({stop}; {evaluations} evaluations)")
}

impl<const D: usize> ContactsAnswer<D> {
    /// A pair with its contacts, a line each.
    fn write_pair(&self, f: &mut fmt::Formatter<'_>, pair: &PairContacts<D>) -> fmt::Result {
        let [a, b] = pair.bodies.each_ref().map(|name| shown(name));
        write!(f, "{a} – {b}: {}", pair.verdict)?;
        match (&pair.separation, &pair.empty) {
            (Some(found), _) => {
                let digits = digits_of(found.upper - found.lower);
                let [lower, upper] =
                    [found.lower, found.upper].map(|bound| decimal(1e3 * bound, digits));
                let (stop, evaluations) = (found.stop, found.evaluations);
                write!(
                    f,
                    ", separation {lower} to {upper} mm ({stop}; {evaluations} evaluations with \
                     its contacts)"
                )?;
                if let Some(found) = &pair.penetration {
                    f.write_str("\n       ")?;
                    write_penetration(f, found)?;
                }
            }
            (None, Some(empty)) => write!(f, ", {} has no point", shown(empty))?,
            (None, None) => f.write_str(", neither has bounds; intersect one with a box")?,
        }
        if let (Verdict::Undecided, Some(why)) = (pair.verdict, self.undecided(pair)) {
            write!(f, "\n       undecided: {why}")?;
        }
        for contact in &pair.contacts {
            write_contact(f, contact)?;
        }
        if pair.dropped > 0 {
            write!(f, "\n       and {} more within these", pair.dropped)?;
        }
        if let Some(why) = self.cut_off(pair.region_stop) {
            write!(f, "\n       and maybe others: {why}")?;
        }
        writeln!(f)
    }

    /// Why the bounds of a pair do not tell, and what helps.
    fn undecided(&self, pair: &PairContacts<D>) -> Option<String> {
        let found = pair.separation?;
        let margin = millimetres(self.margin);
        Some(match found.stop {
            Stop::Converged | Stop::SignKnown if found.upper <= self.margin => format!(
                "fields are bounds there, and no points of both bodies within the margin of \
                 {margin} mm are found; they may be farther apart"
            ),
            Stop::BudgetSpent => {
                format!("the budget of {} evaluations is spent; raise the budget", self.budget)
            }
            Stop::MemoryFull => {
                "the memory of the search is full, and a larger budget does not \
                                 help; another margin may"
                    .to_owned()
            }
            Stop::RoundingReached | Stop::Unresolved => {
                "rounding allows no closer bounds; another margin decides".to_owned()
            }
            Stop::Converged | Stop::SignKnown => format!(
                "the margin of {margin} mm lies between the bounds; lower the tolerance, or take \
                 another margin"
            ),
        })
    }

    /// Why the region of contact was not searched to its end, and what helps; `None` if it was.
    fn cut_off(&self, stop: Stop) -> Option<String> {
        match stop {
            Stop::Converged | Stop::SignKnown | Stop::RoundingReached => None,
            Stop::BudgetSpent => Some(format!(
                "the search for contacts spent its budget of {} evaluations; raise the budget or \
                 the spacing",
                self.budget
            )),
            Stop::MemoryFull => Some(
                "the memory of the search is full, and a larger budget does not help; raise the \
                 spacing"
                    .to_owned(),
            ),
            Stop::Unresolved => Some(
                "bounds leave open whether the bodies touch in thin places far from these contacts; lower \
                 the spacing"
                    .to_owned(),
            ),
        }
    }
}

/// A contact, on a line that follows another.
fn write_contact<const D: usize>(
    f: &mut fmt::Formatter<'_>,
    contact: &Contact<D>,
) -> fmt::Result {
    let estimated = if contact.on_surfaces || contact.gap <= 0.0 { "" } else { " estimated" };
    write!(
        f,
        "\n  {:>3}  gap {} mm{estimated}  at ({})  normal ({})",
        contact.id,
        millimetres(contact.gap),
        decimals(&contact.point_a.0, 6),
        decimals(&contact.normal.0, 4)
    )?;
    match contact.normal_from {
        NormalSource::Gradients => Ok(()),
        source => write!(f, "  from {source}"),
    }
}

/// Decimals of millimetres that tell numbers apart which differ by a length [m].
fn digits_of(length: f64) -> usize {
    (4..12).find(|&digits| 1e3 * length >= 10_f64.powi(-(digits as i32))).unwrap_or(12)
}

fn millimetres(length: f64) -> String {
    decimal(1e3 * length, 4)
}
