// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The border of the inside, closed along the edge of the lattice.

use super::{Lattice, Zeros};
use crate::chain::chains;
use crate::geometry::Point;

/// A node of a ring on the edge of the lattice.
struct Mark {
    /// How far it lies from the lower left corner, counter-clockwise [m].
    way: f64,
    node: usize,
    is_crossing: bool,
}

/// Closes `walls`, lines between the changes of sign `zeros`, where they leave the lattice: along
/// those parts of its edge that lie inside. Rings in plane coordinates [m].
pub(super) fn close(
    lattice: &Lattice,
    zeros: &Zeros,
    walls: &[[usize; 2]],
    corner_is_inside: bool,
) -> Vec<Vec<Point>> {
    let [across, up] = lattice.count;
    let corners = [[0, 0], [across, 0], [across, up], [0, up]].map(|at| lattice.corner(at));
    let (low, high) = (corners[0], corners[2]);
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    let mut places = zeros.places.clone();
    let starts = [0.0, width, width + height, 2.0 * width + height];
    let corner = |k: usize| Mark { way: starts[k], node: places.len() + k, is_crossing: false };
    let mut marks: Vec<Mark> = (0..4).map(corner).collect();
    for (node, (edge, [x, y])) in zeros.edges.iter().zip(&zeros.places).enumerate() {
        let way = match edge.axis {
            0 if edge.at[1] == 0 => x - low[0],
            1 if edge.at[0] == across => starts[1] + y - low[1],
            0 if edge.at[1] == up => starts[2] + high[0] - x,
            1 if edge.at[0] == 0 => starts[3] + high[1] - y,
            _ => continue,
        };
        marks.push(Mark { way, node, is_crossing: true });
    }
    marks.sort_by(|a, b| a.way.total_cmp(&b.way));
    let mut is_inside = corner_is_inside;
    let mut borders = walls.to_vec();
    for (k, mark) in marks.iter().enumerate() {
        is_inside ^= mark.is_crossing;
        if is_inside {
            borders.push([mark.node, marks[(k + 1) % marks.len()].node]);
        }
    }
    places.extend(corners);
    let place = |ring: Vec<usize>| ring.into_iter().map(|node| places[node]).collect();
    chains(&borders).into_iter().map(place).collect()
}
