// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend` over a segment or a triangle.

use std::f64::consts::TAU;
use std::fmt;
use std::path::Path;
use std::time::{Duration, Instant};

use palpate::field::{BoundingBall, Point, Shape, Vector};
use palpate::local::{Descent, ElementMethod, NaiveDescent};
use palpate::plot::{
    Dash, Figure, Isolines, Markers, PlaneView, PlotError, Polyline, Sampling, Slice,
};
use palpate::query::{Certified, Element, ElementWorkspace, minimum};
use palpate::scene::BuiltScene;
use palpate::scene::text::joined;
use serde::Serialize;

use super::{Found, Search, limits, written};
use crate::descend::DescendOptions;
use crate::input::{self, longest_edge};
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::output::microseconds;
use crate::picture::{self, Dimensions, Drawable, Picture, in_space};
use crate::plot::title;

/// The result of a local search over an element, and the proven minimum.
pub(super) struct Answer<const N: usize, const D: usize> {
    pub(super) element: Element<N, D>,
    pub(super) search: Search<N>,
    pub(super) found: Timed<Descent<D>>,
    pub(super) certified: Timed<Certified<Point<D>>>,
    pub(super) ending: EndOfPath<D>,
    pub(super) circles: Circles<D>,
}

/// A result, and the time that it takes [s].
pub(super) struct Timed<T> {
    pub(super) result: T,
    time: f64,
}

impl<T> Timed<T> {
    /// The least time of some runs: the first one is slower, and others may be disturbed.
    fn of(mut work: impl FnMut() -> T) -> Self {
        const MOST_RUNS: u32 = 16;
        const ENOUGH: Duration = Duration::from_millis(20);
        let begin = Instant::now();
        let mut least = Duration::MAX;
        let mut runs = 0;
        loop {
            let start = Instant::now();
            let result = work();
            least = least.min(start.elapsed());
            runs += 1;
            if runs == MOST_RUNS || begin.elapsed() > ENOUGH {
                return Self { result, time: least.as_secs_f64() };
            }
        }
    }
}

/// Searches over the element with these vertices.
pub(super) fn descend<const N: usize, const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
    vertices: &[String],
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let element = element::<N, D>(vertices)?;
    let search = Search::of::<D>(options)?;
    // Of a long element over a small scene, most is far away.
    let scene_size = scene.bounds().map_or(f64::INFINITY, |bounds| longest_edge(&bounds));
    // Of a point, only the scene has a size.
    let size = match element.longest_edge() {
        edge if edge > 0.0 => edge.min(scene_size),
        _ if scene_size < f64::INFINITY => scene_size,
        _ => 1.0,
    };
    let limits = limits(options.tolerance, size);
    let shape = &scene.whole;
    let mut workspace = ElementWorkspace::new();
    let proof = Timed::of(|| minimum(shape, &element, &limits, &mut workspace));
    let certified = Timed { result: proof.result.map_err(Failure::input)?, time: proof.time };
    let found = Timed::of(|| search.run(shape, &element));
    let answer = Answer {
        ending: EndOfPath::of(shape, &found.result, &certified.result, size),
        circles: Circles::of(shape, &element),
        certified,
        element,
        search,
        found,
    };
    output::answer().print(&answer.report(), options.json)?;
    if let Some(picture) = picture {
        let figure = figure_of(shape, &answer, &options.scene);
        picture.save(&figure.map_err(Failure::input)?, picture::WIDTH)?;
    }
    Ok(Outcome::Yes)
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

/// An element in words.
pub(super) const fn name_of<const N: usize>() -> &'static str {
    if N == 2 { "segment" } else { "triangle" }
}

impl<const N: usize, const D: usize> Answer<N, D> {
    /// How much lower than the found value some point is at least [m]; zero if no lower point
    /// is proven.
    fn missed_by(&self) -> f64 {
        (self.found.result.value - self.certified.result.upper).max(0.0)
    }

