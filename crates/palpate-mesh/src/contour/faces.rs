// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces between the vertices of neighbouring cells.

use std::collections::HashMap;

use palpate_field::{Point, Shape};

use super::cells::Signed;
use super::patches::{EDGES, ends, is_crossed};
use crate::report::is_flat;

/// The four cells around an edge, by the sides of the edge in them along the two axes after its own:
/// counter-clockwise, seen from the edge's end.
const AROUND: [[usize; 2]; 4] = [[1, 1], [0, 1], [0, 0], [1, 0]];

/// A triangle of at most this height, as a share of its largest coordinate, is not made where that can be avoided.
const FLAT: f64 = 1e-7;

/// The vertices around each crossing, counter-clockwise seen from outside; `of_edges` has the vertex of each edge
/// of each cell.
pub(super) fn quads(signed: &[Signed], of_edges: &[[u32; EDGES]]) -> Vec<[u32; 4]> {
    let mut found: Vec<[u32; 4]> = Vec::new();
    let mut places: HashMap<[u32; 4], usize> = HashMap::new();
    for (cell, of_edge) in signed.iter().zip(of_edges) {
        for edge in (0..EDGES).filter(|edge| is_crossed(cell.inside, *edge)) {
            let place = *places.entry(cell.edge(edge)).or_insert_with(|| {
                found.push([u32::MAX; 4]);
                found.len() - 1
            });
            let sides = [edge & 1, (edge >> 1) & 1];
            let Some(around) = AROUND.iter().position(|around| *around == sides) else {
                continue;
            };
            // From inside to outside along the edge, or the other way.
            let is_out = (cell.inside >> ends(edge)[0]) & 1 == 1;
            found[place][if is_out { around } else { 3 - around }] = of_edge[edge];
        }
    }
    // The lattice reaches beyond the shape, so all four cells are there.
    found.retain(|quad| !quad.contains(&u32::MAX));
    found
}

/// Two triangles for each four vertices, cut where the cut lies nearer to the surface.
pub(super) fn triangles(
    shape: &Shape<3>,
    places: &[Point<3>],
    quads: &[[u32; 4]],
) -> Vec<[u32; 3]> {
    let place = |vertex: u32| places[vertex as usize];
    let off = |a: u32, b: u32| shape.distance((place(a) + place(b)) * 0.5).abs();
    // Three vertices along a sharp edge make no triangle.
    let are_flat =
        |halves: &[[u32; 3]; 2]| halves.iter().any(|half| is_flat(&half.map(place), FLAT));
    let cut = |&[a, b, c, d]: &[u32; 4]| {
        let ways = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
        match [are_flat(&ways[0]), are_flat(&ways[1])] {
            [true, false] => ways[1],
            [false, true] => ways[0],
            _ => ways[usize::from(off(a, c) > off(b, d))],
        }
    };
    quads.iter().flat_map(cut).collect()
}
