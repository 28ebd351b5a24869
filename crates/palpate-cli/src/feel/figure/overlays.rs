// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The lines and forces of contact points over isolines.

use palpate::plot::{Arrow, Arrows, Dash, Isolines, PlotError, Polyline};
use palpate::servo_loop::TraceRow;

use super::super::paths::{Pieces, Side, side};
use super::points::Points;
use crate::feel::slices::FeltSlice;

/// The distance between arrows of force, as a share of the picture's sides; closer ones
/// overlap.
pub(super) const ARROW_SPACING: f64 = 0.025;

/// How much shorter arrows are in figures of two views, which are half as large.
const ARROWS_OF_VIEWS: f64 = 1.6;

/// The isolines with the lines of the contact points. Pieces far from the slice are faint, and
/// lie below those near it.
pub(super) fn drawn(
    mut isolines: Isolines,
    slice: &FeltSlice,
    points: &Points<'_>,
    spacing: f64,
) -> Result<Isolines, PlotError> {
    let (mut in_front, mut behind) = (Pieces::new(), Pieces::new());
    let mut proxies = Vec::new();
    for group in points.groups() {
        let mut near = Pieces::new();
        for &number in &group {
            let proxy = points.parted(number, slice, |row| row.proxy);
            in_front.extend(proxy.in_front);
            behind.extend(proxy.behind);
            near.extend(proxy.near);
        }
        proxies.push((group, near));
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
    let all = || (0..points.count()).flat_map(|number| points.rows(number));
    let followed = if all().any(|row| row.tool.is_some()) { "tool's origin" } else { "proxy" };
    let shortened = if slice.near.is_finite() { ARROWS_OF_VIEWS } else { 1.0 };
    let full_length = shortened * all().map(|row| row.force.norm()).fold(0.0, f64::max);
    for (group, near) in proxies {
        let color = points.color(group[0]);
        let alone = group.len() == 1;
        let name = if alone { points.named(followed, group[0]) } else { followed.to_owned() };
        let line = |name: String, pieces: Pieces| {
            Polyline::of_pieces(name, pieces).map(|line| line.with_color(color))
        };
        let hands = group.iter().map(|&number| points.parted(number, slice, |row| row.device));
        let hand: Pieces = hands.flat_map(|hand| hand.near).collect();
        isolines = isolines
            .with_polyline(line(name, near)?.with_dash(Dash::Solid))
            .with_polyline(line(of_each("hand", points), hand)?.with_dash(Dash::Dotted));
        let arrows = arrows(slice, points, &group, spacing);
        if !arrows.is_empty() && full_length > 0.0 {
            let arrows = Arrows::new(of_each("force", points), "N", arrows)?;
            let arrows = arrows.with_color(color).with_full_length(full_length);
            isolines = isolines.with_arrows(arrows);
        }
    }
    Ok(isolines)
}

/// What the points have in common, each in its colour: one entry in the legend for all.
fn of_each(what: &str, points: &Points<'_>) -> String {
    if points.groups().len() > 1 { format!("{what} of each") } else { what.to_owned() }
}

/// The parts in the slice of forces near it on a group of points, at places `spacing` apart [m].
fn arrows(slice: &FeltSlice, points: &Points<'_>, group: &[usize], spacing: f64) -> Vec<Arrow> {
    let is_seen =
        |row: &TraceRow| row.contact && side(&slice.plane, slice.near, row.proxy) == Side::Near;
    let mut arrows: Vec<Arrow> = Vec::new();
    let rows = group.iter().map(|&number| points.rows(number));
    let touches = rows.flat_map(|rows| rows.chunk_by(|a, b| is_seen(a) == is_seen(b)));
    for touch in touches.filter(|touch| touch.iter().all(|row| is_seen(row))) {
        let tails: Vec<_> = touch.iter().map(|row| slice.plane.project(row.proxy.0)).collect();
        for i in evenly(&tails, spacing) {
            let vector = slice.plane.project_vector(touch[i].force.0);
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
