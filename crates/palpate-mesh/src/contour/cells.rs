// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The lattice of cells, and those that the surface passes.

use std::collections::HashSet;
use std::ops::ControlFlow;

use palpate_field::{Aabb, BLOCK, Block, Column, Point, Shape, Vector};

use super::{ContourError, ContourOptions, lost};

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
    /// The most cells that are looked at.
    most: usize,
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
        let cell = options.cell;
        let size = region.max - region.min;
        let counts = size.0.map(|side| ((side / cell).ceil() as usize).saturating_add(1));
        if counts.iter().any(|count| u32::try_from(*count).is_err()) {
            return Err(ContourError::TooMany { cell, limit: options.most_cells });
        }
        let origin = match options.node {
            None => region.min - Vector(OFFSET) * cell,
            Some(node) => {
                let before = (region.min - node).0.map(|along| (along / cell).floor());
                node + Vector(before) * cell
            }
        };
        Ok(Self { origin, cell, counts, most: options.most_cells })
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

    /// The cells with corners on both sides of the surface, and a point of a part that has none, if such parts are
    /// looked for.
    pub(super) fn signed(
        &self,
        shape: &Shape<3>,
        looks_between: bool,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(Vec<Signed>, Option<Point<3>>), ContourError> {
        let blocks = self.counts.map(|count| count.div_ceil(SIDE));
        let all = blocks.into_iter().map(|count| count as f64).product();
        let side = blocks.into_iter().fold(1, usize::max).next_power_of_two();
        let between = looks_between.then(Vec::new);
        let found = Found { signed: Vec::new(), between };
        let mut octree =
            Octree { cells: self, shape, progress, blocks, all, passed: 0.0, leaves: 0, found };
        octree.descend([0; 3], side)?;
        let lost = octree.found.lost();
        Ok((octree.found.signed, lost))
    }

    fn in_block(
        &self,
        shape: &Shape<3>,
        first: [usize; 3],
        found: &mut Found,
    ) -> Result<(), ContourError> {
        let at = |number: usize| {
            let own = [number % NODES, number / NODES % NODES, number / (NODES * NODES)];
            self.node(std::array::from_fn(|i| first[i] + own[i]))
        };
        let mut inside = [false; NODES * NODES * NODES];
        let mut sizes = [0.0; NODES * NODES * NODES];
        let (mut points, mut values) =
            (Block::<f64, 3, BLOCK>::zero(), Column::<f64, BLOCK>::zero());
        let runs = inside.chunks_mut(BLOCK).zip(sizes.chunks_mut(BLOCK));
        for (run, (inside, sizes)) in runs.enumerate() {
            points.fill(inside.len(), |i| at(run * BLOCK + i));
            shape.block_distances(&points, inside.len(), &mut values);
            for (i, (inside, size)) in inside.iter_mut().zip(sizes).enumerate() {
                let value = values.get(i);
                if !value.is_finite() {
                    return Err(ContourError::NotFinite { point: at(run * BLOCK + i).0 });
                }
                (*inside, *size) = (value < 0.0, value.abs());
            }
        }
        // A point of a cell is at most half of its diagonal from the nearest corner.
        let reach = 0.5 * 3.0_f64.sqrt() * self.cell * shape.promise().lipschitz;
        for number in 0..SIDE * SIDE * SIDE {
            let own = [number % SIDE, number / SIDE % SIDE, number / (SIDE * SIDE)];
            let cell: [usize; 3] = std::array::from_fn(|i| first[i] + own[i]);
            if (0..3).any(|i| cell[i] >= self.counts[i]) {
                continue;
            }
            let (mut corners, mut nearest) = (0, f64::INFINITY);
            for corner in 0..8 {
                let node = place(std::array::from_fn(|i| own[i] + ((corner >> i) & 1)));
                corners |= u8::from(inside[node]) << corner;
                nearest = nearest.min(sizes[node]);
            }
            let cell = cell.map(|i| i as u32);
            if corners != 0 && corners != u8::MAX {
                found.signed.push(Signed { cell, inside: corners });
            } else if let Some(between) = &mut found.between
                && nearest <= reach
                && is_alone(&inside, own)
            {
                let beyond = lost::beyond(shape, &self.around(cell), corners != 0);
                between.extend(beyond.map(|point| (cell, point)));
            }
        }
        Ok(())
    }
}

