// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The settings of a contact search in a scene, and the library's answers.

use std::collections::BTreeSet;

use palpate::field::LARGEST_LENGTH;
use palpate::query::{
    Certified, Contact, Limits, Nearest, PairWorkspace, Placed, Proof, Verdict, WorldSettings,
    proof, separation,
};
use palpate::scene::{BuiltBody, BuiltScene};

use crate::arguments::ContactQuestion;
use crate::interrupt::Interrupt;
use crate::outcome::Failure;

/// The settings of a contact search in a scene.
pub(crate) struct Question {
    pub(crate) settings: WorldSettings,
}

/// The answer for two bodies, by their indices in the scene.
#[derive(Clone, Debug)]
pub(crate) struct Pair<const D: usize> {
    pub(crate) bodies: [usize; 2],
    pub(crate) verdict: Verdict,
    /// `None` if neither body has bounds.
    pub(crate) separation: Option<Certified<Nearest<D>>>,
    /// Where the bodies touch; for bodies that are apart, the witness points.
    pub(crate) contacts: Vec<Contact<D>>,
    /// The number of contacts of each patch.
    pub(crate) groups: Vec<usize>,
    /// The number of dropped contacts.
    pub(crate) dropped: usize,
    /// `false` if the budget was spent before the whole region was searched.
    pub(crate) is_whole: bool,
}

impl Question {
    /// Lengths that the command line leaves out are shares of the smallest body.
    pub(crate) fn of<const D: usize>(
        asked: &ContactQuestion,
        scene: &BuiltScene<D>,
    ) -> Result<Self, Failure> {
        let usual = scene.world_settings().manifold;
        let margin = length("--margin", asked.margin.unwrap_or(usual.margin), 0.0)?;
        let spacing = asked.spacing.unwrap_or(usual.spacing);
        let spacing = length("--spacing", spacing, f64::MIN_POSITIVE)?;
        let tolerance = length("--tolerance", asked.tolerance.unwrap_or(0.5 * margin), 0.0)?;
        let manifold = usual.with_margin(margin).with_spacing(spacing);
        let limits = Limits::new(tolerance).with_budget(asked.budget);
        Ok(Self { settings: WorldSettings::new(manifold, limits) })
    }

    /// All pairs that touch or are undecided.
    pub(crate) fn near<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
    ) -> Result<Vec<Pair<D>>, Failure> {
        let mut world = scene.world_with(self.settings).map_err(Failure::input)?;
        let margin = self.settings.manifold.margin;
        let pairs = world.step().into_iter().map(|found| {
            let manifold = found.manifold.as_ref();
            Pair {
                bodies: found.bodies.map(|body| body.index()),
                verdict: found.verdict(margin),
                separation: manifold.map(|manifold| manifold.separation),
                contacts: found.contacts().to_vec(),
                groups: manifold.map_or_else(Vec::new, |manifold| manifold.groups.clone()),
                dropped: manifold.map_or(0, |manifold| manifold.dropped),
                is_whole: manifold.is_none_or(|manifold| manifold.is_whole),
            }
        });
        Ok(pairs.collect())
    }

    /// All pairs but those in `near`, each with the separation that proves it apart; fewer if
    /// interrupted.
    pub(crate) fn apart<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        near: &[Pair<D>],
        interrupt: &Interrupt,
    ) -> Result<Vec<Pair<D>>, Failure> {
        let mut workspace = PairWorkspace::new();
        let near: BTreeSet<[usize; 2]> = near.iter().map(|pair| pair.bodies).collect();
        let mut apart = Vec::new();
        for k in 0..scene.bodies.len() {
            for i in (0..k).filter(|i| !near.contains(&[*i, k])) {
                if interrupt.is_asked() {
                    return Ok(apart);
                }
                let [a, b] = [i, k].map(|i| placed(&scene.bodies[i]));
                let found = separation(a, b, &self.settings.limits, &mut workspace)
                    .map_err(Failure::input)?;
                apart.push(Pair {
                    bodies: [i, k],
                    verdict: Verdict::Apart,
                    separation: Some(found),
                    contacts: found.best.contact(a, b).into_iter().collect(),
                    groups: Vec::new(),
                    dropped: 0,
                    is_whole: true,
                });
            }
        }
        Ok(apart)
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

fn placed<const D: usize>(body: &BuiltBody<D>) -> Placed<'_, D> {
    Placed::new(&body.shape_in_body, body.world_from_body)
}

/// A length on the command line, at least `least`.
fn length(option: &str, value: f64, least: f64) -> Result<f64, Failure> {
    if (least..=LARGEST_LENGTH).contains(&value) {
        return Ok(value);
    }
    let rule = if least > 0.0 { "positive" } else { "not negative" };
    let rule = format!("{rule} and at most {LARGEST_LENGTH:e} m, got {value:?} m");
    Err(Failure::input(format!("{option} must be {rule}")))
}
