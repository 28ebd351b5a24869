// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate sweep`: when bodies that move by the motions of a scene touch first.

mod figure;
mod local;
mod report;
mod surface;

use palpate::field::Vector;
use palpate::local::LocalSweep;
use palpate::query::{FirstTouch, Moving, Placed, Stop, SweepSettings, SweepWorkspace, sweep};
use palpate::scene::{AnyScene, BuiltScene, Repeat};

use crate::arguments::SweepOptions;
use crate::bound_fields::BoundFields;
use crate::contact::{FEW_PAIRS, pairs_of};
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Dimensions, Drawable, Picture};
use crate::plane;
use local::{LocalSearch, Surfaced};

/// The gap over the size of the smallest body.
const GAP: f64 = 1e-6;

/// The tolerance of times over the part of a motion in which bodies touch.
const TOLERANCE: f64 = 1e-4;

/// The most parts of motions that are looked at.
const MOST_PARTS: f64 = 1e5;

/// Two bodies of which one moves at least, and when they touch first [s].
struct Pair<const D: usize> {
    bodies: [usize; 2],
    found: FirstTouch<D>,
    /// What a local search found, if one was asked for [s].
    local: Option<LocalSweep<D>>,
    /// The times between which it was searched last [s].
    part: [f64; 2],
}

impl<const D: usize> Pair<D> {
    fn is_apart(&self) -> bool {
        self.found.touches() == Some(false)
    }
}

/// What is asked of each pair.
struct Question {
    until: f64,
    /// [s]; a share of each part if it is `None`.
    tolerance: Option<f64>,
    settings: SweepSettings,
    local: Option<LocalSearch>,
}

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
    let names: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let asked = input::bodies(&options.body, &names)?;
    let question = asked_of(options, scene)?;
    let times = scene.times_of_motion(question.until);
    let moving: Vec<usize> = scene.moving().collect();
    let is_every = options.every_pair || pairs_of(names.len(), asked.len()) <= FEW_PAIRS;
    let (mut pairs, mut apart, mut unbounded) = (Vec::new(), 0, 0);
    interrupt.heed();
    for a in 0..names.len() {
        for b in a + 1..names.len() {
            let is_asked = asked.is_empty() || asked.contains(&a) || asked.contains(&b);
            if !is_asked || !(moving.contains(&a) || moving.contains(&b)) {
                continue;
            }
            if interrupt.is_asked() {
                break;
            }
            if are_unbounded(scene, [a, b]) {
                unbounded += 1;
                continue;
            }
            let found = first_touch(scene, [a, b], &times, &question, interrupt)?;
            let is_apart = found.as_ref().is_some_and(|pair| pair.is_apart());
            apart += usize::from(is_apart);
            pairs.extend(found.filter(|_| is_every || !is_apart));
        }
    }
    pairs.sort_by(|a, b| a.found.upper.total_cmp(&b.found.upper));
    let report = report::Report {
        question: &question,
        names: &names,
        bounds: &BoundFields::of(scene),
        pairs: &pairs,
        apart,
        unbounded,
    };
    if options.json {
        report.print_json()?;
    } else {
        report.print()?;
    }
    // A picture of some pairs would be taken for one of all pairs.
    if let (Some(picture), Some(pair), false) = (picture, pairs.first(), interrupt.is_asked()) {
        let figure = figure::of(options, &question, scene, pair)?;
        picture.save(&figure, picture::WIDTH)?;
    }
    if interrupt.is_asked() {
        output::remark(
            "interrupted: some pairs, or what --method finds of them, are not listed",
        );
        return Ok(Outcome::Interrupted);
    }
    let touch = pairs.iter().any(|pair| pair.found.touches() == Some(true));
    Ok(if touch { Outcome::Yes } else { Outcome::No })
}

fn asked_of<const D: usize>(
    options: &SweepOptions,
    scene: &BuiltScene<D>,
) -> Result<Question, Failure> {
    let ends = scene.motions.iter().map(|motion| {
        let ways = if motion.repeat == Repeat::BackAndForth { 2.0 } else { 1.0 };
        motion.start + ways * motion.duration
    });
    let Some(end) = ends.reduce(f64::max) else {
        return Err(Failure::input(
            "sweep is about bodies that move, and there are no `motions`: give some to the scene, or \
             a file of them by --motion; palpate contact tells where bodies at rest touch",
        ));
    };
    let until = options.until.unwrap_or(end);
    let parts: f64 = scene.motions.iter().map(|motion| motion.parts_until(until)).sum();
    if parts > MOST_PARTS {
        return Err(Failure::input(format!(
            "until {until} s the motions have {parts:e} parts (repetitions, and turns of less than a \
             half), of which {MOST_PARTS:e} are looked at; lower --until"
        )));
    }
    let size = |body: &palpate::scene::BuiltBody<D>| {
        body.shape
            .promise()
            .bounds
            .map_or(f64::INFINITY, |bounds| 2.0 * bounds.aabb.half_extents().norm())
    };
    let smallest = scene.bodies.iter().map(size).fold(f64::INFINITY, f64::min);
    let gap =
        options.gap.unwrap_or(if smallest < f64::INFINITY { GAP * smallest } else { GAP });
    let settings = SweepSettings {
        gap,
        budget: options.budget.unwrap_or(SweepSettings::BUDGET),
        ..SweepSettings::of_size(1.0)
    };
    let local = LocalSearch::of(options, gap)?;
    Ok(Question { until, tolerance: options.tolerance, settings, local })
}

