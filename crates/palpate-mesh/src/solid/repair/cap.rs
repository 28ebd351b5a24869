// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Caps on holes, cut into triangles by ears.
//!
//! Long loops cut into triangles, in little more time than they have corners.
//!
//! Ears are cut (Meisters 1975) by exact predicates in the projection along the axis nearest to the loop's normal.
//! Three things keep it fast: an ear is compared with the corners that are not convex alone, and of those with the
//! ones near it, which a lattice tells; and no two neighbouring ears are cut on one way around, so that triangles
//! are as short as the loop allows and few of their boxes overlap.

use std::collections::HashMap;
use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Vector};
use robust::{Coord, orient2d};

use super::super::field::across;
use super::crossing::meet_in_the_plane;
use super::rims::{by_rim, sides};
use crate::mesh::{MOST_CORNERS, newell, triangulate};

/// An opening of a mesh: a loop of edges of one triangle each, or a gap between the ends of a chain of
/// segments.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Opening<const D: usize> {
    /// The middle of its corners [m].
    pub place: Point<D>,
    /// The longest side of the box around it [m].
    pub size: f64,
    /// How many edges it has; 1 in the plane.
    pub edges: usize,
    /// How far from its cap the sign may be a guess [m]: `√(A/2π)` of a cap of area A. Farther off, the cap takes less
    /// than half of the winding number, and the faces of the mesh decide. In the plane half its length.
    pub doubtful: f64,
}

/// The openings of a mesh, and what closes them.
#[derive(Debug, Default)]
pub(super) struct Caps<const D: usize> {
    pub(super) openings: Vec<Opening<D>>,
    /// Of each element that was added, the number of its opening.
    pub(super) of_element: Vec<usize>,
    /// Of each opening, whether its elements are known to meet at common corners and edges alone.
    pub(super) is_flat: Vec<bool>,
}

/// Closes all openings by caps, flat ones where the corners of the opening lie in a plane.
pub(super) fn close<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut Vec<[u32; N]>,
) -> Caps<D> {
    let mut caps = Caps::default();
    for corners in loops(elements) {
        let points: Vec<_> = corners.iter().map(|index| vertices[*index as usize]).collect();
        let Some(bounds) = Aabb::around(points.iter().copied()) else { continue };
        let size =
            bounds.half_extents().0.iter().fold(0.0_f64, |size, half| size.max(2.0 * half));
        let place =
            points.iter().fold(Vector::ZERO, |sum, p| sum + *p * (1.0 / points.len() as f64));
        let edges = if N == 2 { 1 } else { corners.len() };
        let count = elements.len();
        caps.is_flat.push(add(&corners, &points, elements));
        caps.of_element
            .resize(caps.of_element.len() + elements.len() - count, caps.openings.len());
        let area = |element: &[u32; N]| {
            0.5 * across(&element.map(|index| vertices[index as usize])).norm()
        };
        let doubtful = match N {
            2 => 0.5 * size,
            _ => (elements[count..].iter().map(area).sum::<f64>() / TAU).sqrt(),
        };
        caps.openings.push(Opening { place, size, edges, doubtful });
    }
    caps
}

/// Adds the elements that close a loop; whether they are known to meet at common corners and edges alone.
fn add<const N: usize, const D: usize>(
    corners: &[u32],
    points: &[Point<D>],
    elements: &mut Vec<[u32; N]>,
) -> bool {
    if N == 2 {
        // From the end of a chain to its start.
        elements.push(std::array::from_fn(|i| corners[i]));
        return false;
    }
    let in_space: Vec<Point<3>> = points.iter().map(|p| p.in_space()).collect();
    if corners.len() > MOST_CORNERS {
        let Cut { triangles, is_flat } = cut(&in_space);
        elements.extend(triangles.iter().map(|t| std::array::from_fn(|k| corners[t[k]])));
        return is_flat;
    }
    let numbers: Vec<u32> = (0..corners.len() as u32).collect();
    let mut triangles = Vec::new();
    triangulate(&numbers, &in_space, &mut triangles);
    elements.extend(triangles.iter().map(|t| std::array::from_fn(|k| corners[t[k] as usize])));
    false
}

