// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a run: the path, the proxy and the force over isolines on the slices with
//! most contacts, and the force over time.

use palpate::field::{Aabb, Point, Vector};
use palpate::haptics::{Energy, HeldTool};
use palpate::plot::{
    Arrow, Arrows, Chart, Dash, Figure, Isolines, PlotError, Polyline, Quantity, Sampling,
    Series,
};
use palpate::scene::BuiltScene;
use palpate::servo_loop::{Recorder, TraceRow};

use super::moved;
use super::nearness::{Pieces, Seen, Side, side, taken_apart};
use super::slices::{FeltSlice, felt_slices};
use crate::input::{self, promise_in_words};
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable, Picture, in_space};

/// The most points of a line: more than a picture has columns.
const MOST_POINTS: usize = 2000;

/// The distance between arrows of force, as a share of the picture's sides; closer ones
/// overlap.
const ARROW_SPACING: f64 = 0.025;

/// How much shorter arrows are in figures of two views, which are half as large.
const ARROWS_OF_VIEWS: f64 = 1.6;

/// Up to so many contact points are drawn one by one. The proxies of more are drawn alike, and
/// the chart shows their largest force.
const MOST_CONTACTS: u32 = 3;

pub(crate) fn draw<const D: usize>(
    scene: &BuiltScene<D>,
    recorder: &Recorder<D>,
    title: &str,
    picture: &Picture,
) -> Result<(), Failure>
where
    Dimensions: Drawable<D>,
{
    let figure = figure(scene, recorder, title).map_err(Failure::input)?;
    picture.save(&figure, picture::WIDTH)
}

fn figure<const D: usize>(
    scene: &BuiltScene<D>,
    recorder: &Recorder<D>,
    title: &str,
) -> Result<Figure, PlotError>
where
    Dimensions: Drawable<D>,
{
    // The unit box stands for a scene without bounds.
    let bounds = input::bounds(scene).unwrap_or_else(|_| Aabb::centred(Vector::constant(0.5)));
    let rows = recorder.rows();
    let end = rows.last().map_or(0.0, |row| row.time_s);
    let moved = moved::bounds(scene, end);
    let bounds = with_tools(moved.map_or(bounds, |moved| bounds.union(&moved)), rows);
    let count = rows.iter().map(|row| row.point).max().map_or(0, |last| last + 1);
    let of_point = |point| rows.iter().filter(|row| row.point == point).collect::<Vec<_>>();
    let together = count == 1 || count > MOST_CONTACTS;
    let contacts: Vec<Contacts<'_, D>> = if together {
        vec![Contacts { suffix: String::new(), points: (0..count).map(of_point).collect() }]
    } else {
        let alone =
            |point| Contacts { suffix: format!(" {point}"), points: vec![of_point(point)] };
        (0..count).map(alone).collect()
    };
    let slices = felt_slices(&bounds, rows)?;
    let mut views = Vec::new();
    for slice in &slices {
        let view = Dimensions::view(&slice.plane, &bounds, picture::MARGIN)?;
        let isolines =
            picture::isolines(&scene.whole, &slice.plane, &view, Sampling::default())?;
        let isolines = isolines.with_title(&slice.heading);
        let isolines = moved::drawn_over(isolines, scene, &slice.plane, &view, end)?;
        let spacing = ARROW_SPACING * (view.width() * view.height()).sqrt();
        views.push(overlaid(isolines, slice, &contacts, spacing)?);
    }
    let step = views.iter().map(Isolines::step).fold(0.0, f64::max);
    let views: Vec<_> =
        views.into_iter().map(|view| view.with_step(step)).collect::<Result<_, _>>()?;
    let mut chart = Chart::new(Quantity::new("time", "s"), Quantity::new("force", "N"));
    for contact in &contacts {
        let name = if contact.points.len() > 1 { "largest force" } else { "force" };
        chart = chart.with_series(Series::new(contact.name(name), contact.forces())?);
    }
    let mut caption = promise_in_words(scene.whole.promise());
    if let Some(slice) = slices.iter().find(|slice| slice.near.is_finite()) {
        caption.push_str(&format!(
            ". Bold: within {} mm of the slice; thin: in front of it; dashed: behind it.",
            (1e3 * slice.near * 1e6).round() / 1e6
        ));
    }
    let figure = Figure::new(title).with_caption(caption).with_views(views).with_chart(chart);
    let figure = match torques(rows)? {
        Some(torques) => figure.with_chart(torques),
        None => figure,
    };
    Ok(if rows.iter().any(|row| row.energy != Energy::default()) {
        figure.with_chart(energies(rows, count as usize)?)
    } else {
        figure
    })
}

