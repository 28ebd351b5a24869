// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! T-junctions: edges on which corners of other faces lie.
//!
//! Between the edge and those corners is a gap without area, which no cap can close. Instead the face of the edge is
//! parted at the corners. What lies exactly on an edge changes no face when it becomes a corner; what lies beside it
//! by a rounding moves the edge by as much.

use std::collections::HashMap;

use palpate_field::{Aabb, Point, Vector};
use robust::{Coord, orient2d};

use super::super::faces::Boxes;
use super::rims::{Side, by_rim, sides};
use crate::tree::{BallTree, FAN};

/// The edges that were parted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Parted {
    pub(super) edges: usize,
    /// How far the farthest corner was from the edge that it parted [m].
    pub(super) farthest: f64,
}

/// Parts the faces on an edge of which corners of others lie, within a tolerance [m], where that closes every part of
/// the edge. Zero stands for exactly.
pub(super) fn part<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut Vec<[u32; N]>,
    tolerance: f64,
) -> Parted {
    let mut parted = Parted::default();
    if N == 2 {
        return parted;
    }
    let sides = sides(elements);
    let alone: Vec<&Side> =
        by_rim(&sides).filter(|at_rim| at_rim.len() == 1).map(|at_rim| &at_rim[0]).collect();
    let chains = chains(vertices, &alone, tolerance);
    // The element at each edge of one.
    let mut at_edge: HashMap<[u32; 2], usize> =
        alone.iter().map(|side| (side.rim, side.element as usize)).collect();
    for mut chain in chains {
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        let Some(face) = at_edge.get(&rim(first, last)).copied() else { continue };
        let Some(at) = elements[face].iter().position(|i| *i != first && *i != last) else {
            continue;
        };
        parted.edges += 1;
        let ends = [first, last].map(|end| vertices[end as usize]);
        for between in &chain[1..chain.len() - 1] {
            let far = from_segment(ends, vertices[*between as usize]);
            parted.farthest = parted.farthest.max(far);
        }
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
        if let Some(element) = at_edge.get_mut(&rim(to, opposite)) {
            *element = elements.len() - 1;
        }
    }
    if tolerance == 0.0 {
        // What rounds in the measurement lies exactly there.
        parted.farthest = 0.0;
    }
    parted
}

fn rim(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The edges of one element that corners of other such edges part, so that each part meets one of them: their ends, and the
/// corners between them.
fn chains<const D: usize>(
    vertices: &[Point<D>],
    alone: &[&Side],
    tolerance: f64,
) -> Vec<Vec<u32>> {
    let edges: Vec<[u32; 2]> = alone.iter().map(|side| side.rim).collect();
    if edges.is_empty() {
        return Vec::new();
    }
    let at = |i: u32| vertices[i as usize];
    let mut between = vec![Vec::new(); edges.len()];
    let lines: Vec<_> = edges.iter().map(|edge| edge.map(at)).collect();
    for group in on_one_line(&lines, tolerance) {
        let of_group: Vec<_> = group.iter().map(|edge| edges[*edge]).collect();
        let order = BallTree::new(vertices, &of_group).order().to_vec();
        let in_order: Vec<_> = order.iter().map(|i| lines[group[*i as usize]]).collect();
        let boxes = Boxes::new(&in_order);
        let mut ends: Vec<u32> = of_group.into_iter().flatten().collect();
        ends.sort_unstable();
        ends.dedup();
        for end in ends {
            let p = at(end);
            boxes.overlapping(&Aabb { min: p, max: p }.grown(tolerance), |found| {
                for edge in order.iter().skip(found * FAN).take(FAN).map(|i| group[*i as usize])
                {
                    let line = lines[edge];
                    if !edges[edge].contains(&end)
                        && (is_between(line, p) || is_near(line, p, tolerance))
                    {
                        between[edge].push(end);
                    }
                }
            });
        }
    }
    let chain = |([first, last], mut between): ([u32; 2], Vec<u32>)| {
        let way = at(last) - at(first);
        let along = |i: &u32| (at(*i) - at(first)).dot(way);
        between.sort_by(|a, b| along(a).total_cmp(&along(b)));
        std::iter::once(first).chain(between).chain(std::iter::once(last)).collect()
    };
    let mut chains: Vec<Chain> = alone
        .iter()
        .zip(edges.into_iter().zip(between).map(chain))
        .map(|(side, corners)| Chain { corners, is_forward: side.is_forward })
        .collect();
    keep_closing(&mut chains);
    let parted = chains.into_iter().map(|chain| chain.corners);
    parted.filter(|corners| corners.len() > 2).collect()
}

/// Independent sums of the coordinates of a line. Lines with different coordinates differ in most of them.
const SUMS: usize = 4;

/// Room in a sum, in tolerances: more than its largest change with the line.
const ROOM: f64 = 16.0;

/// The groups of two or more edges that may lie on one line, within a tolerance [m]. Along an edge that is parted lie
/// the edges that meet its parts; no other edge has to be compared with it.
fn on_one_line<const D: usize>(edges: &[[Point<D>; 2]], tolerance: f64) -> Vec<Vec<usize>> {
    let Some(around) = Aabb::around(edges.iter().flatten().copied()) else {
        return Vec::new();
    };
    let (centre, size) = (around.centre(), around.half_extents().norm());
    let tolerance = tolerance.max(ROOM * f64::EPSILON * (size + centre.norm()));
    let mut groups = vec![(0..edges.len()).collect::<Vec<_>>()];
    for sum in 0..SUMS {
        let interval = |edge: &usize| {
            let [a, b] = edges[*edge].map(|end| (end - centre).in_space());
            let length = (b - a).norm();
            let along = (b - a).normalized().unwrap_or(Vector::ZERO);
            // The point of the line next to the centre, and the direction, of either sign.
            let foot = a - along * a.dot(along);
            let [x, y, z] = along.0;
            let direction = [x * x, y * y, z * z, x * y, y * z, z * x].map(|x| x * size);
            let coordinates = foot.0.into_iter().chain(direction).enumerate();
            let middle: f64 = coordinates.map(|(i, x)| x * weight(9 * sum + i)).sum();
            let room = ROOM * tolerance * (1.0 + size / length);
            (middle - room, middle + room, *edge)
        };
        groups = groups
            .iter()
            .flat_map(|group| chained(group.iter().map(interval).collect()))
            .collect();
    }
    groups
}

/// The sets of two or more intervals that are connected by overlaps.
fn chained(mut intervals: Vec<(f64, f64, usize)>) -> Vec<Vec<usize>> {
    intervals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut groups, mut group, mut last) = (Vec::new(), Vec::new(), f64::NEG_INFINITY);
    for (from, to, edge) in intervals {
        if from > last {
            groups.push(std::mem::take(&mut group));
        }
        last = last.max(to);
        group.push(edge);
    }
    groups.push(group);
    groups.retain(|group| group.len() > 1);
    groups
}