/// The place of a node in a block.
fn place(node: [usize; 3]) -> usize {
    node[0] + NODES * (node[1] + NODES * node[2])
}

/// Whether a cell and those around it, as far as they are of the block, have all corners on one side.
fn is_alone(inside: &[bool; NODES * NODES * NODES], cell: [usize; 3]) -> bool {
    let along = |i: usize| cell[i].saturating_sub(1)..(cell[i] + 3).min(NODES);
    along(2).all(|z| {
        along(1).all(|y| along(0).all(|x| inside[place([x, y, z])] == inside[place(cell)]))
    })
}

/// What was found in all blocks.
struct Found {
    signed: Vec<Signed>,
    /// Cells without a crossing, and points in them beyond the surface, if they are looked for.
    between: Option<Vec<([u32; 3], Point<3>)>>,
}

impl Found {
    /// A point in a cell that no cell with a crossing is beside.
    fn lost(&self) -> Option<Point<3>> {
        let between = self.between.as_ref().filter(|between| !between.is_empty())?;
        let signed: HashSet<_> = self.signed.iter().map(|signed| signed.cell).collect();
        let is_alone = |cell: &[u32; 3]| {
            (0..27).all(|code| {
                let step = [code % 3, code / 3 % 3, code / 9];
                let beside = std::array::from_fn(|i| (cell[i] + step[i]).wrapping_sub(1));
                !signed.contains(&beside)
            })
        };
        between.iter().find(|(cell, _)| is_alone(cell)).map(|(_, point)| *point)
    }
}

/// Looks for the surface in blocks of blocks, those that it may pass alone.
struct Octree<'a> {
    cells: &'a Cells,
    shape: &'a Shape<3>,
    progress: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
    /// Blocks of cells along each axis, and in all.
    blocks: [usize; 3],
    all: f64,
    /// Blocks that were looked at or passed over.
    passed: f64,
    /// Blocks whose cells were looked at.
    leaves: usize,
    found: Found,
}

impl Octree<'_> {
    /// Looks at the blocks from `first` on, so many along each axis.
    fn descend(&mut self, first: [usize; 3], side: usize) -> Result<(), ContourError> {
        let end: [usize; 3] = std::array::from_fn(|i| self.blocks[i].min(first[i] + side));
        if (0..3).any(|i| first[i] >= end[i]) {
            return Ok(());
        }
        if !self.is_near(first, end) {
            self.passed += (0..3).map(|i| (end[i] - first[i]) as f64).product::<f64>();
            return Ok(());
        }
        if side > 1 {
            let half = side / 2;
            return (0..8).try_for_each(|child| {
                self.descend(
                    std::array::from_fn(|i| first[i] + half * ((child >> i) & 1)),
                    half,
                )
            });
        }
        let Cells { cell, most: limit, .. } = *self.cells;
        if (self.leaves + 1) * SIDE * SIDE * SIDE > limit {
            return Err(ContourError::TooMany { cell, limit });
        }
        if self.leaves.is_multiple_of(64) && (self.progress)(self.passed / self.all).is_break()
        {
            return Err(ContourError::Stopped);
        }
        self.leaves += 1;
        self.passed += 1.0;
        self.cells.in_block(self.shape, first.map(|i| i * SIDE), &mut self.found)
    }

    /// Whether the surface may pass the blocks from `first` to before `end`.
    fn is_near(&self, first: [usize; 3], end: [usize; 3]) -> bool {
        let [min, max] = [first, end].map(|block| self.cells.node(block.map(|i| i * SIDE)));
        let safe = self.shape.safe_radius((min + max) * 0.5);
        safe.is_nan() || safe <= 0.5 * (max - min).norm() * (1.0 + 1e-9)
    }
}
