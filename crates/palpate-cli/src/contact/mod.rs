// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate contact`: where the bodies of a scene touch.

mod overlay;
mod question;
mod report;

use palpate::query::Verdict;
use palpate::scene::{AnyScene, BuiltScene};

use crate::arguments::ContactOptions;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output;

use question::{Pair, Question};

pub(crate) use overlay::Touched;

/// Reports list every pair of scenes of at most so many bodies, and only near pairs of others.
const FEW: usize = 12;

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
    let question = Question::of(&options.question, scene)?;
    let mut pairs: Vec<Pair<D>> = question.near(scene)?;
    if options.all || scene.bodies.len() <= FEW {
        interrupt.heed();
        pairs.extend(question.apart(scene, &pairs, interrupt)?);
    }
    let names: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let report = report::Report { question: &question, names: &names, pairs: &pairs };
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
