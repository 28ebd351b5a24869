// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rims, and vertices and edges where several of them meet.
//!
//! Pairs of elements at vertices at which many meet.
//!
//! The boxes of all elements at such a vertex overlap. But two of them that share another point than the vertex are
//! seen from it in a common direction: pairs are looked for among the arcs of directions instead, whose boxes are
//! small.

use std::collections::HashMap;
use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Vector};

use super::super::faces::Boxes;
use crate::tree::{BallTree, FAN};

/// A rim of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::solid) struct Side {
    /// The vertices of the rim, the lower first; an end point twice.
    pub(in crate::solid) rim: [u32; 2],
    pub(in crate::solid) element: u32,
    /// Which of the element's sides it is: from this corner on, or at it.
    pub(in crate::solid) number: u8,
    /// Whether the element passes from the lower vertex to the higher, or begins at the end point. Two
    /// elements agree on the inside if they pass their rim in both directions.
    pub(in crate::solid) is_forward: bool,
}

/// The sides of all elements, sorted by rim.
pub(in crate::solid) fn sides<const N: usize>(elements: &[[u32; N]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(N * elements.len());
    for (element, indices) in (0..).zip(elements) {
        for i in 0..N {
            let (from, to) = (indices[i], indices[(i + 1) % N]);
            let (rim, is_forward) = match N {
                2 => ([from; 2], i == 0),
                _ => ([from.min(to), from.max(to)], from < to),
            };
            sides.push(Side { rim, element, number: i as u8, is_forward });
        }
    }
    sides.sort_unstable();
    sides
}

/// The sides at each rim.
pub(in crate::solid) fn by_rim(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|a, b| a.rim == b.rim)
}

/// The pieces of a mesh: of each element the number of its piece, and how many pieces there are.
///
/// If exactly two elements meet at a rim, they belong to one piece. If more meet, first join those already joined
/// at other rims, then each pair that encloses solid, so that cubes which share an edge are two pieces. Where as
/// many elements pass each rim in one direction as in the other, no piece has a boundary, and on each of its sides the winding number is the same all over, unless something crosses it: what
/// lies between two that are paired cancels.
pub(super) fn pieces<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
) -> (Vec<usize>, usize) {
    let mut parents: Vec<usize> = (0..elements.len()).collect();
    let join = |parents: &mut [usize], [a, b]: [u32; 2]| {
        let (a, b) = (root(parents, a as usize), root(parents, b as usize));
        parents[a.max(b)] = a.min(b);
    };
    let sides = sides(elements);
    for at_rim in by_rim(&sides) {
        if let [a, b] = at_rim {
            join(&mut parents, [a.element, b.element]);
        }
    }
    for at_rim in by_rim(&sides).filter(|at_rim| at_rim.len() > 2) {
        let others = of_other_pieces(at_rim, |side| root(&mut parents, side.element as usize));
        if others.len() > 1 {
            for pair in pairs(vertices, elements, &others) {
                join(&mut parents, pair);
            }
        }
    }
    let (mut numbers, mut count) = (vec![usize::MAX; elements.len()], 0);
    for element in 0..elements.len() {
        let first = root(&mut parents, element);
        // The root of a piece is its first element.
        if first == element {
            numbers[element] = count;
            count += 1;
        } else {
            numbers[element] = numbers[first];
        }
    }
    (numbers, count)
}

/// The sides at a rim without those that pair with one of the same piece.
fn of_other_pieces(at_rim: &[Side], mut piece: impl FnMut(&Side) -> usize) -> Vec<Side> {
    let mut sorted: Vec<_> = at_rim.iter().map(|side| (piece(side), *side)).collect();
    sorted.sort_unstable();
    let mut others = Vec::new();
    for same in sorted.chunk_by(|a, b| a.0 == b.0) {
        let forward = same.iter().filter(|(_, side)| side.is_forward).count();
        // As many in both directions: whichever pair, they are of this piece.
        if 2 * forward != same.len() {
            others.extend(same.iter().map(|(_, side)| *side));
        }
    }
    others
}

/// An element as seen along a rim.
struct Spoke {
    /// Around the rim [rad].
    angle: f64,
    /// Whether the solid is on the side of larger angles.
    opens: bool,
    element: u32,
}

/// Elements at angles that differ by less [rad] lie on each other up to rounding: a sheet and its cap.
const SAME_ANGLE: f64 = 1e-9;

/// The pairs of elements at a rim that have the solid between them: around the rim, as brackets are paired.
fn pairs<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    at_rim: &[Side],
) -> Vec<[u32; 2]> {
    let mut spokes = spokes(vertices, elements, at_rim);
    spokes.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    // From the widest gap on, so that no two at one angle are first and last.
    let gap = |i: usize| {
        let before =
            if i == 0 { spokes[spokes.len() - 1].angle - TAU } else { spokes[i - 1].angle };
        spokes[i].angle - before
    };
    let widest = (1..spokes.len()).fold(0, |w, i| if gap(i) > gap(w) { i } else { w });
    spokes.rotate_left(widest);
    let turned = |angle: f64, first: f64| (angle - first).rem_euclid(TAU);
    let first = spokes[0].angle;
    // Of those that lie on each other, a sheet and its cap pair with each other.
    for run in
        spokes.chunk_by_mut(|a, b| turned(b.angle, first) - turned(a.angle, first) < SAME_ANGLE)
    {
        run.sort_by_key(|spoke| !spoke.opens);
    }
    let (mut open, mut found) = (Vec::new(), Vec::new());
    let mut is_paired = vec![false; spokes.len()];
    // Twice around: what opens last may close first.
    for round in 0..2 {
        for (i, spoke) in spokes.iter().enumerate() {
            if spoke.opens && round == 0 {
                open.push(i);
            } else if !spoke.opens
                && !is_paired[i]
                && let Some(k) = open.pop()
            {
                is_paired[i] = true;
                found.push([spokes[k].element, spoke.element]);
            }
        }
    }
    found
}

/// The elements at a rim, by their angles around it.
fn spokes<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    at_rim: &[Side],
) -> Vec<Spoke> {
    let at = |index: u32| vertices[index as usize].in_space();
    let [low, high] = at_rim.first().map_or([0, 0], |side| side.rim).map(at);
    // Around a point of the plane, elements turn about the third axis.
    let axis = (high - low).normalized().unwrap_or(Vector([0.0, 0.0, 1.0]));
    let away = |side: &Side| {
        let element = elements[side.element as usize];
        let other = element.iter().find(|index| !side.rim.contains(index));
        let to = other.map_or(low, |index| at(*index)) - low;
        to - axis * to.dot(axis)
    };
    let along = at_rim.first().and_then(|side| away(side).normalized()).unwrap_or(Vector::ZERO);
    let across = axis.cross(along);
    let spoke = |side: &Side| {
        let away = away(side);
        Spoke {
            angle: away.dot(across).atan2(away.dot(along)),
            // A triangle that passes its rim forwards has its normal, which leads out, on the side of larger
            // angles; a segment that begins at its rim has the solid there, on its left.
            opens: side.is_forward == (N == 2),
            element: side.element,
        }
    };
    at_rim.iter().map(spoke).collect()
}

/// The first of the elements that are joined with an element.
pub(super) fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

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
mod hubs_tests {
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
