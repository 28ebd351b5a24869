// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A mesh made into one that bounds a solid, step by step.

mod cap;
mod crossing;
mod join;
mod junctions;
mod orient;
mod rims;

use palpate_field::Point;

pub use cap::Opening;
pub(crate) use crossing::crossing_faces;
pub(super) use crossing::{Crossings, Known};
pub(super) use join::{Joined, ShortEdge, cracks, shortest_edge};
pub(crate) use join::{Within, rounding_of};
pub(super) use orient::Pieces;
pub(super) use rims::{by_rim, sides};

use junctions::Parted;
use orient::{Doubled, Patch};

use super::findings::Findings;
use crate::mesh::{Mesh, weld};

/// A mesh under repair.
pub(super) struct Repair<const N: usize, const D: usize> {
    pub(super) vertices: Vec<Point<D>>,
    pub(super) elements: Vec<[u32; N]>,
    pub(super) findings: Findings<D>,
    pub(super) pieces: Pieces,
    /// Of each element, the opening that it closes.
    pub(super) caps: Vec<Option<usize>>,
    /// Of each opening, whether its elements are known to meet at common corners and edges alone.
    pub(super) is_flat: Vec<bool>,
    /// Whether the mesh as a whole is a sheet.
    pub(super) is_sheet: bool,
}

impl<const N: usize, const D: usize> Repair<N, D> {
    /// All steps but the search for faces that cross: equal vertices are welded, and those that are `within` so much of
    /// each other where that closes edges; elements with a vertex twice and doubled elements are dropped; neighbours are
    /// turned to agree on the inside; faces are parted at corners of others on their edges; openings are capped;
    /// sheets within the solid are dropped; pieces that are inside out are turned. Of a sheet the last steps are left
    /// out.
    pub(super) fn of(mesh: &Mesh<N, D>, within: Within) -> Self {
        let (vertices, names) = weld(mesh.vertices());
        let mut findings = Findings { faces: mesh.elements().len(), ..Findings::default() };
        findings.welded = mesh.vertices().len() - vertices.len();
        let named = |element: &[u32; N]| element.map(|index| names[index as usize]);
        let elements: Vec<_> = mesh.elements().iter().map(named).collect();
        let mut repair = Self {
            vertices,
            elements,
            findings,
            pieces: Pieces::default(),
            caps: Vec::new(),
            is_flat: Vec::new(),
            is_sheet: false,
        };
        repair.clean();
        repair.part(0.0);
        let Joined { corners, farthest, tolerance } =
            join::join(&repair.vertices, &mut repair.elements, within, mesh.rounding());
        if corners > 0 {
            (repair.findings.joined, repair.findings.moved) = (corners, farthest);
            repair.clean();
        }
        if tolerance > 0.0 {
            repair.part(tolerance);
        }
        repair.caps = vec![None; repair.elements.len()];
        let caps = cap::close(&repair.vertices, &mut repair.elements);
        repair.caps.extend(caps.of_element.into_iter().map(Some));
        (repair.findings.openings, repair.is_flat) = (caps.openings, caps.is_flat);
        repair.drop_membranes();
        if repair.is_sheet {
            return repair;
        }
        repair.findings.own = repair.caps.iter().filter(|cap| cap.is_none()).count();
        repair.pieces = orient::outwards(&repair.vertices, &mut repair.elements);
        (repair.findings.inside_out, repair.findings.nested) =
            (repair.pieces.turned, repair.pieces.nested);
        for at_rim in by_rim(&sides(&repair.elements)) {
            repair.findings.crowded_rims += usize::from(at_rim.len() > 2);
        }
        repair
    }

    /// Drops elements with a vertex twice and doubled ones, and turns neighbours to agree on the inside.
    fn clean(&mut self) {
        let before = self.elements.len();
        self.elements.retain(|element| (1..N).all(|i| !element[..i].contains(&element[i])));
        self.findings.degenerate += before - self.elements.len();
        self.drop_duplicates();
        let (turned, one_sided) = orient::agree(&mut self.elements);
        self.findings.turned += turned;
        self.findings.one_sided = one_sided;
    }

    /// Parts faces at corners of others on their edges, within a tolerance [m].
    fn part(&mut self, tolerance: f64) {
        let Parted { edges, farthest } =
            junctions::part(&self.vertices, &mut self.elements, tolerance);
        self.findings.parted += edges;
        self.findings.moved = self.findings.moved.max(farthest);
    }

    /// Drops the sheets within the solid, and what closes them; none if the mesh as a whole is a sheet.
    fn drop_membranes(&mut self) {
        let found = orient::membranes(&self.vertices, &self.elements, &self.caps);
        let Some(is_of_one) = found else {
            self.is_sheet = true;
            return;
        };
        let own =
            is_of_one.iter().zip(&self.caps).filter(|(is_one, cap)| **is_one && cap.is_none());
        self.findings.inner = own.count();
        if self.findings.inner == 0 {
            return;
        }
        let is_kept = |i: &usize| !is_of_one[*i];
        let kept: Vec<usize> = (0..self.elements.len()).filter(is_kept).collect();
        self.elements = kept.iter().map(|i| self.elements[*i]).collect();
        let caps: Vec<_> = kept.iter().map(|i| self.caps[*i]).collect();
        // The openings of membranes were none.
        let mut number = vec![None; self.is_flat.len()];
        let (mut openings, mut is_flat) = (Vec::new(), Vec::new());
        for opening in caps.iter().flatten() {
            if number[*opening].is_none() {
                number[*opening] = Some(openings.len());
                openings.push(self.findings.openings[*opening]);
                is_flat.push(self.is_flat[*opening]);
            }
        }
        self.caps = caps.into_iter().map(|cap| cap.and_then(|i| number[i])).collect();
        (self.findings.openings, self.is_flat) = (openings, is_flat);
    }

    /// Drops elements with the vertices of another: of a wall between two volumes all go, of others one stays that has
    /// the direction of most. A wall whose elements have one direction is left: volumes on one side of it are both
    /// within it, and of two on both sides one is inside out.
    fn drop_duplicates(&mut self) {
        let doubled = Doubled::of(&self.elements);
        let mut is_dropped = vec![false; self.elements.len()];
        for (group, same) in doubled.groups.iter().enumerate() {
            let element = self.elements[same[0]];
            let has_its_direction =
                |i: &&usize| has_same_direction(&self.elements[**i], element);
            let along = same.iter().filter(has_its_direction).count();
            let is_balanced = 2 * along == same.len();
            let goes = |i: &&usize| match doubled.patch_of(group) {
                Patch::Wall if along == same.len() => false,
                Patch::Wall if is_balanced => true,
                Patch::Free if is_balanced && !doubled.are_all => true,
                _ => {
                    let is_of_most =
                        |i: &&usize| has_its_direction(i) == (2 * along >= same.len());
                    Some(*i) != same.iter().find(is_of_most)
                }
            };
            same.iter().filter(goes).for_each(|i| is_dropped[*i] = true);
        }
        let mut dropped = is_dropped.iter();
        self.elements.retain(|_| dropped.next() == Some(&false));
        self.findings.duplicates += is_dropped.iter().filter(|dropped| **dropped).count();
    }
}

/// Whether an element has its vertices in the same direction as another with the same vertices.
fn has_same_direction<const N: usize>(element: &[u32; N], other: [u32; N]) -> bool {
    let at = other.iter().position(|index| *index == element[0]).unwrap_or(0);
    N == 2 && at == 0 || N == 3 && other[(at + 1) % N] == element[1]
}
