// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Openings, and the caps that close them.

use std::collections::HashMap;
use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Vector};

use super::ears::{Cut, cut};
use super::rims::{by_rim, sides};
use crate::polygon::{MOST_CORNERS, triangulate};
use crate::solid::foot::across;

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
