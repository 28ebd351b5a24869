// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which crossings of a cell belong to one sheet of the surface.
//!
//! On each face of a cell the crossings are joined in pairs; pairs on all faces join them to loops, the patches. Four
//! crossings on a face can be joined in two ways. At first the corners inside are kept apart; where both cells of the
//! face would then join all four in one patch, an edge of the mesh would have four faces, and the corners outside are
//! kept apart instead (Wenger 2013).

use std::collections::{HashMap, HashSet};

use super::cells::Signed;

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
