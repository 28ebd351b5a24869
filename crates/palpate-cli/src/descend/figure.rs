// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The path of a search over an element, drawn over the isolines of its plane.

use std::f64::consts::TAU;
use std::path::Path;

use palpate::field::{Point, Shape};
use palpate::plot::{
    Dash, Figure, Isolines, Markers, PlaneView, PlotError, Polyline, Sampling, Slice,
};
use palpate::query::Element;

use super::circles::Circle;
use super::element::{Answer, name_of};
use super::written;
use crate::picture::{self, Dimensions, Drawable, in_space};
use crate::plot::title;

/// Room around an element in a picture, as a share of its longer side.
const MARGIN: f64 = 0.35;

/// The figure of an answer.
pub(super) fn of<const N: usize, const D: usize>(
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
