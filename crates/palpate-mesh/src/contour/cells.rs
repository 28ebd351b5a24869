// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The lattice of cells, and those that the surface passes.

use std::ops::ControlFlow;

use palpate_field::{Aabb, BLOCK, Block, Column, Point, Shape, Vector};

use super::{ContourError, ContourOptions};

/// Cells of a block along an axis: a block far from the surface is passed over.
const SIDE: usize = 8;

/// Nodes of a block along an axis.
const NODES: usize = SIDE + 1;

/// The lattice is shifted by this share of a cell, because faces of shapes often lie at round numbers.
const OFFSET: [f64; 3] = [0.3819, 0.4271, 0.3533];

/// Nodes at `origin + cell·i`, and cells between them.
pub(super) struct Cells {
    origin: Point<3>,
    cell: f64,
    counts: [usize; 3],
}

/// A cell that the surface passes: corner `i` is inside if bit `i` is set, and lies at bit `k` of `i` along axis k.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signed {
    pub(super) cell: [u32; 3],
    pub(super) inside: u8,
}

impl Signed {
    /// The axis of an edge of the cell, and the node where it begins.
    pub(super) fn edge(&self, edge: usize) -> [u32; 4] {
        let axis = edge / 4;
        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
        let mut node = self.cell;
        node[b] += (edge & 1) as u32;
        node[c] += ((edge >> 1) & 1) as u32;
        [axis as u32, node[0], node[1], node[2]]
    }
}

impl Cells {
    pub(super) fn over(
        region: &Aabb<3>,
        options: &ContourOptions,
    ) -> Result<Self, ContourError> {
        let (cell, limit) = (options.cell, options.most_cells);
        let size = region.max - region.min;
        let counts = size.0.map(|side| ((side / cell).ceil() as usize).saturating_add(1));
        let cells = counts.iter().map(|count| *count as f64).product::<f64>();
        let is_narrow = counts.iter().all(|count| u32::try_from(*count).is_ok());
        if cells > limit as f64 || !is_narrow {
            return Err(ContourError::TooMany { cell, cells, limit });
        }
        let origin = match options.node {
            None => region.min - Vector(OFFSET) * cell,
            Some(node) => {
                let before = (region.min - node).0.map(|along| (along / cell).floor());
                node + Vector(before) * cell
            }
        };
        Ok(Self { origin, cell, counts })
    }

    fn node(&self, index: [usize; 3]) -> Point<3> {
        self.origin + Vector(index.map(|i| i as f64)) * self.cell
    }

    /// The ends of an edge [m].
    pub(super) fn ends(&self, [axis, x, y, z]: [u32; 4]) -> [Point<3>; 2] {
        let mut index = [x, y, z].map(|i| i as usize);
        let begin = self.node(index);
        index[axis as usize] += 1;
        [begin, self.node(index)]
    }

    /// The box of a cell [m].
    pub(super) fn around(&self, cell: [u32; 3]) -> Aabb<3> {
        let index = cell.map(|i| i as usize);
        Aabb { min: self.node(index), max: self.node(index.map(|i| i + 1)) }
    }

    /// The cells with corners on both sides of the surface.
    pub(super) fn signed(
        &self,
        shape: &Shape<3>,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Vec<Signed>, ContourError> {
        let blocks = self.counts.map(|count| count.div_ceil(SIDE));
        let all = blocks.iter().product::<usize>();
        let mut found = Vec::new();
        for number in 0..all {
            let block = [
                number % blocks[0],
                number / blocks[0] % blocks[1],
                number / (blocks[0] * blocks[1]),
            ];
            let first = block.map(|i| i * SIDE);
            if number % 64 == 0 && progress(number as f64 / all as f64).is_break() {
                return Err(ContourError::Stopped);
            }
            if self.is_near(shape, first) {
                self.in_block(shape, first, &mut found)?;
            }
        }
        Ok(found)
    }

    /// Whether the surface may pass a block.
    fn is_near(&self, shape: &Shape<3>, first: [usize; 3]) -> bool {
        let half = 0.5 * SIDE as f64 * self.cell;
        let middle = self.node(first) + Vector([half; 3]);
        let radius = half * 3.0_f64.sqrt() * (1.0 + 1e-9);
        let safe = shape.safe_radius(middle);
        safe.is_nan() || safe <= radius
    }

    fn in_block(
        &self,
        shape: &Shape<3>,
        first: [usize; 3],
        found: &mut Vec<Signed>,
    ) -> Result<(), ContourError> {
        let at = |number: usize| {
            let own = [number % NODES, number / NODES % NODES, number / (NODES * NODES)];
            self.node(std::array::from_fn(|i| first[i] + own[i]))
        };
        let mut inside = [false; NODES * NODES * NODES];
        let (mut points, mut values) =
            (Block::<f64, 3, BLOCK>::zero(), Column::<f64, BLOCK>::zero());
        for (run, inside) in inside.chunks_mut(BLOCK).enumerate() {
            points.fill(inside.len(), |i| at(run * BLOCK + i));
            shape.block_distances(&points, inside.len(), &mut values);
            for (i, inside) in inside.iter_mut().enumerate() {
                let value = values.get(i);
                if !value.is_finite() {
                    return Err(ContourError::NotFinite { point: at(run * BLOCK + i).0 });
                }
                *inside = value < 0.0;
            }
        }
        for number in 0..SIDE * SIDE * SIDE {
            let own = [number % SIDE, number / SIDE % SIDE, number / (SIDE * SIDE)];
            let cell: [usize; 3] = std::array::from_fn(|i| first[i] + own[i]);
            if (0..3).any(|i| cell[i] >= self.counts[i]) {
                continue;
            }
            let mut corners = 0;
            for corner in 0..8 {
                let node: [usize; 3] = std::array::from_fn(|i| own[i] + ((corner >> i) & 1));
                let place = node[0] + NODES * (node[1] + NODES * node[2]);
                corners |= u8::from(inside[place]) << corner;
            }
            if corners != 0 && corners != u8::MAX {
                found.push(Signed { cell: cell.map(|i| i as u32), inside: corners });
            }
        }
        Ok(())
    }
}
