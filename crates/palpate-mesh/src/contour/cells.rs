// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cells of a contour: edges that cross the surface, patches, faces.
//!
//! Which crossings of a cell belong to one sheet of the surface.
//!
//! On each face of a cell the crossings are joined in pairs; pairs on all faces join them to loops, the patches. Four
//! crossings on a face can be joined in two ways. At first the corners inside are kept apart; where both cells of the
//! face would then join all four in one patch, an edge of the mesh would have four faces, and the corners outside are
//! kept apart instead (Wenger 2013).

use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;

use palpate_field::{Aabb, BLOCK, Block, Column, Point, Shape, Vector};

use super::{ContourError, ContourOptions, FLAT, deviation};
use crate::report::is_flat;

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
                let beyond = deviation::beyond(shape, &self.around(cell), corners != 0);
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

/// Steps towards a crossing at most: halvings alone would reach rounding.
const MOST_STEPS: usize = 60;

/// A crossing is found to this share of its edge.
const PRECISE: f64 = 1e-12;

/// A place where an edge crosses the surface, and the direction out of the shape there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) place: Point<3>,
    pub(super) normal: Vector<f64, 3>,
}

impl Crossing {
    /// Between two points on different sides of the surface, by false position with halved weights (Illinois).
    pub(super) fn on(shape: &Shape<3>, ends: [Point<3>; 2]) -> Result<Self, ContourError> {
        let at = |share: f64| ends[0] + (ends[1] - ends[0]) * share;
        let ([mut low, mut high], [mut f, mut g]) =
            ([0.0, 1.0], ends.map(|end| shape.distance(end)));
        let mut place = 0.5;
        for _ in 0..MOST_STEPS {
            place = (low * g - high * f) / (g - f);
            // Flat fields, and such that end in rounding, are halved.
            if !(place > low && place < high) {
                place = 0.5 * (low + high);
            }
            let value = shape.distance(at(place));
            if value == 0.0 || high - low < PRECISE {
                break;
            }
            if (value < 0.0) == (g < 0.0) {
                (high, g) = (place, value);
                f *= 0.5;
            } else {
                (low, f) = (place, value);
                g *= 0.5;
            }
        }
        let place = at(place);
        let (_, gradient) = shape.distance_gradient(place);
        let along = (ends[1] - ends[0]) * if f < 0.0 { 1.0 } else { -1.0 };
        // Where the gradient vanishes, the edge tells the direction.
        let normal = gradient.normalized().or_else(|| along.normalized());
        if !place.is_finite() {
            return Err(ContourError::NotFinite { point: place.0 });
        }
        Ok(Self { place, normal: normal.unwrap_or(Vector([1.0, 0.0, 0.0])) })
    }
}

/// The four cells around an edge, by the sides of the edge in them along the two axes after its own:
/// counter-clockwise, seen from the edge's end.
const AROUND: [[usize; 2]; 4] = [[1, 1], [0, 1], [0, 0], [1, 0]];

/// The vertices around each crossing, counter-clockwise seen from outside; `of_edges` has the vertex of each edge
/// of each cell.
pub(super) fn quads(signed: &[Signed], of_edges: &[[u32; EDGES]]) -> Vec<[u32; 4]> {
    let mut found: Vec<[u32; 4]> = Vec::new();
    let mut places: HashMap<[u32; 4], usize> = HashMap::new();
    for (cell, of_edge) in signed.iter().zip(of_edges) {
        for edge in (0..EDGES).filter(|edge| is_crossed(cell.inside, *edge)) {
            let place = *places.entry(cell.edge(edge)).or_insert_with(|| {
                found.push([u32::MAX; 4]);
                found.len() - 1
            });
            let sides = [edge & 1, (edge >> 1) & 1];
            let Some(around) = AROUND.iter().position(|around| *around == sides) else {
                continue;
            };
            // From inside to outside along the edge, or the other way.
            let is_out = (cell.inside >> ends(edge)[0]) & 1 == 1;
            found[place][if is_out { around } else { 3 - around }] = of_edge[edge];
        }
    }
    // The lattice reaches beyond the shape, so all four cells are there.
    found.retain(|quad| !quad.contains(&u32::MAX));
    found
}

/// Two triangles for each four vertices, cut where the cut lies nearer to the surface.
pub(super) fn triangles(
    shape: &Shape<3>,
    places: &[Point<3>],
    quads: &[[u32; 4]],
) -> Vec<[u32; 3]> {
    let place = |vertex: u32| places[vertex as usize];
    let off = |a: u32, b: u32| shape.distance((place(a) + place(b)) * 0.5).abs();
    // Three vertices along a sharp edge make no triangle.
    let are_flat =
        |halves: &[[u32; 3]; 2]| halves.iter().any(|half| is_flat(&half.map(place), FLAT));
    let cut = |&[a, b, c, d]: &[u32; 4]| {
        let ways = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
        match [are_flat(&ways[0]), are_flat(&ways[1])] {
            [true, false] => ways[1],
            [false, true] => ways[0],
            _ => ways[usize::from(off(a, c) > off(b, d))],
        }
    };
    quads.iter().flat_map(cut).collect()
}

/// The edges of a cell: 4 along each axis.
pub(super) const EDGES: usize = 12;

/// The patch of an edge without a crossing.
pub(super) const NONE: u8 = u8::MAX;

/// The patches of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patches {
    /// The patch of each edge.
    pub(super) of_edge: [u8; EDGES],
    pub(super) count: u8,
}

/// A face of a cell: its axis, and whether it is the upper one.
type Face = (usize, usize);

