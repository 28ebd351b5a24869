// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`: computes volume, mass and moments of the bodies of a scene.

use palpate::scene::{AnyScene, BuiltScene, MassQuestion, Question};

use crate::arguments::MassOptions;
use crate::ask;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output;

/// Computes the mass of each body; the answer is no if an error is above the tolerance, or a body
/// has none.
pub(crate) fn run(options: &MassOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene))?;
    match &named.scene {
        AnyScene::Planar(scene) => report(options, scene, interrupt),
        AnyScene::Spatial(scene) => report(options, scene, interrupt),
    }
}

fn report<const D: usize>(
    options: &MassOptions,
    scene: &BuiltScene<D>,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let MassOptions { density, tolerance, cells, .. } = *options;
    let question = Question::Mass(MassQuestion { density, tolerance, cells });
    let answer = ask::ask(scene, question, interrupt)?;
    let bodies = answer.as_ref().map_or(&[][..], |answer| &ask::mass(answer).bodies);
    if let Some(answer) = &answer {
        ask::print(answer, options.json)?;
    }
    if bodies.len() < scene.bodies.len() {
        let (done, all) = (bodies.len(), scene.bodies.len());
        let all = output::counted(all, "body", "bodies");
        output::remark(format_args!("interrupted after {done} of {all}"));
        return Ok(Outcome::Interrupted);
    }
    let is_good = bodies.iter().all(|body| body.weighed.is_some_and(|mass| !mass.open));
    Ok(if is_good { Outcome::Yes } else { Outcome::No })
}
