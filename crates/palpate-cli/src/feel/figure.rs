// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a run: the path, the proxy and the force over the isolines, and
//! the force over time.

use std::path::Path;

use palpate::field::Vector;
use palpate::haptics::{Recorder, TraceRow};
use palpate::plot::{
    Arrow, Arrows, Chart, Dash, Figure, Isolines, PlotError, Polyline, Quantity, Series,
};
use palpate::scene::BuiltScene;

use crate::input::{self, promise_in_words};
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable};

/// Points of a line at most: more than a picture has columns.
const MOST_POINTS: usize = 2000;

/// Arrows of force at most.
const MOST_ARROWS: usize = 60;

/// The width of a PNG [pixels].
const WIDTH: u32 = 1200;

/// Contact points drawn at most: more than ten lines cannot be told apart.
const MOST_CONTACTS: u32 = 10;

pub(crate) fn draw<const D: usize>(
    scene: &BuiltScene<D>,
    recorder: &Recorder<D>,
    title: &str,
    path: &Path,
) -> Result<(), Failure>
where
    Dimensions: Drawable<D>,
{
    let figure = figure(scene, recorder, title).map_err(Failure::input)?;
    picture::save(&figure, path, WIDTH)
}

fn figure<const D: usize>(
    scene: &BuiltScene<D>,
    recorder: &Recorder<D>,
    title: &str,
) -> Result<Figure, PlotError>
where
    Dimensions: Drawable<D>,
{
    // A scene that was felt has bounds.
    let bounds = input::bounds(scene)
        .unwrap_or_else(|_| palpate::field::Aabb::centred(Vector::constant(0.5)));
    let plane = Dimensions::plane(&bounds)?;
    let view = Dimensions::view(&plane, &bounds)?;
    let mut isolines = picture::isolines(&scene.whole, &plane, &view)?;
    let mut chart = Chart::new(Quantity::new("time", "s"), Quantity::new("force", "N"));
    let contacts = recorder.rows().iter().map(|row| row.point).max().map_or(0, |last| last + 1);
    for contact in 0..contacts.min(MOST_CONTACTS) {
        let rows: Vec<_> = recorder.rows().iter().filter(|row| row.point == contact).collect();
        let name = |what: &str| {
            if contacts == 1 { what.to_owned() } else { format!("{what} {contact}") }
        };
        let project = |p: Vector<f64, D>| Dimensions::project(&plane, p);
        isolines = overlaid(isolines, &rows, &name, &project)?;
        let force =
            thinned(&rows).map(|row| [row.time_s, row.force.norm()]).collect::<Vec<_>>();
        chart = chart.with_series(Series::new(name("force"), force)?);
    }
    Ok(Figure::new(title)
        .with_caption(promise_in_words(scene.whole.promise()))
        .with_isolines(isolines)
        .with_chart(chart))
}

/// The isolines with the lines of one contact point.
fn overlaid<const D: usize>(
    isolines: Isolines,
    rows: &[&TraceRow<D>],
    name: &dyn Fn(&str) -> String,
    project: &dyn Fn(Vector<f64, D>) -> [f64; 2],
) -> Result<Isolines, PlotError> {
    let proxy = thinned(rows).map(|row| project(row.proxy)).collect::<Vec<_>>();
    let hand = thinned(rows).map(|row| project(row.device)).collect::<Vec<_>>();
    let touching: Vec<_> = rows.iter().filter(|row| row.contact).collect();
    let every = touching.len().div_ceil(MOST_ARROWS).max(1);
    let arrows: Vec<_> = touching
        .iter()
        .step_by(every)
        .map(|row| {
            let tail = project(row.proxy);
            let tip = project(row.proxy + row.force);
            Arrow { tail, vector: [tip[0] - tail[0], tip[1] - tail[1]] }
        })
        .collect();
    let isolines = isolines
        .with_polyline(Polyline::new(name("proxy"), proxy)?)
        .with_polyline(Polyline::new(name("hand"), hand)?.with_dash(Dash::Dotted));
    if arrows.is_empty() {
        return Ok(isolines);
    }
    Ok(isolines.with_arrows(Arrows::new(name("force"), "N", arrows)?))
}

/// At most [`MOST_POINTS`] of the rows, evenly.
fn thinned<'a, const D: usize>(
    rows: &'a [&'a TraceRow<D>],
) -> impl Iterator<Item = &'a TraceRow<D>> {
    let every = rows.len().div_ceil(MOST_POINTS).max(1);
    rows.iter().copied().step_by(every)
}
