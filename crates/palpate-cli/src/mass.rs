// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`: volumes, masses and moments.

use std::path::PathBuf;

use clap::Args;
use palpate::scene::{Answer, AnyScene, BuiltScene, MassAnswer, MassQuestion, Question};

use crate::arguments::Reading;
use crate::arguments::numbers::{count, positive, within};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::{ask, input, output};

/// Computes the mass of each body; the answer is no if an error is above the tolerance, or a body
/// has none.
pub(crate) fn run(options: &MassOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene), options.reading)?;
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

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate mass scenes/cup.json
  palpate mass scenes/cup.json --density 7850 --tolerance 1e-4 --json

Second moments are the integrals of density times products of coordinates about the
centroid; the inertia tensor is their trace times the identity, minus the second moments.
In 2D a body is one metre thick. Status 1 if the error of a volume stays above the tolerance,
or a body has none because it is endless.";

/// The options of `palpate mass`.
#[derive(Args, Debug)]
pub(crate) struct MassOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The density of all bodies [kg/m³].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = within(1e-15, 1e15, "kg/m³"))]
    pub(crate) density: f64,
    /// The relative error of the volume at which to stop.
    #[arg(long, allow_negative_numbers = true, default_value = "0.001", value_parser = positive(""))]
    pub(crate) tolerance: f64,
    /// The budget: the most cells, up to 100 million; a million take 160 MB.
    #[arg(long, allow_negative_numbers = true, default_value = "3000000", value_parser = count(1, 100_000_000_usize))]
    pub(crate) cells: usize,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}