    /// How many evaluations the memoir counts for its descent.
    fn memoir_count(&self) -> Option<u32> {
        let is_memoirs = self.search.method == ElementMethod::Naive;
        is_memoirs.then(|| NaiveDescent::MEMOIR_EVALUATIONS * self.found.result.steps)
    }

    fn report(&self) -> Report<'_, D> {
        let Self { element, search, found, certified, .. } = self;
        let naive = &search.naive;
        let naive = self.memoir_count().map(|memoir_evaluations| Naive {
            alpha: naive.alpha,
            mu: naive.mu_for(element),
            gradient: naive.gradient_in::<D>().name(),
            memoir_evaluations,
        });
        Report {
            method: search.method.name(),
            naive,
            found: Found::from(&found.result),
            time: found.time,
            missed_by: self.missed_by(),
            ending: &self.ending,
            circles: &self.circles,
            certified: ProvenMinimum {
                minimum: certified.result.map(|best| best.0.to_vec()),
                time: certified.time,
            },
            search: search.in_words(element),
            element: name_of::<N>(),
        }
    }
}

/// The answer of `palpate descend` over a segment or a triangle.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Report<'a, const D: usize> {
    /// The name of the search.
    method: &'static str,
    /// The constants of the naive search.
    #[serde(flatten)]
    naive: Option<Naive>,
    #[serde(flatten)]
    found: Found,
    /// The time that the search takes [s].
    time: f64,
    /// How far the value is above one that is proven to be taken [m].
    missed_by: f64,
    /// The end of the path.
    ending: &'a EndOfPath<D>,
    /// The circles around the element, and whether they exclude it.
    circles: &'a Circles<D>,
    /// The search with a proof.
    certified: ProvenMinimum,
    /// The method, with its constants.
    #[serde(skip)]
    search: String,
    /// What the search is over.
    #[serde(skip)]
    element: &'static str,
}

/// With the method `naive` alone.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Naive {
    /// The factor of a step, with the method `naive` alone.
    alpha: f64,
    /// The step of a search [m], with the method `naive` alone.
    mu: f64,
    /// The method of gradients, with the method `naive` alone.
    gradient: &'static str,
    /// Ten evaluations for each step, as the memoir counts, with the method `naive` alone.
    memoir_evaluations: u32,
}

/// The proven minimum.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct ProvenMinimum {
    #[serde(flatten)]
    minimum: Certified<Vec<f64>>,
    /// The time that the search takes [s].
    time: f64,
}

impl<const D: usize> fmt::Display for Report<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { found, certified: ProvenMinimum { minimum, time: proof_time }, .. } = self;
        let [time, proof_time] = [self.time, *proof_time].map(microseconds);
        let metres = |length: f64| format!("{length} m");
        writeln!(f, "method       {}", self.search)?;
        writeln!(f, "best point   {} m", joined(&found.best))?;
        writeln!(f, "value        {} m, an upper bound", found.value)?;
        write!(f, "steps        {} ({} evaluations, {time}", found.steps, found.evaluations)?;
        match &self.naive {
            Some(Naive { memoir_evaluations, .. }) => {
                writeln!(f, "; the memoir counts 10 a gradient: {memoir_evaluations})")?;
            }
            None => writeln!(f, ")")?,
        }
        writeln!(f, "ended        {}", self.ending.in_words(metres))?;
        let bounds = joined(&[minimum.lower, minimum.upper]);
        let evaluations = minimum.evaluations;
        writeln!(f, "proven       [{bounds}] m ({evaluations} evaluations, {proof_time})")?;
        writeln!(f, "lowest at    {} m", joined(&minimum.best))?;
        writeln!(f, "missed by    {} m, with the best point", self.missed_by)?;
        self.circles.all().try_for_each(|circle| {
            let words = circle.in_words(self.element, metres);
            writeln!(f, "{} about {} m: {words}", circle.name, circle.centre())
        })
    }
}

/// Balls around an element; circles in the plane.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Circles<const D: usize> {
    /// The smallest ball.
    smallest: Circle<D>,
    /// The ball through the corners; `null` of a segment, for which it is the smallest, and of
    /// corners on a line.
    circumscribed: Option<Circle<D>>,
}

