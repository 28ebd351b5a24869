// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sheets: what bounds no solid, since its openings are as large as it is.

use std::collections::HashMap;

use palpate_field::{Point, Vector};

use super::has_same_direction;
use super::rims::pieces;
use crate::solid::foot::across;
use crate::solid::winding::Groups;

/// What has caps larger than this share of its faces is a sheet.
const SHEET: f64 = 0.9;

/// Of each element of a closed mesh, whether it is of a membrane: a sheet within the solid of all that are none, or a
/// face and the cap that mirrors it; `None` if the whole is a sheet. `caps` tells of each element the opening that it closes.
///
/// A sheet that lies elsewhere stays, and what closes it: it may be all there is of a wing.
pub(super) fn membranes<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    caps: &[Option<usize>],
) -> Option<Vec<bool>> {
    let corners = |element: &[u32; N]| element.map(|index| vertices[index as usize]);
    let (of_element, count) = pieces(vertices, elements);
    // Of each piece, the area of its faces and of its caps [m²], twice; in the plane the lengths [m].
    let mut areas = vec![[0.0; 2]; count];
    for ((element, piece), cap) in elements.iter().zip(&of_element).zip(caps) {
        areas[*piece][usize::from(cap.is_some())] += across(&corners(element)).norm();
    }
    let is_sheet = |[own, caps]: &[f64; 2]| *caps > SHEET * own;
    if is_sheet(&areas.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])) {
        return None;
    }
    let mut is_membrane: Vec<bool> = areas.iter().map(is_sheet).collect();
    if is_membrane.contains(&true) {
        let with_pieces = || elements.iter().zip(&of_element).zip(caps);
        let rest: Vec<_> = with_pieces()
            .filter(|((_, piece), _)| !is_membrane[**piece])
            .map(|((element, _), _)| corners(element))
            .collect();
        let rest = Groups::new(&rest);
        for ((element, piece), cap) in with_pieces() {
            if is_membrane[*piece] && cap.is_none() {
                let middle = corners(element)
                    .iter()
                    .fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64));
                is_membrane[*piece] = rest.goes_around(middle);
            }
        }
    }
    let is_mirrored = mirrored(elements);
    let with_pieces = of_element.iter().zip(is_mirrored);
    Some(with_pieces.map(|(piece, is_mirrored)| is_mirrored || is_membrane[*piece]).collect())
}

/// Of each element, whether another with the same vertices faces it, as a cap the one face that it closes: between
/// the two is nothing.
fn mirrored<const N: usize>(elements: &[[u32; N]]) -> Vec<bool> {
    // Of each set of vertices, those elements that pass them in either direction and have found none that faces them.
    let mut waiting: HashMap<[u32; N], [Vec<usize>; 2]> = HashMap::new();
    let mut is_mirrored = vec![false; elements.len()];
    for (i, element) in elements.iter().enumerate() {
        let mut key = *element;
        key.sort_unstable();
        let way = usize::from(has_same_direction(element, key));
        let waiting = waiting.entry(key).or_default();
        if let Some(other) = waiting[1 - way].pop() {
            (is_mirrored[i], is_mirrored[other]) = (true, true);
        } else {
            waiting[way].push(i);
        }
    }
    is_mirrored
}
