// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`: computes volume, mass and moments of the bodies of a scene.

use palpate::scene::{Answer, AnyScene, BuiltScene, MassAnswer, MassQuestion, Question};

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
    let mut all = MassAnswer { density, tolerance, bodies: Vec::new(), is_whole: true };
    // One body at a time, so that a reader sees each as soon as it is known.
    for (done, body) in scene.bodies.iter().enumerate() {
        let bodies = vec![body.name.clone()];
        let question = Question::Mass(MassQuestion { bodies, density, tolerance, cells });
        let Some(answer) = ask::unless_asked(scene, question, interrupt)? else {
            let count = output::counted(scene.bodies.len(), "body", "bodies");
            output::remark(format_args!("interrupted after {done} of {count}"));
            all.is_whole = false;
            break;
        };
        if !options.json {
            output::answer().print(&answer, false)?;
        }
        all.bodies.extend(ask::mass(&answer).bodies.iter().cloned());
    }
    let is_good = all.bodies.iter().all(|body| body.weighed.is_some_and(|mass| !mass.open));
    let is_whole = all.is_whole;
    if options.json {
        output::answer().print(&Answer::Mass(all), true)?;
    }
    Ok(match (is_whole, is_good) {
        (false, _) => Outcome::Interrupted,
        (true, true) => Outcome::Yes,
        (true, false) => Outcome::No,
    })
}