impl Question {
    /// How far apart the bounds of a time between two others may be [s].
    fn tolerance_in(&self, [from, to]: [f64; 2]) -> f64 {
        self.tolerance.unwrap_or(TOLERANCE * (to - from))
    }

    /// The settings of a search between two times [s].
    fn settings_over(&self, part @ [from, to]: [f64; 2]) -> SweepSettings {
        SweepSettings {
            time_tolerance: (self.tolerance_in(part) / (to - from)).min(1.0),
            ..self.settings
        }
    }
}

/// Two bodies on their way between two times [s], over the time from 0 to 1.
fn ways<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    [from, to]: [f64; 2],
) -> Result<[Moving<'_, D>; 2], Failure> {
    let moving = |body: usize| {
        let shape = &scene.bodies[body].shape_in_body;
        let way = scene.way(body, from, to).map_err(Failure::input)?;
        let rest = || Placed::new(shape, scene.pose_at(body, from)).into();
        Ok::<_, Failure>(way.map_or_else(rest, |way| Moving::new(shape, way)))
    };
    Ok([moving(bodies[0])?, moving(bodies[1])?])
}

/// Whether both bodies have no bounds: no search of them ends.
fn are_unbounded<const D: usize>(scene: &BuiltScene<D>, bodies: [usize; 2]) -> bool {
    bodies.iter().all(|body| scene.bodies[*body].shape.promise().bounds.is_none())
}

/// What a local search finds of two bodies [s].
fn local_touch<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    times: &[f64],
    search: &LocalSearch,
) -> Result<Option<LocalSweep<D>>, Failure>
where
    Dimensions: Surfaced<D>,
{
    let of = bodies.map(|body| &scene.bodies[body]);
    let Some(prepared) = search.prepared(of.map(|body| &body.shape_in_body)) else {
        let [a, b] = of.map(|body| shown(&body.name));
        output::remark(format!(
            "--method {} needs the surface of {a} or {b}, and the grid shows none of either: raise \
             --cells, or take a method between fields, as sum_descent",
            search.name()
        ));
        return Ok(None);
    };
    let mut all: Option<LocalSweep<D>> = None;
    for part in times.windows(2) {
        let &[from, to] = part else { continue };
        let mut found = search.first_touch(ways(scene, bodies, [from, to])?, &prepared)?;
        if let Some(touch) = &mut found.touch {
            touch.time = from + (to - from) * touch.time;
        }
        if let Some(earlier) = all {
            found.evaluations = found.evaluations.saturating_add(earlier.evaluations);
            found.searched = found.searched.saturating_add(earlier.searched);
        }
        all = Some(found);
        if found.touch.is_some() {
            break;
        }
    }
    Ok(all)
}

/// When two bodies touch first [s]; `None` at an interrupt.
fn first_touch<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    times: &[f64],
    question: &Question,
    interrupt: &Interrupt,
) -> Result<Option<Pair<D>>, Failure>
where
    Dimensions: Surfaced<D>,
{
    let mut proven = match proven_touch(scene, bodies, times, question, interrupt)? {
        Some(proven) => proven,
        None => return Ok(None),
    };
    if let Some(search) = question.local {
        // A search of some minutes must end when it is asked to; what is proven stays.
        let (scene, times) = (scene.clone(), times.to_vec());
        let work = move || local_touch(&scene, bodies, &times, &search);
        proven.local = interrupt.unless_asked(work).transpose()?.flatten();
    }
    Ok(Some(proven))
}

/// The same without a local search beside it.
fn proven_touch<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    times: &[f64],
    question: &Question,
    interrupt: &Interrupt,
) -> Result<Option<Pair<D>>, Failure> {
    let mut workspace = SweepWorkspace::new();
    let mut evaluations = 0_u32;
    let mut last = None;
    for part in times.windows(2) {
        let &[from, to] = part else { continue };
        if interrupt.is_asked() {
            return Ok(None);
        }
        let [a, b] = ways(scene, bodies, [from, to])?;
        let (length, settings) = (to - from, question.settings_over([from, to]));
        let mut found = sweep(a, b, &settings, &mut workspace).map_err(Failure::input)?;
        evaluations = evaluations.saturating_add(found.evaluations);
        found.evaluations = evaluations;
        found.lower = if found.lower < 1.0 {
            // Rounded down: before it the bodies are apart.
            (from + length * found.lower).next_down().max(from)
        } else {
            to
        };
        if found.upper.is_finite() {
            found.upper = (from + length * found.upper).min(to);
        }
        let pair = Pair { bodies, found, local: None, part: [from, to] };
        if found.stop != Stop::SignKnown {
            return Ok(Some(pair));
        }
        last = Some(pair);
    }
    Ok(last)
}
