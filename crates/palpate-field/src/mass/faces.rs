// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Polyhedra and polygons: sums over their faces.

use super::{Moments, Total};
use crate::vector::{Point, Vector};

/// Rounded operations of the volume of one simplex.
const OPERATIONS: f64 = 32.0;

impl<const D: usize> Total<D> {
    /// Adds the simplex of a face and the middle, negative if the middle is on the face's outer side. The corners may
    /// be off by `slack` [m], and `faces` are added in all.
    pub(super) fn take_face(
        &mut self,
        face: &[Point<D>; D],
        middle: &[f64; D],
        (slack, faces): (f64, usize),
    ) {
        let corners = face.map(|corner| corner - Vector(*middle));
        let mut cells = 1.0;
        for i in 2..=D {
            cells *= i as f64;
        }
        let volume = corners[0].dot(Vector::across(face)) / cells;
        let mut sum = [0.0; D];
        for (i, sum) in sum.iter_mut().enumerate() {
            *sum = corners.iter().map(|corner| corner[i]).sum();
        }
        let products =
            |i: usize, k: usize| corners.iter().map(|corner| corner[i] * corner[k]).sum();
        let moments = Moments::of_corners((D + 1) as f64, volume, &sum, products);
        let longest = face.iter().fold(0.0_f64, |longest, corner| {
            longest.max((*corner - face[0]).norm()).max((*corner - face[D - 1]).norm())
        });
        let farthest = corners.iter().fold(0.0_f64, |far, corner| far.max(corner.norm()));
        // Of the determinant, and of a sum of so many terms.
        let rounding = (OPERATIONS + faces as f64) * f64::EPSILON;
        let across = |reach: f64| reach.powi(D as i32 - 1);
        let rounded = rounding * farthest * across(longest);
        // What the face sweeps if its corners move.
        let swept = slack * across(longest + 2.0 * slack);
        self.add(&moments, 2.0 * (rounded + swept), farthest + slack);
    }
}