/// A ball around an element, and what the field says at its centre.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Circle<const D: usize> {
    #[serde(skip)]
    pub(super) name: &'static str,
    /// The centre [m].
    pub(super) centre: Point<D>,
    /// The radius [m].
    pub(super) radius: f64,
    /// The field's value at the centre [m].
    value: f64,
    /// The memoir's test, f(C) > r: `true` if the value exceeds the radius.
    excludes: bool,
    /// `true` if the field's promise proves that the ball does not meet the shape.
    is_proven: bool,
}

impl<const D: usize> Circles<D> {
    pub(super) fn of<const N: usize>(shape: &Shape<D>, element: &Element<N, D>) -> Self {
        let [smallest, circumscribed] = if D == 2 {
            ["smallest circle", "circumscribed circle"]
        } else {
            ["smallest ball", "circumscribed ball"]
        };
        let around = element.circumscribed_ball().filter(|_| N == 3);
        Self {
            smallest: Circle::of(smallest, shape, element.smallest_ball()),
            circumscribed: around.map(|ball| Circle::of(circumscribed, shape, ball)),
        }
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Circle<D>> {
        [&self.smallest].into_iter().chain(&self.circumscribed)
    }
}

impl<const D: usize> Circle<D> {
    fn of(name: &'static str, shape: &Shape<D>, ball: BoundingBall<D>) -> Self {
        let BoundingBall { centre, radius } = ball;
        let value = shape.distance(centre);
        let is_proven = value > 0.0 && shape.safe_radius(centre) > radius;
        Self { name, centre, radius, value, excludes: value > radius, is_proven }
    }

    /// The comparison in words, with lengths as `length` writes them.
    pub(super) fn in_words(&self, what: &str, length: impl Fn(f64) -> String) -> String {
        let sign = if self.excludes { ">" } else { "≤" };
        let [value, radius] = [self.value, self.radius].map(length);
        let verdict = match (self.excludes, self.is_proven) {
            (true, true) => "excludes",
            // Too steep a field, or a difference within rounding.
            (true, false) => "excludes, without a proof,",
            _ => "does not exclude",
        };
        format!("f(C) = {value} {sign} r = {radius}: {verdict} the {what}")
    }

    /// The centre as text.
    pub(super) fn centre(&self) -> String {
        joined(&self.centre.0)
    }
}

/// Values nearer than this share of the size of element and scene count as equal: the tolerance of the
/// proven bounds ten times.
const NEAR: f64 = 10.0 * super::TOLERANCE;

/// The end of a path.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct EndOfPath<const D: usize> {
    /// What the last point is.
    at: Place,
    /// The last point [m].
    point: Point<D>,
    /// The value there [m].
    value: f64,
    /// How far the value is above the least that is proven to be taken, at least zero [m].
    above_minimum: f64,
    /// The peak-to-peak amplitude of an oscillation at the end of the path [m].
    oscillation: Option<f64>,
}

/// What the last point of a path is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(schemars::JsonSchema))]
enum Place {
    /// The minimum.
    Minimum,
    /// On the surface; the minimum lies inside.
    Surface,
    /// Neither.
    Elsewhere,
}

impl<const D: usize> EndOfPath<D> {
    /// The end of `found` over an element of this size [m].
    pub(super) fn of(
        shape: &Shape<D>,
        found: &Descent<D>,
        certified: &Certified<Point<D>>,
        size: f64,
    ) -> Self {
        let point = found.path.last().copied().unwrap_or(found.best);
        let value = shape.distance(point);
        let (near, above) = (NEAR * size, (value - certified.upper).max(0.0));
        let at = if above <= near {
            Place::Minimum
        } else if value.abs() <= near {
            // Lower values by more than that are inside.
            Place::Surface
        } else {
            Place::Elsewhere
        };
        Self { at, point, value, above_minimum: above, oscillation: found.oscillation() }
    }

