// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a run: the path, the proxy and the force over isolines on the slices
//! where most was felt, and the force over time.

use std::path::Path;

use palpate::field::{Aabb, Vector};
use palpate::haptics::{Energy, Recorder, TraceRow};
use palpate::plot::{
    Arrow, Arrows, Chart, Dash, Figure, Isolines, PlotError, Polyline, Quantity, Sampling,
    Series,
};
use palpate::scene::BuiltScene;

use super::nearness::{Pieces, Side, side, taken_apart};
use super::slices::{FeltSlice, felt_slices};
use crate::input::{self, promise_in_words};
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable, in_space};

/// Points of a line at most: more than a picture has columns.
const MOST_POINTS: usize = 2000;

/// Arrows of force are this part of the picture's sides apart, so that each is seen.
const ARROW_SPACING: f64 = 0.025;

/// How much shorter arrows are drawn where there are two views: each is half as large.
const ARROWS_OF_VIEWS: f64 = 1.6;

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
    picture::save(&figure, path, picture::WIDTH)
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
    let bounds = input::bounds(scene).unwrap_or_else(|_| Aabb::centred(Vector::constant(0.5)));
    let rows = recorder.rows();
    let count = rows.iter().map(|row| row.point).max().map_or(0, |last| last + 1);
    let contacts: Vec<Contact<'_, D>> = (0..count.min(MOST_CONTACTS))
        .map(|contact| Contact {
            suffix: if count == 1 { String::new() } else { format!(" {contact}") },
            rows: rows.iter().filter(|row| row.point == contact).collect(),
        })
        .collect();
    let slices = felt_slices(&bounds, rows)?;
    let mut views = Vec::new();
    for slice in &slices {
        let view = Dimensions::view(&slice.plane, &bounds, picture::MARGIN)?;
        let isolines =
            picture::isolines(&scene.whole, &slice.plane, &view, Sampling::default())?;
        let isolines = isolines.with_title(&slice.heading);
        let spacing = ARROW_SPACING * (view.width() * view.height()).sqrt();
        views.push(overlaid(isolines, slice, &contacts, spacing)?);
    }
    let step = views.iter().map(Isolines::step).fold(0.0, f64::max);
    let views: Vec<_> =
        views.into_iter().map(|view| view.with_step(step)).collect::<Result<_, _>>()?;
    let mut chart = Chart::new(Quantity::new("time", "s"), Quantity::new("force", "N"));
    for contact in &contacts {
        let force = thinned(&contact.rows).map(|row| [row.time_s, row.force.norm()]);
        chart = chart.with_series(Series::new(contact.name("force"), force)?);
    }
    let mut caption = promise_in_words(scene.whole.promise());
    if let Some(slice) = slices.iter().find(|slice| slice.near.is_finite()) {
        caption.push_str(&format!(
            ". Bold: within {} mm of the slice; thin: in front of it; dashed: behind it.",
            (1e3 * slice.near * 1e6).round() / 1e6
        ));
    }
    let figure = Figure::new(title).with_caption(caption).with_views(views).with_chart(chart);
    Ok(if rows.iter().any(|row| row.energy != Energy::default()) {
        figure.with_chart(energies(rows, count as usize)?)
    } else {
        figure
    })
}

/// The energies of all contact points together over time.
fn energies<const D: usize>(rows: &[TraceRow<D>], contacts: usize) -> Result<Chart, PlotError> {
    let curves: [(&str, fn(&Energy) -> f64, Dash); 3] = [
        ("taken from the hand", |energy| energy.taken, Dash::Solid),
        ("given to it", |energy| energy.given, Dash::Dashed),
        ("kept back", |energy| energy.kept, Dash::Dotted),
    ];
    let ticks: Vec<&[TraceRow<D>]> = rows.chunks_exact(contacts.max(1)).collect();
    let every = ticks.len().div_ceil(MOST_POINTS).max(1);
    let mut chart = Chart::new(Quantity::new("time", "s"), Quantity::new("energy", "mJ"));
    for (name, of, dash) in curves {
        let points = ticks.iter().step_by(every).map(|tick| {
            let sum: f64 = tick.iter().map(|row| of(&row.energy)).sum();
            [tick[0].time_s, 1e3 * sum]
        });
        chart = chart.with_series(Series::new(name, points)?.with_dash(dash));
    }
    Ok(chart)
}

/// The rows of one contact point, and what its number adds to a name.
struct Contact<'a, const D: usize> {
    suffix: String,
    rows: Vec<&'a TraceRow<D>>,
}

impl<const D: usize> Contact<'_, D> {
    fn name(&self, what: &str) -> String {
        format!("{what}{}", self.suffix)
    }
}