/// Bounds that also hold the origins of tools in contact, which may be far from the bodies.
fn with_tools<const D: usize>(bounds: Aabb<D>, rows: &[TraceRow<D>]) -> Aabb<D> {
    let touching = rows.iter().filter(|row| row.contact && row.tool.is_some());
    let origins = Aabb::around(touching.map(|row| row.proxy));
    origins.map_or(bounds, |origins| bounds.union(&origins))
}

/// The torque of a tool over time, and the torque written to a device with rotation. `None` for
/// contact points.
fn torques<const D: usize>(rows: &[TraceRow<D>]) -> Result<Option<Chart>, PlotError> {
    let every = rows.len().div_ceil(MOST_POINTS).max(1);
    let of = |torque: fn(&HeldTool<D>) -> Option<Vector<f64, 3>>| {
        let torque = |row: &TraceRow<D>| {
            Some([row.time_s, 1e3 * row.tool.as_ref().and_then(torque)?.norm()])
        };
        rows.iter().step_by(every).filter_map(torque).collect::<Vec<_>>()
    };
    let (wanted, given) = (of(|tool| Some(tool.torque)), of(|tool| tool.given));
    if wanted.is_empty() {
        return Ok(None);
    }
    let chart = Chart::new(Quantity::new("time", "s"), Quantity::new("torque", "mN·m"));
    let chart = chart.with_series(Series::new("torque", wanted)?);
    Ok(Some(if given.is_empty() {
        chart
    } else {
        chart.with_series(Series::new("given to the hand", given)?.with_dash(Dash::Dashed))
    }))
}

/// The energies of all contact points together over time.
fn energies<const D: usize>(rows: &[TraceRow<D>], contacts: usize) -> Result<Chart, PlotError> {
    let names = ["taken from the hand", "given to it", "kept back"];
    let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    let ticks: Vec<&[TraceRow<D>]> = rows.chunks_exact(contacts.max(1)).collect();
    let every = ticks.len().div_ceil(MOST_POINTS).max(1);
    let mut chart = Chart::new(Quantity::new("time", "s"), Quantity::new("energy", "mJ"));
    for (curve, (name, dash)) in names.into_iter().zip(dashes).enumerate() {
        let points = ticks.iter().step_by(every).map(|tick| {
            let energies = tick.iter().map(|row| &row.energy);
            let sum: f64 = energies.map(|e| [e.taken, e.given, e.kept][curve]).sum();
            [tick[0].time_s, 1e3 * sum]
        });
        chart = chart.with_series(Series::new(name, points)?.with_dash(dash));
    }
    Ok(chart)
}

/// The rows of contact points that are drawn alike, and the suffix of their name.
struct Contacts<'a, const D: usize> {
    suffix: String,
    points: Vec<Vec<&'a TraceRow<D>>>,
}

impl<'a, const D: usize> Contacts<'a, D> {
    fn name(&self, what: &str) -> String {
        format!("{what}{}", self.suffix)
    }

    /// The lines of all points, cut into pieces near, in front of and behind the slice.
    fn parted(&self, slice: &FeltSlice, place: fn(&TraceRow<D>) -> Point<D>) -> Vec<Seen> {
        let line = |rows: &Vec<&'a TraceRow<D>>| {
            let line: Vec<_> = thinned(rows).map(place).collect();
            taken_apart::<D>(&slice.plane, slice.near, line)
        };
        self.points.iter().map(line).collect()
    }

    /// The largest force at each time [N].
    fn forces(&self) -> Vec<[f64; 2]> {
        let ticks = self.points.iter().map(Vec::len).max().unwrap_or(0);
        let every = ticks.div_ceil(MOST_POINTS).max(1);
        let tick = |i: usize| {
            let rows = self.points.iter().filter_map(|rows| rows.get(i));
            let time = rows.clone().next().map_or(0.0, |row| row.time_s);
            [time, rows.map(|row| row.force.norm()).fold(0.0, f64::max)]
        };
        (0..ticks).step_by(every).map(tick).collect()
    }
}

