// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces that do not bound the solid: it is on both of their sides, or on neither.
//!
//! On each side of a piece that nothing crosses or touches, the winding number is the same all over. So the winding
//! numbers on both sides of one face tell whether the piece is surface.

use palpate_field::{Point, Vector};

use super::foot::across;
use super::winding::{Winding, WindingTree, share};

/// So many faces of a piece must agree, the largest first.
const SAMPLES: usize = 3;

/// What the pieces are to the solid.
#[derive(Debug, Default)]
pub(super) struct Walls {
    /// Of each face, whether it does not bound the solid.
    pub(super) is_wall: Vec<bool>,
    /// Whether it is known of all faces whether they bound the solid.
    pub(super) are_all_known: bool,
    /// Whether the winding number is negative beside one of the pieces of which this is known.
    pub(super) has_negative: bool,
}

impl Walls {
    /// Where all faces bound the solid.
    pub(super) fn none(faces: usize) -> Self {
        Self { is_wall: vec![false; faces], are_all_known: true, has_negative: false }
    }
}

/// Of faces in the order of the tree, each with the number of its piece and whether it crosses or touches another.
pub(super) fn find<const N: usize, const D: usize>(
    faces: &[[Point<D>; N]],
    tree: &WindingTree<N, D>,
    of_piece: &[usize],
    is_met: &[bool],
) -> Walls {
    let count = of_piece.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    let mut is_free = vec![true; count];
    for (face, piece) in of_piece.iter().enumerate() {
        members[*piece].push(face);
        is_free[*piece] &= !is_met[face];
    }
    let mut walls = Walls::none(faces.len());
    for (members, is_free) in members.into_iter().zip(is_free) {
        let within = is_free.then(|| within(faces, tree, &members)).flatten();
        match within {
            None => walls.are_all_known = false,
            // Outside it is one less.
            Some(within) => {
                walls.has_negative |= within < 1.0;
                if within != 1.0 {
                    members.iter().for_each(|face| walls.is_wall[*face] = true);
                }
            }
        }
    }
    walls
}

/// The winding number behind the faces of a piece; `None` if it is not the same behind all that are looked at.
fn within<const N: usize, const D: usize>(
    faces: &[[Point<D>; N]],
    tree: &WindingTree<N, D>,
    members: &[usize],
) -> Option<f64> {
    let mut by_area: Vec<(f64, usize)> =
        members.iter().map(|face| (across(&faces[*face]).norm(), *face)).collect();
    let largest = by_area.len().min(SAMPLES);
    by_area.select_nth_unstable_by(largest - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let behind = |(_, face): &(f64, usize)| {
        let corners = &faces[*face];
        let p =
            corners.iter().fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64));
        // What all others sum up to is half a turn less than it is behind the face, a whole number, of which there
        // must be no other within the error.
        let own = share(corners, p);
        let behind = |w: Winding| w.number - own + 0.5;
        let is_settled =
            |w: Winding| w.error < 0.4 && (behind(w) - behind(w).round()).abs() + w.error < 0.8;
        let sum = tree.settled(faces, p, is_settled);
        is_settled(sum).then_some(behind(sum).round())
    };
    let mut found = by_area[..largest].iter().map(behind);
    let first = found.next()??;
    found.all(|other| other == Some(first)).then_some(first)
}
