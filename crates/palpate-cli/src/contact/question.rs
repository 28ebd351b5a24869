// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The settings of a contact search in a scene, and the library's answers.

use std::collections::BTreeSet;

use palpate::query::{
    Certified, Contact, Limits, ManifoldSettings, Nearest, Neighbours, PairWorkspace, Placed,
    Proof, Stop, Verdict, WorldSettings, proof, separation,
};
use palpate::scene::{BuiltBody, BuiltScene};

use crate::arguments::ContactQuestion;
use crate::emptiness;
use crate::interrupt::Interrupt;
use crate::outcome::Failure;

/// The settings of a contact search in a scene.
pub(crate) struct Question {
    pub(crate) settings: WorldSettings,
    /// Which bodies are proven to have no point.
    empty: Vec<bool>,
}

/// The answer for two bodies, by their indices in the scene.
#[derive(Clone, Debug)]
pub(crate) struct Pair<const D: usize> {
    pub(crate) bodies: [usize; 2],
    pub(crate) verdict: Verdict,
    /// One of the bodies that is proven to have no point: nothing touches it.
    pub(crate) empty: Option<usize>,
    /// `None` if neither body has bounds, or one has no point.
    pub(crate) separation: Option<Certified<Nearest<D>>>,
    /// What their distance is at most, if anything is known [m].
    pub(crate) distance_at_most: Option<f64>,
    /// Where the bodies touch; for bodies that are apart, the witness points.
    pub(crate) contacts: Vec<Contact<D>>,
    /// The number of contacts of each patch.
    pub(crate) groups: Vec<usize>,
    /// The number of dropped contacts.
    pub(crate) dropped: usize,
    /// Why the search of the region ended; `Converged` if the region is whole.
    pub(crate) region_stop: Stop,
}

/// The pairs of a scene that are asked about.
pub(crate) struct Asked<'a> {
    /// Those with one of these bodies; all if there are none.
    pub(crate) bodies: &'a [usize],
    /// Whether pairs that are apart are searched too.
    pub(crate) is_every: bool,
}

impl Asked<'_> {
    /// `true` if a pair of bodies is asked about.
    fn has(&self, pair: [usize; 2]) -> bool {
        self.bodies.is_empty() || pair.iter().any(|body| self.bodies.contains(body))
    }
}

impl ContactQuestion {
    /// Refuses options of a search for contacts where none is made.
    pub(crate) fn refuse_unless(&self, is_asked: bool) -> Result<(), Failure> {
        let given = [
            ("--margin", self.margin.is_some()),
            ("--spacing", self.spacing.is_some()),
            ("--tolerance", self.tolerance.is_some()),
            ("--budget", self.budget.is_some()),
        ];
        match given.iter().find(|(_, is_given)| *is_given && !is_asked) {
            Some((option, _)) => {
                Err(Failure::input(format!("{option} is about contacts, and needs --contacts")))
            }
            None => Ok(()),
        }
    }
}

impl Question {
    /// Lengths that the command line leaves out are shares of the smallest body. Warns of bodies
    /// that are empty.
    pub(crate) fn of<const D: usize>(asked: &ContactQuestion, scene: &BuiltScene<D>) -> Self {
        let usual = scene.world_settings().manifold;
        let margin = asked.margin.unwrap_or(usual.margin);
        let spacing = asked.spacing.unwrap_or(usual.spacing);
        let precise = if margin > 0.0 { margin } else { usual.margin };
        let tolerance = (ManifoldSettings { margin: precise, ..usual }).usual_tolerance();
        let tolerance = asked.tolerance.unwrap_or(tolerance);
        let manifold = ManifoldSettings { margin, spacing, ..usual };
        let limits = Limits::new(tolerance).with_budget(asked.budget.unwrap_or(Limits::BUDGET));
        Self { settings: WorldSettings::new(manifold, limits), empty: emptiness::warn(scene) }
    }

