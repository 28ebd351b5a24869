// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Zeros within cells that have none on their edges.

use super::{Asked, BoundedField, Cell, Corner, Lattice, Spot, kept, may_hold_zero};
use crate::error::PlotError;
use crate::geometry::Point;
use crate::slope::SampledSlope;

/// How often a cell is split.
const SPLITS: u32 = 3;

/// The most parts of cells: more are left only where bounds are loose, and the whole cells are
/// searched there.
const MOST: usize = 50_000;

/// Newton's steps at most.
const STEPS: usize = 4;

/// A zero is found where the value is this small, over that at the middle of the cell.
const FOUND: f64 = 0.05;

/// The search for a zero in a cell.
struct Search {
    cell: Cell,
    place: Point,
    /// The value at the middle of the cell.
    first: Option<f64>,
}

/// The zeros in cells of `lattice` [m], at most one in each of their smallest parts.
pub(super) fn find(
    cells: &[Corner],
    lattice: &Lattice,
    field: &mut Asked<impl BoundedField>,
) -> Result<Vec<Point>, PlotError> {
    let mut open: Vec<_> =
        cells.iter().map(|&at| lattice.cell(Spot { at, level: 0 })).collect();
    for _ in 0..SPLITS {
        if 4 * open.len() > MOST {
            break;
        }
        let quarters: Vec<_> = open.iter().flat_map(quarters).collect();
        let is_open = field.radii_leave_open(&quarters);
        open = kept(quarters, is_open);
    }
    let is_open = field.bounds(&open).into_iter().map(may_hold_zero).collect();
    let begin = |cell: Cell| Search { cell, place: cell.centre, first: None };
    let mut searches: Vec<_> = kept(open, is_open).into_iter().map(begin).collect();
    let mut zeros = Vec::new();
    for _ in 0..STEPS {
        let places: Vec<_> = searches.iter().map(|search| search.place).collect();
        let slopes = field.slopes(&places)?;
        let mut going = Vec::new();
        for (mut search, slope) in searches.into_iter().zip(slopes) {
            let first = *search.first.get_or_insert(slope.value);
            let has_other_sign = (slope.value < 0.0) != (first < 0.0);
            if slope.value.abs() <= FOUND * first.abs() || has_other_sign {
                zeros.push(search.place);
            } else if search.step(&slope) {
                going.push(search);
            }
        }
        searches = going;
    }
    Ok(zeros)
}

impl Search {
    /// Steps to the zero of the tangent plane; `false` if it lies in another cell, where another
    /// search finds it.
    fn step(&mut self, slope: &SampledSlope) -> bool {
        let [x, y, _] = slope.gradient;
        let share = slope.value / (x * x + y * y);
        self.place = [self.place[0] - share * x, self.place[1] - share * y];
        // Written so that a gradient of zero ends the search.
        (0..2).all(|k| (self.place[k] - self.cell.centre[k]).abs() <= self.cell.half)
    }
}

fn quarters(cell: &Cell) -> [Cell; 4] {
    let half = 0.5 * cell.half;
    Cell { half, ..*cell }.corners().map(|centre| Cell { centre, half })
}
