// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The lines of cells: what joins the zeros of their edges.

use super::edges::{Corner, Zeros};
use crate::geometry::{Point, distance};

/// Lines between numbered places.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// Where lines begin and end [m].
    pub(super) places: Vec<Point>,
    pub(super) segments: Vec<[usize; 2]>,
    /// Cells without a zero on their edges.
    pub(super) without: Vec<Corner>,
}

/// Joins the changes of sign on the edges of each cell. Where all four edges have one, the pairs
/// that are shorter in sum.
pub(super) fn join_walls(cells: &[Corner], zeros: &Zeros) -> Lines {
    let mut lines = Lines { places: zeros.places.clone(), ..Lines::default() };
    let length = |[a, b]: [usize; 2]| distance(zeros.places[a], zeros.places[b]);
    for &at in cells {
        match zeros.of_cell(at)[..] {
            [] => lines.without.push(at),
            [a, b] => lines.segments.push([a, b]),
            [below, right, above, left] => {
                let one = [[below, right], [above, left]];
                let other = [[below, left], [right, above]];
                let sum = |pairs: [[usize; 2]; 2]| pairs.map(length).iter().sum::<f64>();
                lines.segments.extend(if sum(one) <= sum(other) { one } else { other });
            }
            // The sign changes an even number of times around a cell.
            _ => {}
        }
    }
    lines
}

/// Joins the zeros without a change of sign on the edges of each cell: two by a line, more of them
/// in their middle. One alone is the end of a line.
pub(super) fn join_thin(cells: &[Corner], zeros: &Zeros) -> Lines {
    let mut lines = Lines { places: zeros.places.clone(), ..Lines::default() };
    for &at in cells {
        match zeros.of_cell(at)[..] {
            [] => lines.without.push(at),
            [only] => lines.segments.push([only, only]),
            [a, b] => lines.segments.push([a, b]),
            ref several => {
                let middle = lines.places.len();
                lines.places.push(mean(zeros, several));
                lines.segments.extend(several.iter().map(|&number| [number, middle]));
            }
        }
    }
    lines
}

impl Lines {
    /// Joins those of `zeros`, without a change of sign, that lie on edges of cells with walls to
    /// the walls in these cells.
    pub(super) fn end_at_walls(&mut self, cells: &[Corner], zeros: &Zeros, walls: &Zeros) {
        for &at in cells {
            let ends = zeros.of_cell(at);
            let around = if ends.is_empty() { Vec::new() } else { walls.of_cell(at) };
            if !around.is_empty() {
                let middle = self.places.len();
                self.places.push(mean(walls, &around));
                self.segments.extend(ends.into_iter().map(|number| [number, middle]));
            }
        }
    }

    /// The segments joined into long lines [m].
    pub(super) fn joined(&self) -> impl Iterator<Item = Vec<Point>> {
        let chains = crate::chain::chains(&self.segments).into_iter();
        chains.map(|chain| chain.into_iter().map(|node| self.places[node]).collect())
    }
}

/// The mean of some zeros [m].
fn mean(zeros: &Zeros, numbers: &[usize]) -> Point {
    let sum = |k: usize| numbers.iter().map(|&number| zeros.places[number][k]).sum::<f64>();
    [sum(0), sum(1)].map(|sum| sum / numbers.len() as f64)
}
