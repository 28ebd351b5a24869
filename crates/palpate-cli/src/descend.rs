// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend`: a local search over an element, beside the proven minimum.

use std::io::Write;
use std::path::Path;

use palpate::field::{Point, Shape, Vector};
use palpate::plot::{Figure, Markers, PlotError, Polyline, Sampling, Slice, View};
use palpate::query::local::{Descent, ElementMethod};
use palpate::query::{Certified, Element, Limits, Workspace, minimum};
use palpate::scene::{BuiltScene, World};
use serde_json::json;

use crate::arguments::DescendOptions;
use crate::input::{self, joined, promise_in_words};
use crate::outcome::{Failure, Outcome};
use crate::picture::{self, Dimensions, Drawable, in_space};
use crate::plot::title;

/// How far apart the bounds of the minimum are, as a part of the longest edge.
const TOLERANCE: f64 = 1e-4;

/// Room around an element in a picture, as a part of its longer side.
const MARGIN: f64 = 0.35;

pub(crate) fn run(options: &DescendOptions) -> Result<Outcome, Failure> {
    match &input::scene(Some(&options.scene))?.world {
        World::Planar(scene) => over_points(options, scene),
        World::Spatial(scene) => over_points(options, scene),
    }
}

fn over_points<const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    if options.triangle.is_empty() {
        descend(options, scene, &element::<2, D>(&options.segment)?)
    } else {
        descend(options, scene, &element::<3, D>(&options.triangle)?)
    }
}

fn element<const N: usize, const D: usize>(
    points: &[String],
) -> Result<Element<N, D>, Failure> {
    let mut vertices = [Vector::ZERO; N];
    for (vertex, text) in vertices.iter_mut().zip(points) {
        *vertex = input::point(text)?;
    }
    Element::new(vertices).map_err(Failure::input)
}

/// What was found over an element, and what there is.
struct Answer<const D: usize> {
    method: ElementMethod,
    found: Descent<D>,
    certified: Certified<Point<D>>,
}

fn descend<const N: usize, const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    element: &Element<N, D>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let limits = limits(options.tolerance, element)?;
    let method = options.method;
    let answer = Answer {
        method,
        found: method.descend(&scene.whole, element),
        certified: minimum(&scene.whole, element, &limits, &mut Workspace::new()),
    };
    if let Some(path) = &options.plot {
        let figure = figure(&scene.whole, element, &answer, &options.scene);
        picture::save(&figure.map_err(Failure::input)?, path, picture::WIDTH)?;
    }
    answer.print(options.json)?;
    Ok(Outcome::Yes)
}

fn limits<const N: usize, const D: usize>(
    tolerance: Option<f64>,
    element: &Element<N, D>,
) -> Result<Limits, Failure> {
    let [first, .., last] = element.vertices().as_slice() else {
        return Err(Failure::input("an element has two points at least"));
    };
    let edges = element.vertices().windows(2).map(|pair| (pair[0] - pair[1]).norm());
    let longest = edges.fold((*first - *last).norm(), f64::max);
    let tolerance = tolerance.unwrap_or(TOLERANCE * longest);
    // Written so that what is no number is refused.
    if tolerance >= 0.0 && tolerance.is_finite() {
        Ok(Limits { tolerance, ..Limits::default() })
    } else {
        let rule = "--tolerance must be finite and zero or more";
        Err(Failure::input(format!("{rule}, got {tolerance:?} m")))
    }
}

impl<const D: usize> Answer<D> {
    /// How much lower some point is at least [m]; zero if none is known to be.
    fn missed_by(&self) -> f64 {
        (self.found.value - self.certified.upper).max(0.0)
    }