/// The faces of a cell.
const FACES: [Face; 6] = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)];

impl Patches {
    /// The patches of all cells, the same on both sides of every face.
    pub(super) fn of(signed: &[Signed]) -> Vec<Self> {
        let numbers: HashMap<[u32; 3], usize> =
            signed.iter().enumerate().map(|(number, signed)| (signed.cell, number)).collect();
        let mut turned = HashSet::new();
        let mut patches: Vec<_> =
            signed.iter().map(|signed| Self::of_cell(signed, &turned)).collect();
        // A face that is turned may join patches at others. Each is turned once at most.
        loop {
            let before = turned.len();
            for (number, cell) in signed.iter().enumerate() {
                for axis in 0..3 {
                    // Each face once: the upper one of its lower cell.
                    let face = (axis, 1);
                    if !is_ambiguous(cell.inside, face) || !patches[number].joins(face) {
                        continue;
                    }
                    let mut beyond = cell.cell;
                    beyond[axis] += 1;
                    let Some(&other) = numbers.get(&beyond) else { continue };
                    if patches[other].joins((axis, 0)) && turned.insert(name(cell.cell, face)) {
                        patches[number] = Self::of_cell(cell, &turned);
                        patches[other] = Self::of_cell(&signed[other], &turned);
                    }
                }
            }
            if turned.len() == before {
                return patches;
            }
        }
    }

    fn of_cell(signed: &Signed, turned: &HashSet<[u32; 4]>) -> Self {
        let mut joined = [[usize::MAX; 2]; EDGES];
        let mut join = |a: usize, b: usize| {
            for (one, other) in [(a, b), (b, a)] {
                let place = usize::from(joined[one][0] != usize::MAX);
                joined[one][place] = other;
            }
        };
        for face in FACES {
            let crossed = edges(face).filter(|edge| is_crossed(signed.inside, *edge));
            if is_ambiguous(signed.inside, face) {
                let is_turned = turned.contains(&name(signed.cell, face));
                for [a, b] in pairs(signed.inside, face, is_turned) {
                    join(a, b);
                }
            } else if let [a, b] = crossed.collect::<Vec<_>>()[..] {
                join(a, b);
            }
        }
        let mut patches = Self { of_edge: [NONE; EDGES], count: 0 };
        for first in 0..EDGES {
            if joined[first][0] == usize::MAX || patches.of_edge[first] != NONE {
                continue;
            }
            let mut edge = first;
            loop {
                patches.of_edge[edge] = patches.count;
                let next = joined[edge].into_iter().find(|next| patches.of_edge[*next] == NONE);
                let Some(next) = next else { break };
                edge = next;
            }
            patches.count += 1;
        }
        patches
    }

    /// Whether all crossings of a face are in one patch.
    fn joins(&self, face: Face) -> bool {
        let mut patches = edges(face).map(|edge| self.of_edge[edge]);
        let first = patches.next();
        patches.all(|patch| Some(patch) == first)
    }
}

/// The name of a face that both of its cells know: its axis and its lowest node.
fn name(cell: [u32; 3], (axis, side): Face) -> [u32; 4] {
    let mut node = cell;
    node[axis] += side as u32;
    [axis as u32, node[0], node[1], node[2]]
}

/// The number of the edge along an axis at sides of the two axes after it.
const fn edge(axis: usize, sides: [usize; 2]) -> usize {
    4 * axis + sides[0] + 2 * sides[1]
}

/// The edges of a face: along its first axis at both sides of the second, then the other way.
fn edges((axis, side): Face) -> impl Iterator<Item = usize> {
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    // The axes after b are c and the face's, those after c are the face's and b.
    [edge(b, [0, side]), edge(b, [1, side]), edge(c, [side, 0]), edge(c, [side, 1])].into_iter()
}

/// The corner of a cell at sides of the face's axis and the two after it.
fn corner((axis, side): Face, sides: [usize; 2]) -> usize {
    side << axis | sides[0] << ((axis + 1) % 3) | sides[1] << ((axis + 2) % 3)
}

fn is_inside(inside: u8, corner: usize) -> bool {
    (inside >> corner) & 1 == 1
}

/// Whether the ends of an edge differ.
pub(super) fn is_crossed(inside: u8, edge: usize) -> bool {
    let [low, high] = ends(edge);
    is_inside(inside, low) != is_inside(inside, high)
}

/// The corners at the ends of an edge.
pub(super) fn ends(edge: usize) -> [usize; 2] {
    let axis = edge / 4;
    let low = (edge & 1) << ((axis + 1) % 3) | ((edge >> 1) & 1) << ((axis + 2) % 3);
    [low, low | 1 << axis]
}

fn is_ambiguous(inside: u8, face: Face) -> bool {
    let at = |sides| is_inside(inside, corner(face, sides));
    at([0, 0]) == at([1, 1]) && at([1, 0]) == at([0, 1]) && at([0, 0]) != at([1, 0])
}

/// The pairs of crossings of a face with four: around its corners inside, or around those outside.
fn pairs(inside: u8, face: Face, around_outside: bool) -> [[usize; 2]; 2] {
    let all: Vec<usize> = edges(face).collect();
    let [b0, b1, c0, c1] = [all[0], all[1], all[2], all[3]];
    if is_inside(inside, corner(face, [0, 0])) == around_outside {
        // Around the corners at the lower side of one axis and the upper side of the other.
        [[b0, c1], [b1, c0]]
    } else {
        [[b0, c0], [b1, c1]]
    }
}
