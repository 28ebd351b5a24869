// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Openings, and the caps that close them.

use std::collections::HashMap;

use palpate_field::{Aabb, Point, Vector};

use super::rims::{by_rim, sides};
use crate::polygon::{MOST_CORNERS, triangulate};

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
}

/// Closes all openings by flat caps, and tells them. A loop of more corners than can be cut is closed by a
/// strip from side to side.
pub(super) fn close<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut Vec<[u32; N]>,
) -> Vec<Opening<D>> {
    let mut openings = Vec::new();
    for corners in loops(elements) {
        let points: Vec<_> = corners.iter().map(|index| vertices[*index as usize]).collect();
        let Some(bounds) = Aabb::around(points.iter().copied()) else { continue };
        let size =
            bounds.half_extents().0.iter().fold(0.0_f64, |size, half| size.max(2.0 * half));
        let place =
            points.iter().fold(Vector::ZERO, |sum, p| sum + *p * (1.0 / points.len() as f64));
        openings.push(Opening { place, size, edges: if N == 2 { 1 } else { corners.len() } });
        if N == 2 {
            // From the end of the chain to its start.
            elements.push(std::array::from_fn(|i| corners[i]));
            continue;
        }
        if corners.len() > MOST_CORNERS {
            elements.extend(strip(&corners));
            continue;
        }
        let in_space: Vec<Point<3>> = points.iter().map(|p| p.in_space()).collect();
        let numbers: Vec<u32> = (0..corners.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&numbers, &in_space, &mut triangles);
        elements
            .extend(triangles.iter().map(|t| std::array::from_fn(|k| corners[t[k] as usize])));
    }
    openings
}

/// Triangles between both sides of a loop, from its first corner to its middle one.
fn strip<const N: usize>(corners: &[u32]) -> Vec<[u32; N]> {
    let mut triangles = Vec::with_capacity(corners.len());
    let (mut low, mut high) = (0, corners.len() - 1);
    while low + 1 < high {
        let next = if triangles.len() % 2 == 0 { low + 1 } else { high - 1 };
        let triangle = [low, next, high].map(|i| corners[i]);
        triangles.push(std::array::from_fn(|k| triangle[k]));
        if next == low + 1 {
            low = next;
        } else {
            high = next;
        }
    }
    triangles
}

/// The loops of the rims that elements pass more often in one direction, against it, as a cap passes them. The
/// boundary of elements has no boundary itself, so all edges go in loops. In the plane: the end and the start of
/// each chain.
fn loops<const N: usize>(elements: &[[u32; N]]) -> Vec<Vec<u32>> {
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
    let mut found = Vec::new();
    for start in starts {
        let mut vertex = start;
        let mut place = None;
        for _ in 0..elements.len() {
            let Some(next) = after.get(&vertex) else { break };
            vertex = *next;
            place = ends.iter().position(|end| *end == vertex);
            if place.is_some() {
                break;
            }
        }
        if let Some(place) = place.or(ends.len().checked_sub(1)) {
            found.push(vec![ends.swap_remove(place), start]);
        }
    }
    found
}