    /// In words, with lengths as `length` writes them.
    pub(super) fn in_words(&self, length: impl Fn(f64) -> String) -> String {
        let above = length(self.above_minimum);
        let place = match self.at {
            Place::Minimum => "at the minimum".to_owned(),
            Place::Surface => {
                format!("at the surface, {above} above the minimum, which is inside")
            }
            Place::Elsewhere => format!("{above} above the minimum"),
        };
        match self.oscillation {
            Some(amplitude) => format!("{place}, oscillating by {}", length(amplitude)),
            None => place,
        }
    }
}

/// Room around an element in a picture, as a share of its longer side.
const MARGIN: f64 = 0.35;

/// The figure of an answer.
fn figure_of<const N: usize, const D: usize>(
    shape: &Shape<D>,
    answer: &Answer<N, D>,
    scene: &Path,
) -> Result<Figure, PlotError>
where
    Dimensions: Drawable<D>,
{
    let plane = plane(&answer.element)?;
    let on_plane = |p: &Point<D>| plane.project(in_space(*p));
    let corners = answer.element.vertices().map(|vertex| on_plane(&vertex));
    let (mut low, mut high) = (corners[0], corners[0]);
    for corner in &corners {
        for k in 0..2 {
            low[k] = low[k].min(corner[k]);
            high[k] = high[k].max(corner[k]);
        }
    }
    let view = PlaneView::from_bounds(low, high, MARGIN)?;
    let mut isolines = picture::isolines(shape, &plane, &view, Sampling::default())?;
    let outline = corners.into_iter().chain([corners[0]]);
    isolines = isolines.with_polyline(Polyline::new(name_of::<N>(), outline)?.faint());
    for (circle, dash) in answer.circles.all().zip([Dash::Dashed, Dash::Dotted]) {
        isolines = with_circle(isolines, circle, on_plane(&circle.centre), dash)?;
    }
    let (found, certified) = (&answer.found.result, &answer.certified.result);
    let isolines = isolines
        .with_polyline(Polyline::new(
            answer.search.method.name(),
            found.path.iter().map(on_plane),
        )?)
        .with_markers(Markers::new("step", found.path.iter().skip(1).map(on_plane))?.small())
        .with_markers(Markers::new("start", found.path.first().map(on_plane))?)
        .with_markers(Markers::new("best found", [on_plane(&found.best)])?)
        .with_markers(Markers::new("proven minimum", [on_plane(&certified.best)])?);
    let figure = Figure::new(title(scene)).with_caption(caption(shape, answer));
    Ok(figure.with_isolines(isolines))
}

/// What was found, proven and excluded, in words.
fn caption<const N: usize, const D: usize>(shape: &Shape<D>, answer: &Answer<N, D>) -> String {
    let (found, certified) = (&answer.found.result, &answer.certified.result);
    let [value, lower, upper] = [found.value, certified.lower, certified.upper].map(written);
    let mut caption = format!(
        "{}. Found: {value}; proven: {lower} to {upper}. Ended {}.",
        shape.promise().in_words(),
        answer.ending.in_words(written),
    );
    for circle in answer.circles.all() {
        let words = circle.in_words(name_of::<N>(), written);
        caption.push_str(&format!(" {}: {words}.", capitalised(circle.name)));
    }
    caption
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// With a circle around its `centre` in the plane, which passes through that of the ball.
fn with_circle<const D: usize>(
    isolines: Isolines,
    circle: &Circle<D>,
    centre: [f64; 2],
    dash: Dash,
) -> Result<Isolines, PlotError> {
    /// Corners of the drawn polygon, whose sides are off by 1/5000 of the radius.
    const CORNERS: u32 = 160;
    let radius = circle.radius;
    let corner = |i: u32| {
        let (sine, cosine) = (TAU * f64::from(i) / f64::from(CORNERS)).sin_cos();
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    };
    let line = Polyline::new(circle.name, (0..=CORNERS).map(corner))?;
    Ok(isolines.with_polyline(line.faint().with_dash(dash)))
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