/// The `i`-th of numbers from −1 to 1 that have no simple relation.
fn weight(i: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    2.0 * ((i + 1) as f64 * GOLDEN).fract() - 1.0
}

/// The corners along an edge of one element, from its lower end on.
struct Chain {
    corners: Vec<u32>,
    /// Whether the element passes the edge from the lower end on.
    is_forward: bool,
}

impl Chain {
    /// The parts of the edge, and the direction in which the element passes each: 1 from the lower corner to the
    /// higher, else −1.
    fn parts(&self) -> impl Iterator<Item = ([u32; 2], i64)> {
        self.corners.array_windows().map(|&[from, to]| {
            let is_forward = (from < to) == self.is_forward;
            (rim(from, to), if is_forward { 1 } else { -1 })
        })
    }
}

/// Takes the corners out of those chains of which a part meets no other part that is passed in the other direction.
fn keep_closing(chains: &mut [Chain]) {
    let mut surplus: HashMap<[u32; 2], i64> = HashMap::new();
    for (part, direction) in chains.iter().flat_map(Chain::parts) {
        *surplus.entry(part).or_default() += direction;
    }
    let mut is_changed = true;
    while is_changed {
        is_changed = false;
        for chain in chains.iter_mut().filter(|chain| chain.corners.len() > 2) {
            if chain.parts().all(|(part, _)| surplus[&part] == 0) {
                continue;
            }
            for (part, direction) in chain.parts() {
                *surplus.entry(part).or_default() -= direction;
            }
            chain.corners = vec![chain.corners[0], chain.corners[chain.corners.len() - 1]];
            for (whole, direction) in chain.parts() {
                *surplus.entry(whole).or_default() += direction;
            }
            is_changed = true;
        }
    }
}

/// Whether a point lies within a tolerance of the line between two others, and farther than that from both.
fn is_near<const D: usize>(ends: [Point<D>; 2], p: Point<D>, tolerance: f64) -> bool {
    tolerance > 0.0
        && from_segment(ends, p) <= tolerance
        && ends.iter().all(|end| (p - *end).norm() > tolerance)
}

/// How far a point is from a segment.
fn from_segment<const D: usize>([a, b]: [Point<D>; 2], p: Point<D>) -> f64 {
    let way = b - a;
    let share = ((p - a).dot(way) / way.dot(way)).clamp(0.0, 1.0);
    (p - a - way * share).norm()
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
        assert_eq!(part(&vertices, &mut elements, 0.0).edges, 2);
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
        assert_eq!(part(&vertices, &mut elements, 0.0).edges, 4);
        assert!(by_rim(&sides(&elements)).all(|at_rim| at_rim.len() == 2));
    }
}