    /// The pairs that touch or are undecided; and, if asked for, those that are apart: fewer of
    /// them if interrupted. `None` if interrupted before it is known which bodies touch.
    pub(crate) fn pairs<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        asked: &Asked<'_>,
        interrupt: &Interrupt,
    ) -> Result<Option<Vec<Pair<D>>>, Failure> {
        let mut world = scene.world_with(self.settings).map_err(Failure::input)?;
        let ids = world.bodies().collect::<Vec<_>>();
        for (i, id) in ids.iter().enumerate() {
            // Bodies of the second group touch those of the first alone, empty ones none.
            let is_asked = asked.bodies.is_empty() || asked.bodies.contains(&i);
            let (groups, mask) = match (self.empty[i], is_asked) {
                (true, _) => (0, 0),
                (false, true) => (1, u32::MAX),
                (false, false) => (2, 1),
            };
            world.set_groups(*id, groups, mask).map_err(Failure::input)?;
        }
        let margin = self.settings.manifold.margin;
        let stepped = interrupt.unless_asked(move || {
            let pairs: Vec<_> = world.step().into_iter().map(|p| near(p, margin)).collect();
            (world, pairs)
        });
        let Some((world, mut pairs)) = stepped else { return Ok(None) };
        if asked.is_every {
            let known: BTreeSet<[usize; 2]> = pairs.iter().map(|pair| pair.bodies).collect();
            let is_left = |bodies: &[usize; 2]| asked.has(*bodies) && !known.contains(bodies);
            let lower = |[i, k]: [usize; 2]| world.lower_bound(ids[i], ids[k]);
            let all = (0..self.empty.len()).flat_map(|k| (0..k).map(move |i| [i, k]));
            for bodies in all.filter(is_left) {
                if interrupt.is_asked() {
                    break;
                }
                pairs.push(match bodies.into_iter().find(|body| self.empty[*body]) {
                    Some(body) => without_points(bodies, body),
                    None => {
                        self.apart(scene, bodies, lower(bodies).map_err(Failure::input)?)?
                    }
                });
            }
        }
        Ok(Some(pairs))
    }

    /// A pair that the world did not find near, and a `lower` bound of its separation that is
    /// known.
    fn apart<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        bodies: [usize; 2],
        lower: f64,
    ) -> Result<Pair<D>, Failure> {
        let [a, b] = bodies.map(|i| placed(&scene.bodies[i]));
        let mut found = separation(a, b, &self.settings.limits, &mut PairWorkspace::new())
            .map_err(Failure::input)?;
        // What is proven stays proven, whatever the budget allowed now.
        found.lower = found.lower.max(lower);
        let margin = self.settings.manifold.margin;
        Ok(Pair {
            bodies,
            // The world finds all pairs that touch.
            verdict: Verdict::of_bounds([found.lower, f64::INFINITY], margin),
            empty: None,
            distance_at_most: None,
            contacts: found.best.contact(a, b).into_iter().collect(),
            separation: Some(found),
            groups: Vec::new(),
            dropped: 0,
            region_stop: Stop::Converged,
        })
    }

    /// The separation of two bodies with its proof.
    pub(crate) fn proof<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        bodies: [usize; 2],
    ) -> Result<Proof<D>, Failure> {
        let [a, b] = bodies.map(|i| placed(&scene.bodies[i]));
        proof(a, b, &self.settings.limits, &mut PairWorkspace::new()).map_err(Failure::input)
    }
}

/// A pair of which `empty` has no point.
fn without_points<const D: usize>(bodies: [usize; 2], empty: usize) -> Pair<D> {
    Pair {
        bodies,
        verdict: Verdict::Apart,
        empty: Some(empty),
        separation: None,
        distance_at_most: None,
        contacts: Vec::new(),
        groups: Vec::new(),
        dropped: 0,
        region_stop: Stop::Converged,
    }
}

/// A pair that the world found.
fn near<const D: usize>(found: &Neighbours<D>, margin: f64) -> Pair<D> {
    let manifold = found.manifold.as_ref();
    Pair {
        bodies: found.bodies.map(|body| body.index()),
        verdict: found.verdict(margin),
        empty: None,
        separation: manifold.map(|manifold| manifold.separation),
        distance_at_most: manifold
            .map(|manifold| manifold.distance_at_most)
            .filter(|distance| distance.is_finite()),
        contacts: found.contacts().to_vec(),
        groups: manifold.map_or_else(Vec::new, |manifold| manifold.groups.clone()),
        dropped: manifold.map_or(0, |manifold| manifold.dropped),
        region_stop: manifold.map_or(Stop::Converged, |manifold| manifold.region_stop),
    }
}

fn placed<const D: usize>(body: &BuiltBody<D>) -> Placed<'_, D> {
    Placed::new(&body.shape_in_body, body.world_from_body)
}
