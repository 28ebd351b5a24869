// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cuts a path in space by a slice: near it, in front of it, behind it.

use palpate::field::Vector;
use palpate::plot::Slice;

/// Pieces of a line, in plane coordinates [m].
pub(super) type Pieces = Vec<Vec<[f64; 2]>>;

/// The pieces of a line, by the side of the slice on which they lie.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Seen {
    pub(super) near: Pieces,
    pub(super) in_front: Pieces,
    pub(super) behind: Pieces,
}

/// Where a point lies for the viewer of a slice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Near,
    InFront,
    Behind,
}

/// The side of `plane` on which `point` lies; `near` [m] is the largest distance that counts as
/// near.
pub(super) fn side(plane: &Slice, near: f64, point: Vector<f64, 3>) -> Side {
    let elevation = plane.elevation(point.0);
    if elevation.abs() <= near {
        Side::Near
    } else if elevation > 0.0 {
        Side::InFront
    } else {
        Side::Behind
    }
}

/// Takes the line through `points` apart. Each piece begins where the one before ends, so there
/// are no gaps.
pub(super) fn taken_apart(
    plane: &Slice,
    near: f64,
    points: impl IntoIterator<Item = Vector<f64, 3>>,
) -> Seen {
    let mut seen = Seen::default();
    let mut last: Option<(Side, [f64; 2])> = None;
    for point in points {
        let (side, here) = (side(plane, near, point), plane.project(point.0));
        let pieces = match side {
            Side::Near => &mut seen.near,
            Side::InFront => &mut seen.in_front,
            Side::Behind => &mut seen.behind,
        };
        match (pieces.last_mut(), last) {
            (Some(piece), Some((before, _))) if before == side => piece.push(here),
            (_, Some((_, there))) => pieces.push(vec![there, here]),
            (_, None) => pieces.push(vec![here]),
        }
        last = Some((side, here));
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_taken_apart_without_gaps() {
        let plane = Slice::xy(1.0).unwrap();
        let heights = [1.0, 1.1, 1.3, 1.2, 0.95, 0.5, 1.5];
        let points = (0..7).zip(heights).map(|(i, z)| Vector([f64::from(i), 5.0, z]));
        let seen = taken_apart(&plane, 0.15, points);
        let piece = |from: i32, to: i32| -> Vec<[f64; 2]> {
            (from..=to).map(|i| [f64::from(i), 5.0]).collect()
        };
        assert_eq!(seen.near, [piece(0, 1), piece(3, 4)]);
        assert_eq!(seen.in_front, [piece(1, 3), piece(5, 6)]);
        assert_eq!(seen.behind, [piece(4, 5)]);
    }

    #[test]
    fn sides_are_those_of_the_viewer() {
        // A slice across x is seen from −x.
        let plane = Slice::yz(0.5).unwrap();
        let at = |x: f64| side(&plane, 0.1, Vector([x, 2.0, 3.0]));
        assert_eq!([at(0.45), at(0.3), at(0.7)], [Side::Near, Side::InFront, Side::Behind]);
    }

    #[test]
    fn in_the_plane_all_is_near() {
        let points = [Vector([1.0, 2.0, 0.0]), Vector([3.0, -4.0, 0.0])];
        let seen = taken_apart(&Slice::planar(), f64::INFINITY, points);
        assert_eq!(seen.near, [vec![[1.0, 2.0], [3.0, -4.0]]]);
        assert!(seen.in_front.is_empty() && seen.behind.is_empty());
    }
}