    fn print(&self, as_json: bool) -> Result<(), Failure> {
        let Self { method, found, certified } = self;
        let mut out = std::io::stdout().lock();
        if as_json {
            let path: Vec<_> = found.path.iter().map(|p| p.0.to_vec()).collect();
            let answer = json!({
                "method": method.name(),
                "best_point_m": found.best.0.to_vec(),
                "value_m": found.value,
                "steps": found.steps,
                "evaluations": found.evaluations,
                "path_m": path,
                "certified": {
                    "best_point_m": certified.best.0.to_vec(),
                    "lower_m": certified.lower,
                    "upper_m": certified.upper,
                    "evaluations": certified.evaluations,
                },
                "missed_by_m": self.missed_by(),
            });
            writeln!(out, "{answer:#}")?;
            return Ok(());
        }
        writeln!(out, "method       {method}")?;
        writeln!(out, "best point   {} m", joined(&found.best.0))?;
        writeln!(out, "value        {} m, an upper bound", found.value)?;
        writeln!(out, "steps        {} ({} evaluations)", found.steps, found.evaluations)?;
        let bounds = joined(&[certified.lower, certified.upper]);
        let evaluations = certified.evaluations;
        writeln!(out, "proven       [{bounds}] m ({evaluations} evaluations)")?;
        writeln!(out, "lowest at    {} m", joined(&certified.best.0))?;
        writeln!(out, "missed by    {} m", self.missed_by())?;
        Ok(())
    }
}

/// The path over the isolines on the plane of the element.
fn figure<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    answer: &Answer<D>,
    scene: &Path,
) -> Result<Figure, PlotError>
where
    Dimensions: Drawable<D>,
{
    let plane = plane(element)?;
    let on_plane = |p: &Point<D>| plane.project(in_space(*p));
    let corners = element.vertices().map(|vertex| on_plane(&vertex));
    let (mut low, mut high) = (corners[0], corners[0]);
    for corner in &corners {
        for k in 0..2 {
            low[k] = low[k].min(corner[k]);
            high[k] = high[k].max(corner[k]);
        }
    }
    let view = View::from_bounds(low, high, MARGIN)?;
    let isolines = picture::isolines(shape, &plane, &view, Sampling::default())?;
    let outline = corners.into_iter().chain([corners[0]]);
    let what = if N == 2 { "segment" } else { "triangle" };
    let Answer { method, found, certified } = answer;
    let isolines = isolines
        .with_polyline(Polyline::new(what, outline)?.faint())
        .with_polyline(Polyline::new(method.name(), found.path.iter().map(on_plane))?)
        .with_markers(Markers::new("step", found.path.iter().skip(1).map(on_plane))?)
        .with_markers(Markers::new("start", found.path.first().map(on_plane))?)
        .with_markers(Markers::new("best found", [on_plane(&found.best)])?)
        .with_markers(Markers::new("proven minimum", [on_plane(&certified.best)])?);
    let [value, lower, upper] = [found.value, certified.lower, certified.upper]
        .map(|value| format!("{value:.5} m").replace('-', "−"));
    let promise = promise_in_words(shape.promise());
    let caption = format!("{promise}. Found: {value}; proven: {lower} to {upper}.");
    Ok(Figure::new(title(scene)).with_caption(caption).with_isolines(isolines))
}

/// The plane of the element, its first edge to the right; one of many through it where it
/// is on a line.
fn plane<const N: usize, const D: usize>(element: &Element<N, D>) -> Result<Slice, PlotError> {
    if D < 3 {
        return Ok(Slice::planar());
    }
    let vertices = element.vertices().map(in_space);
    let [origin, .., last] = vertices.as_slice() else { return Slice::xy(0.0) };
    let way = |to: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| to[k] - origin[k]) };
    let [first, second] = [way(&vertices[1]), way(last)];
    // What two points leave open: upright, and else whatever is across.
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let ways = [(first, second), (first, y), (first, z), (second, y), (second, z)];
    let slices = ways.map(|(right, up)| Slice::free(*origin, right, up));
    slices.into_iter().find_map(Result::ok).map_or_else(|| Slice::free(*origin, x, y), Ok)
}
