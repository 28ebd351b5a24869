// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate sweep`: when bodies that move by the motions of a scene touch first.

mod figure;
mod local;
mod surface;

use palpate::field::Vector;
use palpate::query::Verdict;
use palpate::scene::{Answer, AnyScene, BuiltScene, Question, SweepQuestion};

use crate::arguments::SweepOptions;
use crate::ask;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files};
use crate::picture::{self, Dimensions, Drawable, Picture};
use crate::plane;
use local::{LocalSearch, Surfaced};

/// Finds when pairs touch first; the answer is no if none do.
pub(crate) fn run(options: &SweepOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let inputs = [Some(options.scene.as_path()), options.motion.as_deref()];
    let mut files = Files::reading(inputs.into_iter().flatten());
    let picture = options.plot.as_deref().map(|path| Picture::new(&mut files, path));
    let picture = picture.transpose()?;
    let named = input::moving(Some(&options.scene), options.motion.as_deref())?;
    match &named.scene {
        AnyScene::Planar(_) if options.plane.is_some() => Err(Failure::input(
            "--plane is for scenes in space; this scene is in the plane, and drawn whole",
        )),
        AnyScene::Planar(scene) => answer(options, scene, picture.as_ref(), interrupt),
        AnyScene::Spatial(scene) => {
            if let Some(asked) = &options.plane {
                // A plane that cannot be read is told before a long search.
                plane::named("--plane", asked, None, Vector::ZERO)?;
            }
            answer(options, scene, picture.as_ref(), interrupt)
        }
    }
}

fn answer<const D: usize>(
    options: &SweepOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D> + Surfaced<D>,
{
    let local = LocalSearch::of(options)?;
    let question = Question::Sweep(SweepQuestion {
        bodies: options.body.clone(),
        every_pair: options.every_pair,
        until: options.until,
        gap: options.gap,
        tolerance: options.tolerance,
        budget: options.budget,
    });
    let Some(Answer::Sweep(mut found)) = ask::ask(scene, question, interrupt)? else {
        output::remark("interrupted before any pair was searched; nothing is reported");
        return Ok(Outcome::Interrupted);
    };
    if let Some(search) = local {
        let times = scene.times_of_motion(found.until);
        for pair in &mut found.pairs {
            // A search of some minutes must end when it is asked to; what is proven stays.
            let (scene, times) = (scene.clone(), times.clone());
            let (indices, gap) = (pair.indices, found.gap);
            let work = move || search.beside(&scene, indices, &times, gap);
            pair.local = interrupt.unless_asked(work).transpose()?.flatten();
            if interrupt.is_asked() {
                break;
            }
        }
    }
    // A picture of some pairs would be taken for one of all pairs.
    if let (Some(picture), Some(pair), false) =
        (picture, found.pairs.first(), interrupt.is_asked())
    {
        let figure = figure::of(options, scene, &found, pair)?;
        picture.save(&figure, picture::WIDTH)?;
    }
    let touch = found.pairs.iter().any(|pair| pair.verdict == Verdict::Touching);
    output::answer().print(&Answer::Sweep(found), options.json)?;
    if interrupt.is_asked() {
        output::remark(
            "interrupted: some pairs, or what --method finds of them, are not listed",
        );
        return Ok(Outcome::Interrupted);
    }
    Ok(if touch { Outcome::Yes } else { Outcome::No })
}