/// The loops of the rims that elements pass more often in one direction, against it, as a cap passes them. The
/// boundary of elements has no boundary itself, so all edges go in loops. In the plane: the end and the start of
/// each chain.
pub(super) fn loops<const N: usize>(elements: &[[u32; N]]) -> Vec<Vec<u32>> {
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    for at_rim in by_rim(&sides(elements)) {
        let [low, high] = at_rim[0].rim;
        let forward = at_rim.iter().filter(|side| side.is_forward).count();
        let backward = at_rim.len() - forward;
        let (is_forward, surplus) = (forward > backward, forward.abs_diff(backward));
        for _ in 0..surplus {
            match (N, is_forward) {
                (2, true) => starts.push(low),
                (2, false) => ends.push(low),
                (_, true) => next.entry(high).or_default().push(low),
                (_, false) => next.entry(low).or_default().push(high),
            }
        }
    }
    if N == 2 { chains(elements, starts, ends) } else { closed(next) }
}

/// The loops of directed edges, of which as many end at each vertex as begin there.
fn closed(mut next: HashMap<u32, Vec<u32>>) -> Vec<Vec<u32>> {
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut found = Vec::new();
    for start in starts {
        let mut path = vec![start];
        let mut places = HashMap::from([(start, 0)]);
        while let Some(to) = path.last().and_then(|last| next.get_mut(last)?.pop()) {
            // Where the path meets itself, what lies between is a loop of its own.
            if let Some(at) = places.get(&to).copied() {
                let corners = path.split_off(at);
                for corner in &corners {
                    places.remove(corner);
                }
                found.push(corners);
            }
            places.insert(to, path.len());
            path.push(to);
        }
    }
    found.retain(|corners| corners.len() > 2);
    found
}

/// The end and the start of each chain of segments; of chains that cross, an end that is left.
fn chains<const N: usize>(
    elements: &[[u32; N]],
    starts: Vec<u32>,
    mut ends: Vec<u32>,
) -> Vec<Vec<u32>> {
    let after: HashMap<u32, u32> = elements.iter().map(|ends| (ends[0], ends[1])).collect();
    // How many chains end at each vertex and have no start yet.
    let mut left: HashMap<u32, usize> = HashMap::new();
    for end in &ends {
        *left.entry(*end).or_default() += 1;
    }
    let (mut found, mut without_end) = (Vec::new(), Vec::new());
    // Of each vertex that was passed, the number of the start from which it was; where each of those stopped.
    let mut passed: HashMap<u32, usize> = HashMap::new();
    let mut stops = Vec::new();
    for (number, start) in starts.into_iter().enumerate() {
        let (mut vertex, mut end, mut jumps) = (start, None, 0);
        while let Some(next) = after.get(&vertex) {
            vertex = *next;
            if let Some(count) = left.get_mut(&vertex).filter(|count| **count > 0) {
                *count -= 1;
                end = Some(vertex);
                break;
            }
            // What was passed before has no end up to where that stopped.
            match passed.insert(vertex, number) {
                Some(other) if other == number || jumps > number => break,
                Some(other) => (vertex, jumps) = (stops[other], jumps + 1),
                None => {}
            }
        }
        stops.push(vertex);
        match end {
            Some(end) => found.push(vec![end, start]),
            None => without_end.push(start),
        }
    }
    for start in without_end {
        while let Some(end) = ends.pop() {
            if let Some(count) = left.get_mut(&end).filter(|count| **count > 0) {
                *count -= 1;
                found.push(vec![end, start]);
                break;
            }
        }
    }
    found
}

/// The triangles of a loop, by the numbers of its corners, and what is known of them.
pub(super) struct Cut {
    pub(super) triangles: Vec<[usize; 3]>,
    /// Whether no two of them can meet but at common corners and edges: they lie beside each other in the
    /// projection.
    pub(super) is_flat: bool,
}

/// Cuts a loop of at least three corners. What is left when no ear is found, of a loop that crosses itself in the
/// projection, is closed by a strip from side to side.
pub(super) fn cut(corners: &[Point<3>]) -> Cut {
    let normal = newell(corners.iter().copied());
    let axis = (1..3).fold(0, |k, i| if normal[i].abs() > normal[k].abs() { i } else { k });
    let mut axes = [(axis + 1) % 3, (axis + 2) % 3];
    if normal[axis] < 0.0 {
        axes.swap(0, 1);
    }
    let flat: Vec<Point<2>> = corners.iter().map(|p| Vector(axes.map(|k| p[k]))).collect();
    let mut rest = Loop::new(&flat);
    let mut triangles = Vec::with_capacity(corners.len());
    let (mut at, mut since) = (0, 0);
    while rest.count > 3 && since <= rest.count {
        if rest.is_ear(at) {
            let [before, after] = [rest.before[at], rest.after[at]];
            triangles.push([before, at, after]);
            rest.remove(at);
            // Not the next one: it would make a fan of long triangles.
            (at, since) = (rest.after[after], 0);
        } else {
            (at, since) = (rest.after[at], since + 1);
        }
    }
    let left: Vec<usize> =
        std::iter::successors(Some(at), |i| Some(rest.after[*i])).take(rest.count).collect();
    let is_whole = left.len() == 3 && rest.turn(left[0], left[1], left[2]) > 0.0;
    triangles.extend(strip(&left));
    Cut { triangles, is_flat: is_whole && is_simple(&flat) }
}

