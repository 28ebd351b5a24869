// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pairs of elements at vertices at which many meet.
//!
//! The boxes of all elements at such a vertex overlap. But two of them that share another point than the vertex are
//! seen from it in a common direction: pairs are looked for among the arcs of directions instead, whose boxes are
//! small.

use std::collections::HashMap;

use palpate_field::{Aabb, Point, Vector};

use crate::solid::boxes::Boxes;
use crate::tree::{BallTree, FAN};

/// A vertex of more elements is a hub. Of fewer, comparing all pairs is as fast.
const MANY: usize = 64;

/// Room for the rounding of directions.
const ROOM: f64 = 1e-12;

/// The vertices of many elements.
pub(super) struct Hubs<const N: usize> {
    /// The elements of each hub.
    elements: Vec<(u32, Vec<usize>)>,
    /// Of each element its hubs, the lowest first, and [`NONE`] for its other vertices.
    of_element: Vec<[u32; N]>,
}

/// No vertex.
const NONE: u32 = u32::MAX;

impl<const N: usize> Hubs<N> {
    pub(super) fn of(vertices: usize, elements: &[[u32; N]]) -> Self {
        let mut counts = vec![0; vertices];
        for index in elements.iter().flatten() {
            counts[*index as usize] += 1;
        }
        let mut of_hub: HashMap<u32, Vec<usize>> = HashMap::new();
        let mut of_element = Vec::with_capacity(elements.len());
        for (i, element) in elements.iter().enumerate() {
            let hub = |index: u32| if counts[index as usize] > MANY { index } else { NONE };
            let mut hubs = element.map(hub);
            hubs.sort_unstable();
            for hub in hubs.iter().filter(|hub| **hub != NONE) {
                of_hub.entry(*hub).or_default().push(i);
            }
            of_element.push(hubs);
        }
        let mut elements: Vec<_> = of_hub.into_iter().collect();
        elements.sort_unstable();
        Self { elements, of_element }
    }

    /// The lowest hub that two elements share.
    #[inline]
    pub(super) fn common(&self, [i, k]: [usize; 2]) -> Option<u32> {
        let [a, b] = [i, k].map(|element| &self.of_element[element]);
        match () {
            () if a[0] == NONE || b[0] == NONE => None,
            () if a[1] == NONE && b[1] == NONE => (a[0] == b[0]).then_some(a[0]),
            () => a.iter().find(|hub| **hub != NONE && b.contains(hub)).copied(),
        }
    }

    /// Calls `visit` once with each pair of elements that share a hub and may share another point.
    pub(super) fn each_pair<const D: usize>(
        &self,
        vertices: &[Point<D>],
        elements: &[[u32; N]],
        mut visit: impl FnMut([usize; 2]),
    ) {
        for (hub, at_hub) in &self.elements {
            let arc = |i: &usize| {
                let others = elements[*i].iter().filter(|index| *index != hub);
                arc(vertices[*hub as usize], others.map(|index| vertices[*index as usize]))
            };
            // The ends of the box around each arc, and between them an element.
            let ends: Vec<Point<D>> =
                at_hub.iter().map(arc).flat_map(|box_| [box_.min, box_.max]).collect();
            let lines: Vec<[u32; 2]> =
                (0..at_hub.len() as u32).map(|i| [2 * i, 2 * i + 1]).collect();
            let order = BallTree::new(&ends, &lines).order().to_vec();
            let arcs: Vec<[Point<D>; 2]> = order
                .iter()
                .map(|i| lines[*i as usize].map(|end| ends[end as usize]))
                .collect();
            let boxes = Boxes::new(&arcs);
            let element = |i: usize| at_hub[order[i] as usize];
            for (i, [min, max]) in arcs.iter().enumerate() {
                boxes.overlapping(&Aabb { min: *min, max: *max }, |group| {
                    for k in (group * FAN).max(i + 1)..arcs.len().min((group + 1) * FAN) {
                        let (a, b) = (element(i), element(k));
                        let pair = [a.min(b), a.max(b)];
                        if share_a_point(&arcs[i], &arcs[k]) && self.common(pair) == Some(*hub)
                        {
                            visit(pair);
                        }
                    }
                });
            }
        }
    }
}

/// Whether two boxes share a point.
fn share_a_point<const D: usize>([a, b]: &[Point<D>; 2], [c, d]: &[Point<D>; 2]) -> bool {
    (0..D).all(|k| a[k] <= d[k] && c[k] <= b[k])
}

/// The box around the directions in which an element with these other corners is seen from a corner.
fn arc<const D: usize>(hub: Point<D>, others: impl Iterator<Item = Point<D>>) -> Aabb<D> {
    let whole = Aabb { min: Vector([-2.0; D]), max: Vector([2.0; D]) };
    let directions: Option<Vec<_>> = others.map(|p| (p - hub).normalized()).collect();
    let Some(directions) = directions else { return whole };
    let Some(around) = Aabb::around(directions.iter().copied()) else { return whole };
    // An arc is this far from its chord at most.
    let cosine = match directions[..] {
        [a, b] => a.dot(b).clamp(-1.0, 1.0),
        _ => 1.0,
    };
    around.grown(1.0 - (0.5 * (1.0 + cosine)).sqrt() + ROOM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_overlap_as_seen_from_a_hub_are_found_and_few_others() {
        // A fan around the whole turn, and one face across it.
        let count = 500_u32;
        let at = |i: f64| {
            let angle = std::f64::consts::TAU * i / f64::from(count);
            Vector([angle.cos(), 0.1, angle.sin()])
        };
        let mut vertices: Vec<Point<3>> = vec![Vector::ZERO];
        vertices.extend((0..count).map(|i| at(f64::from(i))));
        vertices.extend([at(10.2) * 0.5, at(12.7) * 2.0]);
        let mut elements: Vec<[u32; 3]> =
            (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        elements.push([0, count + 1, count + 2]);
        let hubs = Hubs::of(vertices.len(), &elements);
        let mut pairs = Vec::new();
        hubs.each_pair(&vertices, &elements, |pair| pairs.push(pair));
        pairs.sort_unstable();
        let all = pairs.len();
        pairs.dedup();
        assert_eq!(all, pairs.len());
        for face in [10, 11, 12] {
            assert!(pairs.contains(&[face, 500]), "{face}");
        }
        assert!(pairs.len() < 2000, "{}", pairs.len());
    }
}
