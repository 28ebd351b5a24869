// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parts of an element that each have a minimum of their own.
//!
//! This is the persistence of minima (Edelsbrunner, Letscher and Zomorodian 2002) with bounds
//! in place of values, so that two minima that are told apart are proven to be apart.
//!
//! Water rises over the cells of an element. A cell floods at its lower bound, and joins the
//! flooded cells that it may touch. A path between two pools climbs at least to the lower
//! bound of the cell that joins them. If this bound exceeds the least value found in each
//! pool by more than the tolerance, the shallower pool is a patch; else the pools become one.
//! At the end the deepest pool of each connected part is a patch too.

use palpate_field::Point;

use crate::element_search::ElementCell;
use crate::sampler::unit;

/// The largest number of cells divided together: 32 along the edge of a triangle.
pub(crate) const MOST_CELLS: usize = 1024;

/// Room for the rounding of distances between centres of cells, relative to their radii.
const ROUNDINGS: f64 = 1e-9;

/// Memory of a division into patches.
#[derive(Debug)]
pub(crate) struct Patches<const N: usize, const D: usize> {
    pub(crate) cells: Vec<ElementCell<N, D>>,
    /// Of all cells [m].
    pub(crate) radius: f64,
    /// While cells are halved: the next `cells`.
    pub(crate) halves: Vec<ElementCell<N, D>>,
    /// The places of the cells along a direction, by which they are sorted.
    places: Vec<f64>,
    centres: Vec<Point<D>>,
    /// Cells in the order of flooding; at the end the deepest cell of each patch.
    order: Vec<u32>,
    /// What cells are sorted by.
    keys: Vec<f64>,
    is_wet: Vec<bool>,
    /// For each cell, another of the same pool, and another of the same patch (union-find):
    /// both chains end at the deepest.
    water: Vec<u32>,
    patch: Vec<u32>,
}

/// Puts the number of each key into `order`, as [`sort_by_keys`] sorts them.
fn sort_all(order: &mut Vec<u32>, keys: &[f64]) {
    order.clear();
    order.extend(0..keys.len() as u32);
    sort_by_keys(order, keys);
}

/// Sorts numbers by their keys; of equal keys the lower number is first. One function for all
/// elements: a sort is much machine code.
fn sort_by_keys(order: &mut [u32], keys: &[f64]) {
    order.sort_unstable_by(|&a, &b| {
        keys[a as usize].total_cmp(&keys[b as usize]).then(a.cmp(&b))
    });
}

impl<const N: usize, const D: usize> Patches<N, D> {
    pub(crate) fn new() -> Self {
        let room = MOST_CELLS;
        Self {
            cells: Vec::with_capacity(room),
            radius: 0.0,
            halves: Vec::with_capacity(room),
            places: Vec::with_capacity(room),
            centres: Vec::with_capacity(room),
            order: Vec::with_capacity(room),
            keys: Vec::with_capacity(room),
            is_wet: Vec::with_capacity(room),
            water: Vec::with_capacity(room),
            patch: Vec::with_capacity(room),
        }
    }

    /// Divides `cells`, all of one size, into patches, and returns their number. A cell
    /// floods at its `shore`: its lower bound where patches are to be proven apart.
    pub(crate) fn divide(
        &mut self,
        weights: &[f64; N],
        tolerance: f64,
        shore: impl Fn(&ElementCell<N, D>) -> f64,
    ) -> usize {
        self.sort_along_element(weights);
        let Self { cells, order, keys, .. } = self;
        keys.clear();
        keys.extend(cells.iter().map(&shore));
        sort_all(order, keys);
        self.is_wet.clear();
        self.is_wet.resize(self.cells.len(), false);
        for names in [&mut self.water, &mut self.patch] {
            names.clear();
            names.extend(0..self.cells.len() as u32);
        }
        for i in 0..self.order.len() {
            let cell = self.order[i];
            self.flood(cell, shore(&self.cells[cell as usize]) - tolerance);
        }
        let Self { cells, order, keys, patch, .. } = self;
        order.retain(|&i| patch[i as usize] == i);
        keys.clear();
        keys.extend(cells.iter().map(|cell| cell.upper));
        sort_by_keys(order, keys);
        order.len()
    }

    /// Sorts the cells along the longest edge: touching cells are near in this order.
    fn sort_along_element(&mut self, weights: &[f64; N]) {
        let Self { cells, halves, places, centres, order, keys, .. } = self;
        let Some(first) = cells.first() else { return };
        let edge = |i: usize| first.element.vertices[(i + 1) % N] - first.element.vertices[i];
        let longest =
            (1..N).fold(edge(0), |l, i| if edge(i).norm() > l.norm() { edge(i) } else { l });
        let direction = unit(longest);
        let place = |cell: &ElementCell<N, D>| cell.element.at(weights).dot(direction);
        keys.clear();
        keys.extend(cells.iter().map(place));
        sort_all(order, keys);
        halves.clear();
        halves.extend(order.iter().map(|&i| cells[i as usize]));
        std::mem::swap(cells, halves);
        places.clear();
        places.extend(cells.iter().map(place));
        centres.clear();
        centres.extend(cells.iter().map(|cell| cell.element.at(weights)));
    }

    /// Floods a cell, and joins the pools that it connects; the shallower of two becomes part
    /// of the other's patch if its floor is at `least` or above.
    fn flood(&mut self, cell: u32, least: f64) {
        let (centre, place) = (self.centres[cell as usize], self.places[cell as usize]);
        let touching = 2.0 * self.radius * (1.0 + ROUNDINGS);
        let start = self.places.partition_point(|&other| other < place - touching);
        let end = self.places.partition_point(|&other| other <= place + touching);
        self.is_wet[cell as usize] = true;
        for other in start..end {
            let apart = self.centres[other] - centre;
            if !self.is_wet[other] || apart.dot(apart) > touching * touching {
                continue;
            }
            let (a, b) = (root(&mut self.water, cell), root(&mut self.water, other as u32));
            if a == b {
                continue;
            }
            let floor = |i: u32| self.cells[i as usize].upper;
            let (deep, shallow) = if floor(a) <= floor(b) { (a, b) } else { (b, a) };
            // A single cell has its floor above its shore, and never becomes a patch here.
            if floor(shallow) >= least {
                self.patch[shallow as usize] = deep;
            }
            self.water[shallow as usize] = deep;
        }
    }

    /// Writes the cells of a patch into `cells`, and returns the one with the least value
    /// found. Patches are in the order of that value.
    pub(crate) fn copy(
        &mut self,
        patch: usize,
        cells: &mut Vec<ElementCell<N, D>>,
    ) -> ElementCell<N, D> {
        let deepest = self.order[patch];
        cells.clear();
        for (i, cell) in self.cells.iter().enumerate() {
            if root(&mut self.patch, i as u32) == deepest {
                cells.push(*cell);
            }
        }
        self.cells[deepest as usize]
    }
}

/// The end of a chain of names; shortens the chain.
fn root(names: &mut [u32], mut name: u32) -> u32 {
    while names[name as usize] != name {
        let next = names[names[name as usize] as usize];
        names[name as usize] = next;
        name = next;
    }
    name
}
