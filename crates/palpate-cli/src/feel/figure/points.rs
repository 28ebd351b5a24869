// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The contact points of a run, as its picture shows them.

use palpate::field::Point;
use palpate::plot::Color;
use palpate::servo_loop::TraceRow;

use super::super::paths::{Seen, taken_apart};
use crate::feel::slices::FeltSlice;

/// The most points of a line: more than a picture has columns.
const MOST_POINTS: usize = 2000;

/// Up to so many contact points have colours of their own. More are drawn alike.
const MOST_COLOURS: usize = 10;

/// Of how many places in a row a line shows one, so that `count` places become few enough points.
pub(super) fn every(count: usize) -> usize {
    count.div_ceil(MOST_POINTS).max(1)
}

/// The rows of each contact point.
pub(super) struct Points<'a> {
    points: Vec<Vec<&'a TraceRow>>,
}

impl<'a> Points<'a> {
    pub(super) fn of(rows: &'a [TraceRow]) -> Self {
        let count = rows.iter().map(|row| row.point).max().map_or(0, |last| last + 1);
        let of_point = |point| rows.iter().filter(|row| row.point == point).collect();
        Self { points: (0..count).map(of_point).collect() }
    }

    pub(super) fn count(&self) -> usize {
        self.points.len()
    }

    /// The numbers of the points that are drawn alike, together.
    pub(super) fn groups(&self) -> Vec<Vec<usize>> {
        let all = 0..self.count();
        if self.count() > MOST_COLOURS {
            vec![all.collect()]
        } else {
            all.map(|number| vec![number]).collect()
        }
    }

    /// The colour of a point; the first one's if there are too many.
    pub(super) fn color(&self, number: usize) -> Color {
        Color::numbered(if self.count() > MOST_COLOURS { 0 } else { number })
    }

    /// `what` of a point, with its number if there are several.
    pub(super) fn named(&self, what: &str, number: usize) -> String {
        if self.count() > 1 { format!("{what} {number}") } else { what.to_owned() }
    }

    /// All rows of a point.
    pub(super) fn rows(&self, number: usize) -> &[&'a TraceRow] {
        &self.points[number]
    }

    /// The line of a point, cut into pieces near, in front of and behind the slice.
    pub(super) fn parted(
        &self,
        number: usize,
        slice: &FeltSlice,
        place: fn(&TraceRow) -> Point<3>,
    ) -> Seen {
        let rows = self.rows(number);
        let every = every(rows.len());
        let line: Vec<_> = rows.iter().step_by(every).map(|row| place(row)).collect();
        taken_apart(&slice.plane, slice.near, line)
    }

    /// The force on a point over time: the largest until the next place [N].
    pub(super) fn force(&self, number: usize) -> Vec<[f64; 2]> {
        let rows = self.rows(number);
        let every = every(rows.len());
        let largest = |rows: &[&TraceRow]| {
            [rows[0].time_s, rows.iter().map(|row| row.force.norm()).fold(0.0, f64::max)]
        };
        rows.chunks(every).map(largest).collect()
    }

    /// The largest force on any point over time [N].
    pub(super) fn largest_force(&self) -> Vec<[f64; 2]> {
        let all = (0..self.count()).map(|number| self.force(number));
        let larger = |mut largest: Vec<[f64; 2]>, force: Vec<[f64; 2]>| {
            largest
                .iter_mut()
                .zip(force)
                .for_each(|(one, other)| one[1] = one[1].max(other[1]));
            largest
        };
        all.reduce(larger).unwrap_or_default()
    }
}