/// The isolines with the lines of the contact points. Pieces far from the slice are faint, and
/// lie below those near it.
fn overlaid<const D: usize>(
    mut isolines: Isolines,
    slice: &FeltSlice,
    contacts: &[Contacts<'_, D>],
    spacing: f64,
) -> Result<Isolines, PlotError> {
    let (mut in_front, mut behind) = (Pieces::new(), Pieces::new());
    let mut proxies = Vec::new();
    for contact in contacts {
        let mut near = Pieces::new();
        for proxy in contact.parted(slice, |row| row.proxy) {
            in_front.extend(proxy.in_front);
            behind.extend(proxy.behind);
            near.extend(proxy.near);
        }
        proxies.push(near);
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
    let rows = contacts.iter().flat_map(|contact| &contact.points).flatten();
    let has_tool = rows.clone().any(|row| row.tool.is_some());
    let followed = if has_tool { "tool's origin" } else { "proxy" };
    let forces = rows.map(|row| row.force.norm());
    let shortened = if D < 3 { 1.0 } else { ARROWS_OF_VIEWS };
    let full_length = shortened * forces.fold(0.0, f64::max);
    for (contact, proxy) in contacts.iter().zip(proxies) {
        let hand = contact.parted(slice, |row| row.device).into_iter();
        let hand: Pieces = hand.flat_map(|hand| hand.near).collect();
        let hand = Polyline::of_pieces(contact.name("hand"), hand)?;
        isolines = isolines
            .with_polyline(Polyline::of_pieces(contact.name(followed), proxy)?)
            .with_polyline(hand.with_dash(Dash::Dotted));
        let arrows = arrows(slice, contact, spacing);
        if !arrows.is_empty() {
            let arrows = Arrows::new(contact.name("force"), "N", arrows)?;
            isolines = isolines.with_arrows(arrows.with_full_length(full_length));
        }
    }
    Ok(isolines)
}

/// The parts in the slice of forces near it, at places `spacing` apart [m].
fn arrows<const D: usize>(
    slice: &FeltSlice,
    contact: &Contacts<'_, D>,
    spacing: f64,
) -> Vec<Arrow> {
    let is_seen = |row: &TraceRow<D>| {
        row.contact && side(&slice.plane, slice.near, row.proxy) == Side::Near
    };
    let mut arrows: Vec<Arrow> = Vec::new();
    let touches =
        contact.points.iter().flat_map(|rows| rows.chunk_by(|a, b| is_seen(a) == is_seen(b)));
    for touch in touches.filter(|touch| touch.iter().all(|row| is_seen(row))) {
        let tails: Vec<_> =
            touch.iter().map(|row| slice.plane.project(in_space(row.proxy))).collect();
        for i in evenly(&tails, spacing) {
            let vector = slice.plane.project_vector(in_space(touch[i].force));
            // The hand may return to a place, which has its arrow already.
            if arrows.iter().all(|arrow| apart(arrow.tail, tails[i]) >= 0.6 * spacing) {
                arrows.push(Arrow { tail: tails[i], vector });
            }
        }
    }
    arrows
}

/// Divides a line into equal parts about `spacing` long [m], and returns the index of the point
/// in the middle of each; at least one.
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
    fn an_arrow_stands_in_the_middle_of_its_part_of_the_line() {
        let line: Vec<_> = (0..=100).map(|i| [0.01 * f64::from(i), 2.0]).collect();
        assert_eq!(evenly(&line, 0.4), [25, 75]);
        assert_eq!(evenly(&line, 5.0), [50]);
        assert_eq!(evenly(&[[1.0, 2.0]], 0.4), [0]);
        assert_eq!(evenly(&[[1.0, 2.0]; 3], 0.4), [0]);
    }
}
