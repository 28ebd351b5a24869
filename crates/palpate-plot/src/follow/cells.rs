// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The finest cells that may hold the surface.

use super::edges::Corner;
use super::lattice::{Lattice, Spot};
use super::{Asked, BoundedField, Cell};

/// The most open cells: twice those of a raster, a few megabytes of slopes.
const MOST: usize = 300_000;

/// A cell whose values are all below this share of its half edge is surface as a whole. Values
/// in a sheet are a few roundings.
const FLAT: f64 = 1e-6;

/// Splits all cells that may hold a zero, until they are the finest or too many.
pub(super) fn open(lattice: &Lattice, field: &mut Asked<impl BoundedField>) -> Cells {
    let mut sieve = Sieve { lattice, field, solid: Vec::new() };
    let mut level = lattice.levels;
    let mut open = sieve.pass(lattice.roots());
    while level > 0 && 4 * open.len() <= MOST {
        level -= 1;
        let quarters = open.into_iter().flat_map(|spot| lattice.quarters(spot)).collect();
        open = sieve.pass(quarters);
    }
    let solid = sieve.solid;
    let open = open.iter().map(|spot| spot.at.map(|coordinate| coordinate >> level)).collect();
    Cells { lattice: lattice.coarser(level), open, solid }
}

/// The cells that are left.
#[derive(Debug)]
pub(super) struct Cells {
    /// Of which the open cells are the finest.
    pub(super) lattice: Lattice,
    /// Lower left corners of the open cells, neighbours mostly near each other.
    pub(super) open: Vec<Corner>,
    /// Cells of any size that are surface as a whole.
    pub(super) solid: Vec<Cell>,
}

impl Cells {
    /// Those of the open cells `at` that are open by their bounds too; others become solid if
    /// they are all zero.
    pub(super) fn bounded(
        &mut self,
        at: Vec<Corner>,
        field: &mut Asked<impl BoundedField>,
    ) -> Vec<Corner> {
        let spots = at.into_iter().map(|at| Spot { at, level: 0 }).collect();
        let mut sieve = Sieve { lattice: &self.lattice, field, solid: Vec::new() };
        let open = sieve.bounded(spots);
        let solid = sieve.solid;
        self.solid.extend(solid);
        open.into_iter().map(|spot| spot.at).collect()
    }
}

/// Rules out cells.
struct Sieve<'a, F> {
    lattice: &'a Lattice,
    field: &'a mut Asked<F>,
    solid: Vec<Cell>,
}

impl<F: BoundedField> Sieve<'_, F> {
    /// The cells that may hold a zero; those that are all zero become solid. Bounds cost several
    /// times a value, so they are asked for only where the radii rule out little.
    fn pass(&mut self, spots: Vec<Spot>) -> Vec<Spot> {
        let cells: Vec<_> = spots.iter().map(|spot| self.lattice.cell(*spot)).collect();
        let count = spots.len();
        let is_open = self.field.radii_leave_open(&cells);
        let open: Vec<_> = kept(spots, is_open);
        if 4 * open.len() < 3 * count { open } else { self.bounded(open) }
    }

    /// As [`pass`](Self::pass), by bounds.
    fn bounded(&mut self, spots: Vec<Spot>) -> Vec<Spot> {
        let cells: Vec<_> = spots.iter().map(|spot| self.lattice.cell(*spot)).collect();
        let bounds = self.field.bounds(&cells);
        let is_open = cells.iter().zip(bounds).map(|(cell, bounds)| {
            if is_flat(cell, bounds) {
                self.solid.push(*cell);
            }
            may_hold_zero(bounds) && !is_flat(cell, bounds)
        });
        kept(spots, is_open.collect())
    }
}

/// Those of `items` that `are_kept`.
pub(super) fn kept<T>(items: Vec<T>, are_kept: Vec<bool>) -> Vec<T> {
    items.into_iter().zip(are_kept).filter(|item| item.1).map(|item| item.0).collect()
}

fn is_flat(cell: &Cell, bounds: [f64; 2]) -> bool {
    bounds.iter().all(|bound| bound.abs() < FLAT * cell.half)
}

/// Whether a cell with these bounds may hold a zero. Written so that bounds that are NaN rule
/// nothing out.
pub(super) fn may_hold_zero([low, high]: [f64; 2]) -> bool {
    !(low > 0.0 || high < 0.0)
}
