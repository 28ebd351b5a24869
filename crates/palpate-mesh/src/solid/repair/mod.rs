// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A mesh made into one that bounds a solid, step by step.

mod cap;
mod crossing;
mod ears;
mod hubs;
mod junctions;
mod orient;
mod rims;
mod sheets;

use std::collections::HashMap;

use palpate_field::Point;

pub use cap::Opening;
pub(crate) use crossing::crossing_faces;
pub(super) use crossing::{Crossings, Known};
pub(super) use orient::Pieces;
pub(super) use rims::{by_rim, sides};

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
    /// All steps but the search for faces that cross: equal vertices are welded; elements with a vertex twice and
    /// doubled elements are dropped; neighbours are turned to agree on the inside; faces are parted at corners of
    /// others on their edges; openings are capped; sheets within the solid are dropped; pieces that are inside out
    /// are turned.
    pub(super) fn of(mesh: &Mesh<N, D>) -> Self {
        let (vertices, names) = weld(mesh.vertices());
        let mut findings = Findings { faces: mesh.elements().len(), ..Findings::default() };
        findings.welded = mesh.vertices().len() - vertices.len();
        let named = |element: &[u32; N]| element.map(|index| names[index as usize]);
        let mut elements: Vec<_> = mesh.elements().iter().map(named).collect();
        elements.retain(|element| (1..N).all(|i| !element[..i].contains(&element[i])));
        findings.degenerate = findings.faces - elements.len();
        let mut repair = Self {
            vertices,
            elements,
            findings,
            pieces: Pieces::default(),
            caps: Vec::new(),
            is_flat: Vec::new(),
            is_sheet: false,
        };
        repair.drop_duplicates();
        (repair.findings.turned, repair.findings.one_sided) =
            orient::agree(&mut repair.elements);
        repair.findings.parted = junctions::part(&repair.vertices, &mut repair.elements);
        repair.caps = vec![None; repair.elements.len()];
        let caps = cap::close(&repair.vertices, &mut repair.elements);
        repair.caps.extend(caps.of_element.into_iter().map(Some));
        (repair.findings.openings, repair.is_flat) = (caps.openings, caps.is_flat);
        repair.drop_membranes();
        repair.findings.own = repair.caps.iter().filter(|cap| cap.is_none()).count();
        repair.pieces = orient::outwards(&repair.vertices, &mut repair.elements);
        (repair.findings.inside_out, repair.findings.nested) =
            (repair.pieces.turned, repair.pieces.nested);
        for at_rim in by_rim(&sides(&repair.elements)) {
            repair.findings.crowded_rims += usize::from(at_rim.len() > 2);
        }
        repair
    }

    /// Drops the sheets within the solid, and what closes them; none if the mesh as a whole is a sheet.
    fn drop_membranes(&mut self) {
        let found = sheets::membranes(&self.vertices, &self.elements, &self.caps);
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

    /// Drops elements with the vertices of another. Two that face each other are a wall between two volumes, and
    /// both go, unless that would leave an opening: then one stays.
    fn drop_duplicates(&mut self) {
        let key = |element: &[u32; N]| {
            let mut key = *element;
            key.sort_unstable();
            key
        };
        let mut copies: HashMap<[u32; N], Vec<usize>> = HashMap::new();
        for (i, element) in self.elements.iter().enumerate() {
            copies.entry(key(element)).or_default().push(i);
        }
        let mut at_rims: HashMap<[u32; 2], usize> = HashMap::new();
        for side in sides(&self.elements) {
            *at_rims.entry(side.rim).or_default() += 1;
        }
        let mut is_dropped = vec![false; self.elements.len()];
        let mut doubled: Vec<_> = copies.into_values().filter(|same| same.len() > 1).collect();
        doubled.sort_unstable();
        for same in doubled {
            let element = self.elements[same[0]];
            let has_its_direction =
                |i: &&usize| has_same_direction(&self.elements[**i], element);
            let along = same.iter().filter(has_its_direction).count();
            let others =
                |rim: &[u32; 2]| at_rims.get(rim).map_or(0, |count| count - same.len());
            let is_wall = 2 * along == same.len()
                && rims_of(&element).iter().all(|rim| others(rim).is_multiple_of(2));
            // Of an odd number, one stays that has the direction of most.
            let stays = same.iter().find(|i| has_its_direction(i) == (2 * along >= same.len()));
            for i in same.iter().filter(|i| is_wall || Some(*i) != stays) {
                is_dropped[*i] = true;
                for rim in rims_of(&element) {
                    at_rims.entry(rim).and_modify(|count| *count -= 1);
                }
            }
        }
        let mut dropped = is_dropped.iter();
        self.elements.retain(|_| dropped.next() == Some(&false));
        self.findings.duplicates = is_dropped.iter().filter(|dropped| **dropped).count();
    }
}

/// The rims of an element.
fn rims_of<const N: usize>(element: &[u32; N]) -> [[u32; 2]; N] {
    std::array::from_fn(|i| {
        let (from, to) = (element[i], element[(i + 1) % N]);
        if N == 2 { [from; 2] } else { [from.min(to), from.max(to)] }
    })
}

/// Whether an element has its vertices in the same direction as another with the same vertices.
fn has_same_direction<const N: usize>(element: &[u32; N], other: [u32; N]) -> bool {
    let at = other.iter().position(|index| *index == element[0]).unwrap_or(0);
    N == 2 && at == 0 || N == 3 && other[(at + 1) % N] == element[1]
}