/// Whether a loop meets itself nowhere.
fn is_simple(corners: &[Point<2>]) -> bool {
    let count = corners.len() as u32;
    let sides: Vec<[u32; 2]> = (0..count).map(|i| [i, (i + 1) % count]).collect();
    !meet_in_the_plane(corners, &sides)
}

/// Triangles between both sides of a chain of corners, from its first one to its middle one.
fn strip(corners: &[usize]) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(corners.len());
    let (mut low, mut high) = (0, corners.len() - 1);
    while low + 1 < high {
        let next = if triangles.len() % 2 == 0 { low + 1 } else { high - 1 };
        triangles.push([low, next, high].map(|i| corners[i]));
        if next == low + 1 {
            low = next;
        } else {
            high = next;
        }
    }
    triangles
}

/// What is left of a loop.
struct Loop<'a> {
    corners: &'a [Point<2>],
    before: Vec<usize>,
    after: Vec<usize>,
    count: usize,
    /// Of each corner, whether it is left and not convex. A convex corner stays convex.
    is_blunt: Vec<bool>,
    lattice: Lattice,
}

impl<'a> Loop<'a> {
    fn new(corners: &'a [Point<2>]) -> Self {
        let count = corners.len();
        let [before, after] =
            [count - 1, 1].map(|step| (0..count).map(move |i| (i + step) % count));
        let (before, after): (Vec<_>, Vec<_>) = (before.collect(), after.collect());
        let is_blunt: Vec<bool> =
            (0..count).map(|i| turn(corners, [before[i], i, after[i]]) <= 0.0).collect();
        let blunt: Vec<usize> = (0..count).filter(|i| is_blunt[*i]).collect();
        let lattice = Lattice::new(corners, &blunt);
        Self { corners, before, after, count, is_blunt, lattice }
    }

    fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        turn(self.corners, [a, b, c])
    }

    fn is_convex(&self, i: usize) -> bool {
        self.turn(self.before[i], i, self.after[i]) > 0.0
    }

    /// Whether a corner is convex and its triangle holds no other.
    fn is_ear(&self, i: usize) -> bool {
        if self.is_blunt[i] {
            return false;
        }
        let ear = [self.before[i], i, self.after[i]];
        let holds = |p: usize| {
            self.is_blunt[p]
                && !ear.contains(&p)
                && (0..3).all(|k| self.turn(ear[k], ear[(k + 1) % 3], p) >= 0.0)
        };
        !self.lattice.any_near(ear.map(|k| self.corners[k]), holds)
    }

    fn remove(&mut self, i: usize) {
        let (before, after) = (self.before[i], self.after[i]);
        (self.after[before], self.before[after]) = (after, before);
        self.count -= 1;
        for beside in [before, after] {
            self.is_blunt[beside] = self.is_blunt[beside] && !self.is_convex(beside);
        }
    }
}

/// Positive if three corners are counter-clockwise.
fn turn(corners: &[Point<2>], which: [usize; 3]) -> f64 {
    let [a, b, c] = which.map(|i| {
        let Vector([x, y]) = corners[i];
        Coord { x, y }
    });
    orient2d(a, b, c)
}

/// Corners by the squares of a lattice that they lie in.
struct Lattice {
    origin: Point<2>,
    /// Squares for a metre.
    scale: [f64; 2],
    /// Squares along each axis.
    count: usize,
    /// Where the corners of each square begin in `corners`, and where the last ones end.
    starts: Vec<usize>,
    corners: Vec<usize>,
}

