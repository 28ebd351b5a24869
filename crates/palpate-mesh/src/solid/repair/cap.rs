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

/// Closes all openings by flat caps, as far as their edges go in loops, and tells them. A loop of more corners
/// than can be cut is closed by a fan about its middle.
pub(super) fn close<const N: usize, const D: usize>(
    vertices: &mut Vec<Point<D>>,
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
            let middle = vertices.len() as u32;
            vertices.push(place);
            for i in 0..corners.len() {
                let triangle = [corners[i], corners[(i + 1) % corners.len()], middle];
                elements.push(std::array::from_fn(|k| triangle[k]));
            }
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

/// The loops of the rims of one element each, in the direction in which a cap passes them; in the plane the
/// end and the start of each chain.
fn loops<const N: usize>(elements: &[[u32; N]]) -> Vec<Vec<u32>> {
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut starts = Vec::new();
    let mut ends = HashMap::new();
    let sides = sides(elements);
    for at_rim in by_rim(&sides) {
        let [side] = at_rim else { continue };
        let [low, high] = side.rim;
        if N == 2 {
            if side.is_forward {
                starts.push(low);
            } else {
                ends.insert(low, side.element);
            }
            continue;
        }
        // Against the triangle.
        let (from, to) = if side.is_forward { (high, low) } else { (low, high) };
        next.entry(from).or_default().push(to);
        starts.push(from);
    }
    if N == 2 {
        return chains(elements, &starts, &ends);
    }
    let mut found = Vec::new();
    for start in starts {
        let mut path = vec![start];
        while let Some(to) = path.last().and_then(|last| next.get_mut(last)?.pop()) {
            // Where the path meets itself, what lies between is a loop of its own.
            if let Some(at) = path.iter().position(|vertex| *vertex == to) {
                found.push(path.split_off(at));
                path.push(to);
            } else {
                path.push(to);
            }
        }
    }
    found.retain(|corners| corners.len() > 2);
    found
}

/// The end and the start of each chain of segments.
fn chains<const N: usize>(
    elements: &[[u32; N]],
    starts: &[u32],
    ends: &HashMap<u32, u32>,
) -> Vec<Vec<u32>> {
    let after: HashMap<u32, u32> = elements.iter().map(|ends| (ends[0], ends[1])).collect();
    let mut found = Vec::new();
    for start in starts {
        let (mut vertex, mut steps) = (*start, 0);
        while let Some(next) = after.get(&vertex) {
            vertex = *next;
            steps += 1;
            if ends.contains_key(&vertex) || steps > elements.len() {
                break;
            }
        }
        if ends.contains_key(&vertex) {
            found.push(vec![vertex, *start]);
        }
    }
    found
}
