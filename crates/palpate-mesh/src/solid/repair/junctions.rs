// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! T-junctions: edges on which corners of other faces lie.
//!
//! Between the edge and those corners is a loop without area. A cap of it would be a face without area; instead the
//! face of the edge is parted at the corners.

use std::collections::HashMap;

use palpate_field::{Point, Vector};
use robust::{Coord, orient2d};

use super::cap::loops;
use super::rims::{by_rim, sides};

/// Parts the faces on an edge of which corners of others lie exactly; how many.
pub(super) fn part<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut Vec<[u32; N]>,
) -> usize {
    if N == 2 {
        return 0;
    }
    let loops = loops(elements);
    let flat: Vec<Vec<u32>> =
        loops.into_iter().filter_map(|l| along_an_edge(vertices, l)).collect();
    if flat.is_empty() {
        return 0;
    }
    // The element at each edge of one.
    let mut at_edge: HashMap<[u32; 2], usize> = by_rim(&sides(elements))
        .filter(|at_rim| at_rim.len() == 1)
        .map(|at_rim| (at_rim[0].rim, at_rim[0].element as usize))
        .collect();
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut parted = 0;
    for mut chain in flat {
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        let Some(face) = at_edge.get(&key(first, last)).copied() else { continue };
        let Some(at) = elements[face].iter().position(|i| *i != first && *i != last) else {
            continue;
        };
        let corner = |step: usize| elements[face][(at + step) % N];
        let (from, to, opposite) = (corner(1), corner(2), corner(0));
        if from != first {
            chain.reverse();
        }
        let part = |ends: &[u32]| {
            let part = [ends[0], ends[1], opposite];
            std::array::from_fn(|k| part[k])
        };
        let mut parts = chain.windows(2).map(part);
        if let Some(part) = parts.next() {
            elements[face] = part;
        }
        elements.extend(parts);
        // The last part has the edge from the end of the chain on.
        if let Some(element) = at_edge.get_mut(&key(to, opposite)) {
            *element = elements.len() - 1;
        }
        parted += 1;
    }
    parted
}

/// The corners of a loop from end to end of a line on which they all lie, if one edge of the loop leads from end to
/// end and the others go back step by step.
fn along_an_edge<const D: usize>(
    vertices: &[Point<D>],
    mut corners: Vec<u32>,
) -> Option<Vec<u32>> {
    let at = |i: u32| vertices[i as usize].in_space();
    let (first, second) = (at(*corners.first()?), at(*corners.get(1)?));
    let step = second - first;
    let axis = (1..3).fold(0, |k, i| if step[i].abs() > step[k].abs() { i } else { k });
    let on_line =
        |i: &u32| (0..3).all(|k| turn([first, second, at(*i)], [k, (k + 1) % 3]) == 0.0);
    if !corners.iter().all(on_line) {
        return None;
    }
    let along = |i: &u32| at(*i)[axis];
    let lowest = (0..corners.len())
        .min_by(|a, b| along(&corners[*a]).total_cmp(&along(&corners[*b])))?;
    corners.rotate_left(lowest);
    // From the lowest corner the loop goes straight to the highest and back in steps, or the other way.
    let is_rising = |chain: &[u32]| chain.windows(2).all(|two| along(&two[0]) < along(&two[1]));
    if is_rising(&corners) {
        return Some(corners);
    }
    corners[1..].reverse();
    is_rising(&corners).then_some(corners)
}

/// The sign of the turn at three points, as seen along an axis.
fn turn(points: [Point<3>; 3], [x, y]: [usize; 2]) -> f64 {
    let [a, b, c] = points.map(|Vector(p)| Coord { x: p[x], y: p[y] });
    orient2d(a, b, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners on two edges of one face, two of them on one.
    #[test]
    fn a_face_is_parted_at_all_corners_on_its_edges() {
        let vertices: Vec<Point<3>> = [
            [0.0, 0.0, 0.0],
            [3.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [1.5, 2.0, 0.0],
            [1.0, 1.0, 2.0],
        ]
        .map(Vector)
        .to_vec();
        // The face below, and those of a pyramid above it.
        let mut elements: Vec<[u32; 3]> =
            vec![[0, 2, 1], [0, 3, 6], [3, 4, 6], [4, 1, 6], [1, 5, 6], [5, 2, 6], [2, 0, 6]];
        assert_eq!(part(&vertices, &mut elements), 2);
        assert_eq!(elements.len(), 10);
        assert!(by_rim(&sides(&elements)).all(|at_rim| at_rim.len() == 2));
        assert!(loops(&elements).is_empty());
    }
}
