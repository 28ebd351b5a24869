// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend`: a local search over an element or between two bodies, compared with the
//! proven minimum.

mod pair;

use std::io::Write;
use std::path::Path;
use std::str::FromStr;

use palpate::field::{Aabb, Point, Shape, Vector};
use palpate::local::{Descent, ElementMethod, UnknownMethod};
use palpate::plot::{Figure, Markers, PlotError, Polyline, Sampling, Slice, View};
use palpate::query::{Certified, Element, ElementWorkspace, Limits, minimum};
use palpate::scene::{AnyScene, BuiltScene};
use serde_json::{Value, json};

use crate::arguments::DescendOptions;
use crate::input::{self, joined, promise_in_words};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files};
use crate::picture::{self, Dimensions, Drawable, Picture, in_space};
use crate::plot::title;

/// How far apart the bounds of the minimum may be, as a share of the longest edge.
const TOLERANCE: f64 = 1e-4;

/// Room around an element in a picture, as a share of its longer side.
const MARGIN: f64 = 0.35;

pub(crate) fn run(options: &DescendOptions) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.scene.as_path()]);
    let picture = options.plot.as_deref().map(|path| Picture::new(&mut files, path));
    let picture = picture.transpose()?;
    match &input::scene(Some(&options.scene))?.scene {
        AnyScene::Planar(scene) => over_points(options, scene, picture.as_ref()),
        AnyScene::Spatial(scene) => over_points(options, scene, picture.as_ref()),
    }
}

fn over_points<const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    if options.start.is_empty() && options.triangle.is_empty() && options.segment.is_empty() {
        Err(nothing_asked(scene, &options.scene))
    } else if !options.start.is_empty() {
        pair::between(options, scene, picture)
    } else if options.triangle.is_empty() {
        descend(options, scene, picture, &element::<2, D>(&options.segment)?)
    } else {
        descend(options, scene, picture, &element::<3, D>(&options.triangle)?)
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
         with 1; for example: palpate descend {path} --segment {from} {to}"
    ))
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

/// The result of a local search over an element, and the proven minimum.
struct Answer<const D: usize> {
    method: ElementMethod,
    found: Descent<D>,
    certified: Certified<Point<D>>,
}

fn descend<const N: usize, const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
    element: &Element<N, D>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let edges = element.vertices().iter().zip(element.vertices().iter().skip(1));
    let last = (element.vertices()[0] - element.vertices()[N - 1]).norm();
    let longest = edges.fold(last, |longest, (a, b)| longest.max((*a - *b).norm()));
    let limits = limits(options.tolerance, longest);
    let method = method(options, ElementMethod::ProjectedGradient)?;
    let answer = Answer {
        method,
        found: method.descend(&scene.whole, element),
        certified: minimum(&scene.whole, element, &limits, &mut ElementWorkspace::new())
            .map_err(Failure::input)?,
    };
    answer.print(options.json)?;
    if let Some(picture) = picture {
        let figure = figure(&scene.whole, element, &answer, &options.scene);
        picture.save(&figure.map_err(Failure::input)?, picture::WIDTH)?;
    }
    Ok(Outcome::Yes)
}

/// The requested method, or `first`.
fn method<T: FromStr<Err = UnknownMethod>>(
    options: &DescendOptions,
    first: T,
) -> Result<T, Failure> {
    let name = options.method.as_deref();
    name.map_or(Ok(first), str::parse)
        .map_err(|error| Failure::input(format!("--method: {error}")))
}

/// The limits of the search with a proof, over something of this size [m].
fn limits(tolerance: Option<f64>, size: f64) -> Limits {
    Limits::new(tolerance.unwrap_or(TOLERANCE * size))
}

/// The result of a local search, as JSON.
fn described<const D: usize>(found: &Descent<D>) -> Value {
    let path: Vec<_> = found.path.iter().map(|p| p.0.to_vec()).collect();
    json!({
        "best_point_m": found.best.0.to_vec(),
        "value_m": found.value,
        "steps": found.steps,
        "evaluations": found.evaluations,
        "path_m": path,
    })
}

/// A length as figures write it.
fn written(length: f64) -> String {
    /// Parts of a metre.
    const ROUND: f64 = 1e5;
    // Adding zero turns −0 into 0.
    let rounded = (length * ROUND).round() / ROUND + 0.0;
    format!("{rounded:.5} m").replace('-', "−")
}

impl<const D: usize> Answer<D> {
    /// How much lower than the found value some point is at least [m]; zero if no lower point
    /// is proven.
    fn missed_by(&self) -> f64 {
        (self.found.value - self.certified.upper).max(0.0)
    }

    fn print(&self, as_json: bool) -> Result<(), Failure> {
        let Self { method, found, certified } = self;
        let mut out = output::answer();
        if as_json {
            let mut answer = described(found);
            answer["method"] = method.name().into();
            answer["missed_by_m"] = self.missed_by().into();
            answer["certified"] = json!({
                "best_point_m": certified.best.0.to_vec(),
                "lower_m": certified.lower,
                "upper_m": certified.upper,
                "evaluations": certified.evaluations,
            });
            out.json(&answer)?;
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
    let [value, lower, upper] = [found.value, certified.lower, certified.upper].map(written);
    let promise = promise_in_words(shape.promise());
    let caption = format!("{promise}. Found: {value}; proven: {lower} to {upper}.");
    Ok(Figure::new(title(scene)).with_caption(caption).with_isolines(isolines))
}

/// The plane of the element, with its first edge to the right. If the element lies on a line,
/// one of the planes through the line.
fn plane<const N: usize, const D: usize>(element: &Element<N, D>) -> Result<Slice, PlotError> {
    if D < 3 {
        return Ok(Slice::planar());
    }
    let vertices = element.vertices().map(in_space);
    let [origin, .., last] = vertices.as_slice() else { return Slice::xy(0.0) };
    let way = |to: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| to[k] - origin[k]) };
    let [first, second] = [way(&vertices[1]), way(last)];
    // On a line, up is y, or z if the line is along y; an edge of no length is passed over.
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let ways = [(first, second), (first, y), (first, z), (second, y), (second, z)];
    let slices = ways.map(|(right, up)| Slice::free(*origin, right, up));
    slices.into_iter().find_map(Result::ok).map_or_else(|| Slice::free(*origin, x, y), Ok)
}