impl Lattice {
    /// About as many squares as corners.
    fn new(corners: &[Point<2>], which: &[usize]) -> Self {
        let (mut min, mut max) = (corners[0], corners[0]);
        for p in corners {
            for k in 0..2 {
                (min[k], max[k]) = (min[k].min(p[k]), max[k].max(p[k]));
            }
        }
        let count = (which.len() as f64).sqrt().ceil().max(1.0);
        let scale = std::array::from_fn(|k| {
            let side = max[k] - min[k];
            if side > 0.0 { count / side } else { 0.0 }
        });
        let (starts, none) = (Vec::new(), Vec::new());
        let mut lattice =
            Self { origin: min, scale, count: count as usize, starts, corners: none };
        let mut placed: Vec<(usize, usize)> = which
            .iter()
            .map(|i| {
                let [x, y] = lattice.square(corners[*i]);
                (y * lattice.count + x, *i)
            })
            .collect();
        placed.sort_unstable();
        lattice.starts = (0..=lattice.count * lattice.count)
            .map(|square| placed.partition_point(|(at, _)| *at < square))
            .collect();
        lattice.corners = placed.into_iter().map(|(_, i)| i).collect();
        lattice
    }

    fn square(&self, p: Point<2>) -> [usize; 2] {
        // Rounding keeps the order of places, so that a corner in a triangle's box is found.
        std::array::from_fn(|k| {
            (((p[k] - self.origin[k]) * self.scale[k]) as usize).min(self.count - 1)
        })
    }

    /// Whether a corner in the squares around a triangle has a property.
    fn any_near(&self, triangle: [Point<2>; 3], mut has: impl FnMut(usize) -> bool) -> bool {
        let squares = triangle.map(|p| self.square(p));
        let range = |k: usize| {
            let along = squares.map(|square| square[k]);
            let [a, b, c] = along;
            (a.min(b).min(c), a.max(b).max(c))
        };
        let ((left, right), (low, high)) = (range(0), range(1));
        (low..=high).any(|y| {
            let row = y * self.count;
            let (from, to) = (self.starts[row + left], self.starts[row + right + 1]);
            self.corners[from..to].iter().any(|i| has(*i))
        })
    }
}

#[cfg(test)]
mod ears_tests {
    use super::*;

    fn area([a, b, c]: [Point<3>; 3]) -> f64 {
        0.5 * (b - a).cross(c - a)[2]
    }

    /// A star with many points, wavy along its edges: half of its corners are not convex.
    #[test]
    fn a_long_loop_is_cut_without_overlap() {
        let count = 3000_u32;
        let corners: Vec<Point<3>> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                let far = 2.0 + (17.0 * angle).sin() + 0.01 * f64::from(i % 2);
                Vector([far * angle.cos(), far * angle.sin(), 0.1 * angle.cos()])
            })
            .collect();
        let Cut { triangles, is_flat } = cut(&corners);
        assert!(is_flat);
        assert_eq!(triangles.len(), 2998);
        let areas: Vec<f64> = triangles.iter().map(|t| area(t.map(|i| corners[i]))).collect();
        assert!(areas.iter().all(|area| *area > 0.0));
        let shoelace: f64 = (0..corners.len())
            .map(|i| 0.5 * corners[i].cross(corners[(i + 1) % corners.len()])[2])
            .sum();
        // 3000 terms of at most 10 m², each rounded.
        assert!((areas.iter().sum::<f64>() - shoelace).abs() < 3000.0 * 10.0 * f64::EPSILON);
    }

    #[test]
    fn a_loop_that_crosses_itself_is_closed_and_known_to() {
        // Twice around, and each corner on another radius.
        let corners: Vec<Point<3>> = (0..41)
            .map(|i| (2.0 * std::f64::consts::TAU * f64::from(i) / 41.0, f64::from(i % 3)))
            .map(|(angle, far)| (angle, 1.0 + 0.1 * far))
            .map(|(angle, far)| Vector([far * angle.cos(), far * angle.sin(), 0.0]))
            .collect();
        let Cut { triangles, is_flat } = cut(&corners);
        assert_eq!((triangles.len(), is_flat), (39, false));
    }

    #[test]
    fn corners_on_straight_sides_are_kept() {
        // Four sides with 25 corners each.
        let corners: Vec<Point<3>> = (0..100_u32)
            .map(|i| {
                let along = f64::from(i % 25) / 25.0;
                let [x, y] = match i / 25 {
                    0 => [along, 0.0],
                    1 => [1.0, along],
                    2 => [1.0 - along, 1.0],
                    _ => [0.0, 1.0 - along],
                };
                Vector([x, y, 0.0])
            })
            .collect();
        let Cut { triangles, is_flat } = cut(&corners);
        assert!(is_flat);
        assert_eq!(triangles.len(), 98);
        assert!(triangles.iter().all(|t| area(t.map(|i| corners[i])) > 0.0));
    }
}
