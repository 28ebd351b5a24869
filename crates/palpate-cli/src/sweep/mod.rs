// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate sweep`: when bodies touch first.

use std::path::PathBuf;

use clap::Args;
use local::{LocalSearch, Surfaced};
use palpate::field::Vector;
use palpate::query::Verdict;
use palpate::scene::{Answer, AnyScene, BuiltScene, Question, SweepQuestion};

use crate::arguments::Reading;
use crate::arguments::numbers::{count, length, positive};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files};
use crate::picture::{self, Dimensions, Drawable, Picture};
use crate::{ask, input, plane};

mod figure;
mod local;

/// Finds when pairs touch first; the answer is no if none do.
pub(crate) fn run(options: &SweepOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let inputs = [Some(options.scene.as_path()), options.motion.as_deref()];
    let mut files = Files::reading(inputs.into_iter().flatten(), options.reading);
    let picture = options.plot.as_deref().map(|path| Picture::new(&mut files, path));
    let picture = picture.transpose()?;
    let named =
        input::moving(Some(&options.scene), options.motion.as_deref(), options.reading)?;
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

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate sweep scenes/bayonet.json
  palpate sweep scenes/bayonet.json --until 1 --gap 1e-7 --json
  palpate sweep scenes/bayonet.json --body key
  palpate sweep scenes/bayonet.json --plot touch.png
  palpate sweep scenes/cup.json --motion drop.json
  palpate sweep scenes/bayonet.json --method golden_section
  palpate sweep scenes/bayonet.json --method sum_descent --samples 30

Before the earlier time the bodies are apart by more than half of the gap, which is proven, rounding
included; at the later one their separation is at most the gap.";

/// The options of `palpate sweep`.
#[derive(Args, Debug)]
pub(crate) struct SweepOptions {
    /// The scene file, whose bodies move by its `motions`.
    pub(crate) scene: PathBuf,
    /// A file of motions in place of the scene's own.
    #[arg(long, value_name = "FILE")]
    pub(crate) motion: Option<PathBuf>,
    /// List pairs that are apart too; always on where at most 66 pairs are asked about, those of 12
    /// bodies.
    #[arg(long)]
    pub(crate) every_pair: bool,
    /// Only pairs with this body; may be given more than once.
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Vec<String>,
    /// The end of the time that is looked at [s]; if left out, the end of the last motion: one that repeats
    /// counts once, there and back.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) until: Option<f64>,
    /// The largest separation at which bodies touch [m], a millionth of the smallest body if left
    /// out; those more than half of it apart may be called apart.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) gap: Option<f64>,
    /// How far apart the bounds of a time may be [s]; if left out, 1e-4 of the duration of the part
    /// that is searched: motions are split into parts of less than half a turn.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) tolerance: Option<f64>,
    /// The budget: the most evaluations of fields for each pair and each part of a motion; 5000000 if
    /// left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, u32::MAX))]
    pub(crate) budget: Option<u32>,
    /// A local search of the literature beside the proven answer: golden_section over space and time, of
    /// the surface of the smaller body as triangles or segments; or at equal steps of time, naive,
    /// projected_gradient, frank_wolfe or macklin of that surface, or alternating_projection,
    /// minimax_proximal or sum_descent between both fields.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// How many steps of time of each part of a motion --method looks at, but for golden_section; 60 if
    /// left out.
    #[arg(long, requires = "method", allow_negative_numbers = true, value_parser = count(1, 10_000_u32))]
    pub(crate) samples: Option<u32>,
    /// How many cells the longest side of a body's box has in the grid from which --method takes its
    /// surface; 64 if left out.
    #[arg(long, requires = "method", allow_negative_numbers = true, value_parser = count(4, 256_u32))]
    pub(crate) cells: Option<u32>,
    /// Draw the first touch, how the bodies got there, and the boxes that were ruled out: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// The plane of the picture in space: xy, xz, yz, or three points as origin:right:up, each x,y,z;
    /// along two axes through the touch; if left out, along the normal and the motion there.
    #[arg(long, requires = "plot", allow_hyphen_values = true)]
    pub(crate) plane: Option<String>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}
