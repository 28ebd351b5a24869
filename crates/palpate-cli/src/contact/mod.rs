// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate contact`: where the bodies of a scene touch.

mod overlay;
mod question;
mod report;

use palpate::query::Verdict;
use palpate::scene::{AnyScene, BuiltScene};

use crate::arguments::ContactOptions;
use crate::bound_fields::BoundFields;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::views;

use question::{Asked, Question};

pub(crate) use overlay::Touched;
pub(crate) use report::as_json;

/// Pictures show every pair of scenes of at most so many bodies, and only near pairs of others.
const FEW: usize = 12;

/// Reports list every pair of at most so many, those of 12 bodies, and only near ones of more.
pub(crate) const FEW_PAIRS: usize = FEW * (FEW - 1) / 2;

/// Finds the pairs that touch; the answer is no if none do.
pub(crate) fn run(options: &ContactOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene))?;
    match &named.scene {
        AnyScene::Planar(scene) => answer(options, scene, interrupt),
        AnyScene::Spatial(scene) => answer(options, scene, interrupt),
    }
}

fn answer<const D: usize>(
    options: &ContactOptions,
    scene: &BuiltScene<D>,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let names: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    if let [name] = names[..] {
        return Err(Failure::input(format!(
            "contact is about two bodies or more, and the scene has only {name:?}; add another to \
             its `bodies`"
        )));
    }
    let question = Question::of(&options.question, scene);
    let bodies = input::bodies(&options.body, &names)?;
    let moved = options.time.map(|time| views::at(scene, time)).transpose()?;
    let scene = moved.as_ref().unwrap_or(scene);
    let count = pairs_of(names.len(), bodies.len());
    let asked = Asked { bodies: &bodies, is_every: options.every_pair || count <= FEW_PAIRS };
    let Some(pairs) = question.pairs(scene, &asked, interrupt)? else {
        output::remark(
            "interrupted before it was known which bodies touch; nothing is reported",
        );
        return Ok(Outcome::Interrupted);
    };
    let report = report::Report {
        question: &question,
        names: &names,
        bounds: &BoundFields::of(scene),
        pairs: &pairs,
        count,
        time: options.time,
        is_still: scene.motions.is_empty(),
    };
    if options.json {
        report.print_json()?;
    } else {
        report.print()?;
    }
    if interrupt.is_asked() {
        output::remark("interrupted: some pairs that are apart are not listed");
        return Ok(Outcome::Interrupted);
    }
    let touch = pairs.iter().any(|pair| pair.verdict == Verdict::Touching);
    Ok(if touch { Outcome::Yes } else { Outcome::No })
}

/// How many pairs `all` bodies have with one of `asked`; all of them if none is asked for.
pub(crate) fn pairs_of(all: usize, asked: usize) -> usize {
    let pairs = |bodies: usize| bodies * bodies.saturating_sub(1) / 2;
    if asked == 0 { pairs(all) } else { pairs(all) - pairs(all - asked) }
}
