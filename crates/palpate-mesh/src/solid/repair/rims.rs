// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rims: the edges at which triangles meet, the end points at which segments do.

use std::f64::consts::TAU;

use palpate_field::{Point, Vector};

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
