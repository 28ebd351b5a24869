// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where each contact point goes: along the rows of a file, or on a tour of the scene.

use std::path::Path;

use palpate::devices::{DeviceError, HandPath, Tour};
use palpate::field::{Shape, Vector};
use palpate::haptics::Probe;
use palpate::scene::BuiltScene;

use super::limits;
use crate::arguments::FeelOptions;
use crate::hand_csv;
use crate::input;
use crate::outcome::Failure;

/// How far each contact point of the built-in hand lags behind the one before [s].
const LAG: f64 = 0.5;

/// The contact points of the built-in hand on the built-in gallery: two hands.
const FINGERS: usize = 10;

/// The contact points of a hand on a tour: `count` that follow each other, or those at the `arms` of
/// the scene's tool.
struct Fingers<const D: usize> {
    count: usize,
    arms: Vec<Vector<f64, D>>,
}

impl<const D: usize> Fingers<D> {
    fn of(scene: &BuiltScene<D>, options: &FeelOptions) -> Self {
        let arms: Vec<_> = scene.contact_points().collect();
        let default = if options.scene.is_none() { FINGERS } else { 1 };
        let alone = options.points.unwrap_or(default);
        Self { count: if arms.is_empty() { alone } else { arms.len() }, arms }
    }
}

/// How many contact points a run without a file has.
pub(super) fn count<const D: usize>(scene: &BuiltScene<D>, options: &FeelOptions) -> usize {
    Fingers::of(scene, options).count
}

/// The paths of the contact points over `duration` [s], on tours of the scene. The points of a
/// tool go side by side, others one behind the other.
pub(super) fn on_tour<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    duration: f64,
) -> Result<Vec<HandPath<D>>, Failure> {
    let Fingers { count, arms } = Fingers::of(scene, options);
    let lag = if arms.is_empty() { LAG * count.saturating_sub(1) as f64 } else { 0.0 };
    let radius = scene.tool.as_ref().map_or(Probe::default().radius(), |tool| tool.radius);
    let bodies: Vec<Shape<D>> = scene.bodies.iter().map(|body| body.shape.clone()).collect();
    let tour = Tour::new(input::bounds(scene)?, duration + lag)
        .and_then(|tour| tour.with_probe_radius(radius))
        .and_then(|tour| tour.over_each(&scene.whole, &bodies))
        .map_err(Failure::input)?;
    limits::paths::<D>(count, tour.times().len())?;
    if arms.is_empty() {
        (0..count).map(|point| moved(&tour, LAG * point as f64, Vector::ZERO)).collect()
    } else {
        arms.into_iter().map(|arm| moved(&tour, 0.0, arm)).collect()
    }
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
) -> Result<Vec<HandPath<D>>, Failure> {
    if options.points.is_some() {
        return Err(Failure::input(
            "--points is about the built-in hand; with --path, the column `point` of the file, or the \
             `points` of the scene's tool, say how many there are",
        ));
    }
    let paths = hand_csv::read(file)?;
    let arms: Vec<_> = scene.contact_points().collect();
    match (&paths[..], arms.len()) {
        (_, 0) => Ok(paths),
        ([hand], _) => {
            limits::paths::<D>(arms.len(), hand.times().len())?;
            arms.into_iter().map(|arm| moved(hand, 0.0, arm)).collect()
        }
        (_, points) if paths.len() == points => Ok(paths),
        (_, points) => {
            let given = paths.len();
            let problem = format!(
                "there are {given} contact points, and the tool of the scene has {points}; \
                 give one, which carries the tool, or {points}, one for each point"
            );
            Err(Failure::file(file, problem))
        }
    }
}

/// How near paths come to the scene, at some of their samples [m].
pub(super) fn nearest<const D: usize>(scene: &BuiltScene<D>, paths: &[HandPath<D>]) -> f64 {
    /// Samples of a path that are looked at.
    const LOOKED_AT: usize = 1000;
    let seen = paths.iter().flat_map(|path| {
        let step = path.positions().len().div_ceil(LOOKED_AT).max(1);
        path.positions().iter().step_by(step)
    });
    seen.map(|point| scene.whole.distance(*point)).fold(f64::INFINITY, f64::min)
}

/// A path that is `ahead` [s] of another, and beside it [m].
fn moved<const D: usize>(
    path: &HandPath<D>,
    ahead: f64,
    by: Vector<f64, D>,
) -> Result<HandPath<D>, Failure> {
    let times = path.times().iter().map(|time| time - ahead).collect();
    let positions = path.positions().iter().map(|point| *point + by).collect();
    let moved: Result<_, DeviceError> = HandPath::new(times, positions, path.interpolation());
    moved.map_err(Failure::input)
}