/// The isolines with the lines of the contact points: what is far from the slice faint, below
/// what is near it.
fn overlaid<const D: usize>(
    mut isolines: Isolines,
    slice: &FeltSlice,
    contacts: &[Contact<'_, D>],
    spacing: f64,
) -> Result<Isolines, PlotError> {
    let parted = |points| taken_apart::<D>(&slice.plane, slice.near, points);
    let (mut in_front, mut behind) = (Pieces::new(), Pieces::new());
    let mut proxies = Vec::new();
    for contact in contacts {
        let proxy = parted(thinned(&contact.rows).map(|row| row.proxy).collect::<Vec<_>>());
        in_front.extend(proxy.in_front);
        behind.extend(proxy.behind);
        proxies.push(proxy.near);
    }
    let far = [
        ("behind the slice", behind, Dash::Dashed),
        ("in front of the slice", in_front, Dash::Solid),
    ];
    for (name, pieces, dash) in far {
        if !pieces.is_empty() {
            let line = Polyline::of_pieces(name, pieces)?.faint().with_dash(dash);
            isolines = isolines.with_polyline(line);
        }
    }
    let forces = contacts.iter().flat_map(|contact| &contact.rows).map(|row| row.force.norm());
    let shortened = if D < 3 { 1.0 } else { ARROWS_OF_VIEWS };
    let full_length = shortened * forces.fold(0.0, f64::max);
    for (contact, proxy) in contacts.iter().zip(proxies) {
        let hand = parted(thinned(&contact.rows).map(|row| row.device).collect::<Vec<_>>());
        let hand = Polyline::of_pieces(contact.name("hand"), hand.near)?;
        isolines = isolines
            .with_polyline(Polyline::of_pieces(contact.name("proxy"), proxy)?)
            .with_polyline(hand.with_dash(Dash::Dotted));
        let arrows = arrows(slice, contact, spacing);
        if !arrows.is_empty() {
            let arrows = Arrows::new(contact.name("force"), "N", arrows)?;
            isolines = isolines.with_arrows(arrows.with_full_length(full_length));
        }
    }
    Ok(isolines)
}

/// The forces near the slice, as far as they lie in it, at places `spacing` apart [m].
fn arrows<const D: usize>(
    slice: &FeltSlice,
    contact: &Contact<'_, D>,
    spacing: f64,
) -> Vec<Arrow> {
    let is_seen = |row: &TraceRow<D>| {
        row.contact && side(&slice.plane, slice.near, row.proxy) == Side::Near
    };
    let mut arrows: Vec<Arrow> = Vec::new();
    let touches = contact.rows.chunk_by(|a, b| is_seen(a) == is_seen(b));
    for touch in touches.filter(|touch| touch.iter().all(|row| is_seen(row))) {
        let tails: Vec<_> =
            touch.iter().map(|row| slice.plane.project(in_space(row.proxy))).collect();
        for i in evenly(&tails, spacing) {
            let vector = slice.plane.project_vector(in_space(touch[i].force));
            // The hand may come to a place again.
            if arrows.iter().all(|arrow| apart(arrow.tail, tails[i]) >= 0.6 * spacing) {
                arrows.push(Arrow { tail: tails[i], vector });
            }
        }
    }
    arrows
}

/// The points in the middles of equal parts of a line, each about `spacing` long [m]: one at
/// least.
fn evenly(line: &[[f64; 2]], spacing: f64) -> Vec<usize> {
    let ways = line.windows(2).map(|pair| apart(pair[0], pair[1]));
    let sums = ways.scan(0.0, |sum, way| {
        *sum += way;
        Some(*sum)
    });
    let passed: Vec<f64> = std::iter::once(0.0).chain(sums).collect();
    let length = passed[passed.len() - 1];
    let parts = (length / spacing).floor().max(1.0) as u32;
    let middle = |part: u32| (f64::from(part) + 0.5) / f64::from(parts) * length;
    (0..parts).map(|part| passed.partition_point(|way| *way < middle(part))).collect()
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// At most [`MOST_POINTS`] of the rows, evenly.
fn thinned<'a, const D: usize>(
    rows: &'a [&'a TraceRow<D>],
) -> impl Iterator<Item = &'a TraceRow<D>> {
    let every = rows.len().div_ceil(MOST_POINTS).max(1);
    rows.iter().copied().step_by(every)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_stand_in_the_middle_of_what_they_are_for() {
        let line: Vec<_> = (0..=100).map(|i| [0.01 * f64::from(i), 2.0]).collect();
        assert_eq!(evenly(&line, 0.4), [25, 75]);
        assert_eq!(evenly(&line, 5.0), [50]);
        assert_eq!(evenly(&[[1.0, 2.0]], 0.4), [0]);
        assert_eq!(evenly(&[[1.0, 2.0]; 3], 0.4), [0]);
    }
}
