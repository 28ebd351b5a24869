// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Corners and edges of cells, and the zeros on edges.

use super::lattice::Lattice;
use crate::geometry::Point;

/// Edges along a tile.
const TILE: usize = 16;

/// The corner of a cell, as the number of cells to its left and below it.
pub(super) type Corner = [usize; 2];

/// The edge from a corner to the next one along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) at: Corner,
    pub(super) axis: usize,
}

impl Edge {
    /// Its ends.
    pub(super) fn ends(self) -> [Corner; 2] {
        let mut end = self.at;
        end[self.axis] += 1;
        [self.at, end]
    }

    /// The point at a share of the way from its first end to the other [m].
    pub(super) fn point(self, lattice: &Lattice, share: f64) -> Point {
        let mut p = lattice.corner(self.at);
        p[self.axis] += share * lattice.edge;
        p
    }

    fn key(self) -> ([usize; 4], usize) {
        (order(self.at), self.axis)
    }
}

/// The corners of the cell at its lower left one, counter-clockwise.
fn corners_of([i, j]: Corner) -> [Corner; 4] {
    [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]
}

/// The edges of a cell: below, right, above, left.
pub(super) fn edges_of([i, j]: Corner) -> [Edge; 4] {
    [([i, j], 0), ([i + 1, j], 1), ([i, j + 1], 0), ([i, j], 1)]
        .map(|(at, axis)| Edge { at, axis })
}

/// Orders corners by tiles, and row by row in a tile. Corners that are asked about together then
/// lie near each other, and fields of many parts answer such questions faster.
fn order([across, up]: Corner) -> [usize; 4] {
    [up / TILE, across / TILE, up, across]
}

/// Something known of the corners of some cells.
#[derive(Debug)]
pub(super) struct Corners<T> {
    corners: Vec<Corner>,
    known: Vec<T>,
}

impl<T: Copy> Corners<T> {
    /// Asks for what is to be known of the corners of `cells`, by their places [m].
    pub(super) fn of<E>(
        cells: &[Corner],
        lattice: &Lattice,
        ask: impl FnOnce(&[Point]) -> Result<Vec<T>, E>,
    ) -> Result<Self, E> {
        let mut corners: Vec<_> = cells.iter().flat_map(|&at| corners_of(at)).collect();
        corners.sort_unstable_by_key(|&at| order(at));
        corners.dedup();
        let places: Vec<_> = corners.iter().map(|&at| lattice.corner(at)).collect();
        Ok(Self { known: ask(&places)?, corners })
    }

    /// What is known of a corner of one of the cells.
    pub(super) fn get(&self, at: Corner) -> Option<T> {
        let index = self.corners.binary_search_by_key(&order(at), |&at| order(at)).ok()?;
        self.known.get(index).copied()
    }
}

/// The edges of `cells`, each once, in order.
pub(super) fn sorted_edges(cells: &[Corner]) -> Vec<Edge> {
    let mut edges: Vec<_> = cells.iter().flat_map(|&at| edges_of(at)).collect();
    edges.sort_unstable_by_key(|edge| edge.key());
    edges.dedup();
    edges
}

/// Zeros on edges, in the order of [`sorted_edges`].
#[derive(Debug, Default)]
pub(super) struct Zeros {
    pub(super) edges: Vec<Edge>,
    /// A zero on each edge [m].
    pub(super) places: Vec<Point>,
}

impl Zeros {
    /// The numbers of the zeros on the edges of a cell: below, right, above, left.
    pub(super) fn of_cell(&self, at: Corner) -> Vec<usize> {
        edges_of(at).into_iter().filter_map(|edge| self.find(edge)).collect()
    }

    /// Those of `cells` with zeros that share an edge without one, which a line of single cells
    /// has not.
    pub(super) fn pairs(&self, cells: &[Corner]) -> Vec<Corner> {
        let has_zero =
            |at: Corner| edges_of(at).into_iter().any(|edge| self.find(edge).is_some());
        let mut pairs = Vec::new();
        for &[i, j] in cells.iter().filter(|at| has_zero(**at)) {
            let [_, right, above, _] = edges_of([i, j]);
            for (edge, next) in [(right, [i + 1, j]), (above, [i, j + 1])] {
                if self.find(edge).is_none() && has_zero(next) {
                    pairs.extend([[i, j], next]);
                }
            }
        }
        pairs
    }

    fn find(&self, edge: Edge) -> Option<usize> {
        self.edges.binary_search_by_key(&edge.key(), |edge| edge.key()).ok()
    }
}
