// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What keeps a grid from being made.

use palpate_field::ShapeError;

/// Why no grid could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// A number breaks its rule.
    #[error(transparent)]
    Number(#[from] ShapeError),
    /// The shape has no bounds.
    #[error(
        "the shape has no bounds: a grid holds what fits into a box; intersect it with a box first"
    )]
    Unbounded,
    /// No node lies inside, so the shape is thinner than a cell everywhere.
    #[error(
        "no node lies inside: the shape is thinner than a cell of {cell} m; choose smaller cells"
    )]
    NoInside {
        /// The size of a cell [m].
        cell: f64,
    },
    /// Values are off those of the shape by an amount that is not known.
    #[error(
        "with cells of {cell} m it is not known how far values are off those of the shape; choose smaller cells"
    )]
    Unknown {
        /// The size of a cell [m].
        cell: f64,
    },
    /// The surface comes too near to the border of the lattice.
    #[error(
        "the shape reaches the border of the grid, at the node {node:?} [m]; leave at least two cells of {cell} m around it"
    )]
    AtBorder {
        /// The size of a cell [m].
        cell: f64,
        /// A node at the border which is not outside [m].
        node: Vec<f64>,
    },
    /// More nodes than allowed.
    #[error(
        "cells of {cell} m take {nodes} nodes, more than the {limit} allowed; choose larger cells, or allow more (`palpate grid --nodes`; a scene takes its file)"
    )]
    TooLarge {
        /// The size of a cell [m].
        cell: f64,
        /// How many nodes the lattice has.
        nodes: f64,
        /// How many are allowed.
        limit: usize,
    },
    /// The tolerance is not reached with the nodes allowed.
    #[error(
        "a deviation of {tolerance} m takes more than the {limit} nodes allowed: cells of {cell} m deviate by {reached} m; take a larger tolerance, or allow more (`palpate grid --nodes`; a scene takes its file)"
    )]
    TooFine {
        /// The deviation asked for [m].
        tolerance: f64,
        /// How many nodes are allowed.
        limit: usize,
        /// The smallest cells tried [m].
        cell: f64,
        /// The deviation certified with them [m].
        reached: f64,
    },
    /// The tolerance is not reached by smaller cells.
    #[error(
        "a deviation of {tolerance} m is not reached: cells of {cell} m deviate by {reached} m; take a larger tolerance, or store f32"
    )]
    NotReached {
        /// The deviation asked for [m].
        tolerance: f64,
        /// The smallest cells tried [m].
        cell: f64,
        /// The deviation certified with them [m].
        reached: f64,
    },
    /// The shape has grown out of the lattice.
    #[error("the shape reaches beyond the lattice of the grid: bake a new grid")]
    Outgrown,
    /// A value of the shape is no number.
    #[error("the shape's distance is no number in single precision at {point:?} [m]")]
    NotFinite {
        /// Where [m].
        point: Vec<f64>,
    },
    /// A grid without a band cannot be made again in part.
    #[error("a grid without a band can only be baked as a whole")]
    NoBand,
    /// The caller stopped the work.
    #[error("stopped before the grid was complete")]
    Stopped,
    /// The lattice has too few nodes for the kernel.
    #[error("there must be at least {least} nodes along each axis, got {counts:?}")]
    TooFew {
        /// How many nodes there are along each axis.
        counts: Vec<usize>,
        /// How many are needed.
        least: usize,
    },
    /// As many samples as the lattice has nodes are needed.
    #[error("{} nodes need as many samples, got {samples}", times(counts))]
    Samples {
        /// How many nodes the lattice has along each axis.
        counts: Vec<usize>,
        /// How many samples were given.
        samples: usize,
    },
}

/// Counts as a product.
fn times(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ")
}
