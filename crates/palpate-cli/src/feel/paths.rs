// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where each contact point goes: along the rows of a file, or on a tour of the scene.

use std::path::Path;

use palpate::hands::HandWay;
use palpate::scene::BuiltScene;
use palpate::sim::HandPath;

use super::limits;
use crate::arguments::FeelOptions;
use crate::hand_csv;
use crate::outcome::Failure;

/// The contact points of the built-in hand on the built-in gallery: two hands.
const FINGERS: usize = 10;

/// The longest time that a hand may rest before its path begins, unless a duration is given [s].
const LONGEST_REST: f64 = 86_400.0;

/// How many contact points follow each other on a tour, if the scene's tool has none.
fn following(options: &FeelOptions) -> usize {
    options.points.unwrap_or(if options.scene.is_none() { FINGERS } else { 1 })
}

/// How many contact points a run without a file has.
pub(super) fn count<const D: usize>(scene: &BuiltScene<D>, options: &FeelOptions) -> usize {
    match scene.contact_points().count() {
        0 => following(options),
        points => points,
    }
}

/// The paths of the contact points over `duration` [s], on a tour of the scene.
pub(super) fn on_tour<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    duration: f64,
) -> Result<Vec<HandPath>, Failure> {
    let way = HandWay::tour(scene, duration, following(options)).map_err(Failure::input)?;
    paths(&way)
}

/// The paths of the contact points that go a way, if they do not take too much memory.
fn paths(way: &HandWay) -> Result<Vec<HandPath>, Failure> {
    limits::paths(way.points(), way.path().times().len())?;
    way.paths().map_err(Failure::input)
}

/// The paths in a file. A path of one contact point carries the points of the scene's tool, which
/// lie beside it; paths of as many contact points as the tool has lead each of them.
///
/// # Errors
///
/// If the file is no hand path, or has another number of contact points.
pub(super) fn in_file<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    file: &Path,
) -> Result<Vec<HandPath>, Failure> {
    if options.points.is_some() {
        return Err(Failure::input(
            "--points is about the built-in hand; with --path, the column `point` of the file, or the \
             `points` of the scene's tool, say how many there are",
        ));
    }
    let all = hand_csv::read::<D>(file)?;
    match (&all[..], scene.contact_points().count()) {
        (_, 0) => Ok(all),
        ([hand], _) => paths(&HandWay::along(scene, hand.clone())),
        (_, points) if all.len() == points => Ok(all),
        (_, points) => {
            let given = all.len();
            let problem = format!(
                "there are {given} contact points, and the tool of the scene has {points}; \
                 give one, which carries the tool, or {points}, one for each point"
            );
            Err(Failure::file(file, problem))
        }
    }
}

/// How near paths come to the scene, at some of their samples [m].
pub(super) fn nearest<const D: usize>(scene: &BuiltScene<D>, paths: &[HandPath]) -> f64 {
    /// Samples of a path that are looked at.
    const LOOKED_AT: usize = 1000;
    let seen = paths.iter().flat_map(|path| {
        let step = path.positions().len().div_ceil(LOOKED_AT).max(1);
        path.positions().iter().step_by(step)
    });
    seen.map(|point| scene.whole.distance(point.truncated::<D>())).fold(f64::INFINITY, f64::min)
}

/// When the last path ends [s].
pub(super) fn end(paths: &[HandPath]) -> f64 {
    paths.iter().map(|path| path.start() + path.duration()).fold(f64::NEG_INFINITY, f64::max)
}

/// Refuses paths along which the hand does not move in the run.
pub(super) fn check_times(
    file: &Path,
    paths: &[HandPath],
    duration: Option<f64>,
) -> Result<(), Failure> {
    let first = paths.iter().map(HandPath::start).fold(f64::INFINITY, f64::min);
    let last = end(paths);
    if last > 0.0 && first < duration.unwrap_or(LONGEST_REST) {
        return Ok(());
    }
    let run = match duration {
        Some(duration) => format!("the run goes from 0 s to {duration} s"),
        None => "the run begins at 0 s".to_owned(),
    };
    let problem = format!(
        "the hand moves from {first} s to {last} s, and {run}: times count from the start of the run"
    );
    Err(Failure::file(file, problem))
}
