// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! T-junctions: edges on which corners of other faces lie.
//!
//! Between the edge and those corners is a gap without area, which no cap can close. Instead the face of the edge is
//! parted at the corners. What lies exactly on an edge changes no face when it becomes a corner.

use std::collections::HashMap;

use palpate_field::{Aabb, Point, Vector};
use robust::{Coord, orient2d};

use super::rims::{Side, by_rim, sides};
use crate::solid::boxes::Boxes;
use crate::tree::{BallTree, FAN};

/// Parts the faces on an edge of which corners of others lie exactly, if edges of those lead back along it from corner
/// to corner; returns how many edges were parted.
pub(super) fn part<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut Vec<[u32; N]>,
) -> usize {
    if N == 2 {
        return 0;
    }
    let sides = sides(elements);
    let alone: Vec<&Side> =
        by_rim(&sides).filter(|at_rim| at_rim.len() == 1).map(|at_rim| &at_rim[0]).collect();
    let chains = chains(vertices, &alone);
    if chains.is_empty() {
        return 0;
    }
    // The element at each edge of one.
    let mut at_edge: HashMap<[u32; 2], usize> =
        alone.iter().map(|side| (side.rim, side.element as usize)).collect();
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let parted = chains.len();
    for mut chain in chains {
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
    }
    parted
}

/// The edges of one element along which other such edges lead back: their ends, and the corners between them.
fn chains<const D: usize>(vertices: &[Point<D>], alone: &[&Side]) -> Vec<Vec<u32>> {
    let edges: Vec<[u32; 2]> = alone.iter().map(|side| side.rim).collect();
    if edges.is_empty() {
        return Vec::new();
    }
    let at = |i: u32| vertices[i as usize];
    let order = BallTree::new(vertices, &edges).order().to_vec();
    let in_order: Vec<_> = order.iter().map(|i| edges[*i as usize].map(at)).collect();
    let boxes = Boxes::new(&in_order);
    let mut ends: Vec<u32> = edges.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    let mut between = vec![Vec::new(); edges.len()];
    for end in ends {
        let p = at(end);
        boxes.overlapping(&Aabb { min: p, max: p }, |group| {
            for edge in order.iter().skip(group * FAN).take(FAN).map(|i| *i as usize) {
                if is_between(edges[edge].map(at), p) {
                    between[edge].push(end);
                }
            }
        });
    }
    // Whether the element of an edge passes it from the lower corner to the higher.
    let is_forward: HashMap<[u32; 2], bool> =
        alone.iter().map(|side| (side.rim, side.is_forward)).collect();
    let chain = |([first, last], mut between): ([u32; 2], Vec<u32>)| {
        let way = at(last) - at(first);
        let along = |i: &u32| (at(*i) - at(first)).dot(way);
        between.sort_by(|a, b| along(a).total_cmp(&along(b)));
        std::iter::once(first).chain(between).chain(std::iter::once(last)).collect()
    };
    let leads_back = |chain: &Vec<u32>| {
        let passes = |from: u32, to: u32| {
            is_forward
                .get(&[from.min(to), from.max(to)])
                .map(|is_forward| *is_forward == (from < to))
        };
        let whole = passes(chain[0], chain[chain.len() - 1]);
        chain.windows(2).all(|step| passes(step[1], step[0]) == whole)
    };
    let on_edges =
        edges.iter().copied().zip(between).filter(|(_, between)| !between.is_empty());
    on_edges.map(chain).filter(leads_back).collect()
}

/// Whether a point lies exactly on the line between two others, and between them.
fn is_between<const D: usize>(ends: [Point<D>; 2], p: Point<D>) -> bool {
    let around = Aabb::around(ends).is_some_and(|aabb| aabb.contains(p));
    let [a, b] = ends.map(|end| end.in_space());
    let p = p.in_space();
    around && p != a && p != b && (0..3).all(|k| turn([a, b, p], [k, (k + 1) % 3]) == 0.0)
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
    }

    /// Faces were parted along loops of edges. Of a fine lid on a coarse box no edge is of both, so that lid and box had
    /// a loop each, which were closed by caps.
    #[test]
    fn a_lid_of_which_no_edge_is_of_the_box_is_joined_to_it() {
        // A square of two faces below a pyramid whose eight faces have half its sides each.
        let vertices: Vec<Point<3>> = (0..9)
            .map(|i| Vector([f64::from(i % 3), f64::from(i / 3), f64::from(u8::from(i == 4))]))
            .collect();
        let mut elements: Vec<[u32; 3]> = vec![[0, 8, 2], [0, 6, 8]];
        let around = [0, 1, 2, 5, 8, 7, 6, 3];
        elements.extend((0..8).map(|i| [around[i], around[(i + 1) % 8], 4]));
        assert_eq!(part(&vertices, &mut elements), 4);
        assert!(by_rim(&sides(&elements)).all(|at_rim| at_rim.len() == 2));
    }
}
