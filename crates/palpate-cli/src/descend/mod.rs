// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend`: a local search over an element or between two bodies, compared with the
//! proven minimum.

mod circles;
pub(crate) mod element;
mod ending;
mod figure;
pub(crate) mod pair;
mod search;

use std::path::Path;
use std::str::FromStr;

use palpate::field::UnknownName;
use palpate::field::{Aabb, Vector};
use palpate::local::Descent;
use palpate::query::Limits;
use palpate::scene::{AnyScene, BuiltScene};
use serde::Serialize;

use crate::arguments::DescendOptions;
use crate::input;
use crate::outcome::{Failure, Outcome};
use crate::output::Files;
use crate::picture::{Dimensions, Drawable, Picture};

/// How far apart the bounds of the minimum may be, as a share of the longest edge.
const TOLERANCE: f64 = 1e-4;

pub(crate) fn run(options: &DescendOptions) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.scene.as_path()]);
    let picture = options.plot.as_deref().map(|path| Picture::new(&mut files, path));
    let picture = picture.transpose()?;
    match &input::scene(Some(&options.scene))?.scene {
        AnyScene::Planar(scene) => descend(options, scene, picture.as_ref()),
        AnyScene::Spatial(scene) => descend(options, scene, picture.as_ref()),
    }
}

/// Searches over an element, or between two bodies, as the options ask.
fn descend<const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let elements = [&options.triangle, &options.segment];
    let has_start = !options.start.is_empty() || options.halton.is_some();
    if !has_start && elements.iter().all(|points| points.is_empty()) {
        Err(nothing_asked(scene, &options.scene))
    } else if options.halton.is_some() && elements.iter().any(|points| !points.is_empty()) {
        Err(Failure::input(
            "--halton is for starts between two bodies: leave out --triangle and --segment",
        ))
    } else if !options.triangle.is_empty() {
        element::descend::<3, D>(options, scene, picture, &options.triangle)
    } else if !options.segment.is_empty() {
        element::descend::<2, D>(options, scene, picture, &options.segment)
    } else {
        pair::between(options, scene, picture)
    }
}

/// What to ask instead of nothing, with an example from the scene.
fn nothing_asked<const D: usize>(scene: &BuiltScene<D>, path: &Path) -> Failure {
    let around = Aabb::centred(Vector::constant(0.5));
    let bounds = scene.bounds().unwrap_or(around);
    let mut ends = [bounds.centre(); 2];
    (ends[0][0], ends[1][0]) = (bounds.min[0], bounds.max[0]);
    let [from, to] = ends.map(input::written_point);
    let path = path.display();
    Failure::input(format!(
        "descend needs --segment with 2 points, --triangle with 3, or, between two bodies, --start \
         with 1 or --halton with their number; for example: palpate descend {path} --segment {from} {to}"
    ))
}

/// The requested method, or `first`. A method of the `Other` kind is named with what it needs.
fn method<T, Other>(options: &DescendOptions, first: T, needs: &str) -> Result<T, Failure>
where
    T: FromStr<Err = UnknownName>,
    Other: FromStr,
{
    let Some(name) = options.method.as_deref() else { return Ok(first) };
    if name.parse::<Other>().is_ok() {
        return Err(Failure::input(format!("--method {name} {needs}")));
    }
    name.parse().map_err(|error| Failure::input(format!("--method: {error}")))
}

/// The limits of the search with a proof, over something of this size [m].
fn limits(tolerance: Option<f64>, size: f64) -> Limits {
    Limits::new(tolerance.unwrap_or(TOLERANCE * size))
}

/// The result of a local search.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Found {
    /// The best point [m].
    pub(crate) best: Vec<f64>,
    /// Its value, an upper bound of the minimum [m]; between two bodies, the larger value of both fields.
    pub(crate) value: f64,
    /// Steps that were taken.
    pub(crate) steps: u32,
    /// How often fields were evaluated; a gradient counts twice.
    pub(crate) evaluations: u32,
    /// The points of the path, from the start on [m].
    pub(crate) path: Vec<Vec<f64>>,
}

impl<const D: usize> From<&Descent<D>> for Found {
    fn from(found: &Descent<D>) -> Self {
        Self {
            best: found.best.0.to_vec(),
            value: found.value,
            steps: found.steps,
            evaluations: found.evaluations,
            path: found.path.iter().map(|p| p.0.to_vec()).collect(),
        }
    }
}

/// A length as figures write it.
fn written(length: f64) -> String {
    /// Parts of a metre.
    const ROUND: f64 = 1e5;
    // Adding zero turns −0 into 0.
    let rounded = (length * ROUND).round() / ROUND + 0.0;
    format!("{rounded:.5} m").replace('-', "−")
}
