// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parts between the nodes of cells: all corners of a cell are outside, and a point in it is inside, or the reverse.

use palpate_field::{Aabb, Point, Shape};

/// Steps towards the surface, and beyond it.
const STEPS: usize = 12;

/// A value that counts as the surface, as a share of the side of a cell.
const NEAR: f64 = 1e-6;

/// Looks for a point of a cell that is inside while all its corners are outside, or the reverse, by a few steps along the
/// gradient from its middle.
pub(super) fn beyond(shape: &Shape<3>, around: &Aabb<3>, is_inside: bool) -> Option<Point<3>> {
    let side = around.max[0] - around.min[0];
    let sign = if is_inside { -1.0 } else { 1.0 };
    let mut point = (around.min + around.max) * 0.5;
    // To the surface first: one step, if the field is a distance.
    for _ in 0..STEPS {
        let (value, gradient) = shape.distance_gradient(point);
        let (height, square) = (sign * value, gradient.dot(gradient));
        if height < 0.0 {
            return Some(point);
        }
        let is_slope = square > 0.0 && square.is_finite() && value.is_finite();
        if !is_slope {
            return None;
        }
        if height <= NEAR * side {
            let inwards = gradient * (-sign / square.sqrt());
            // How deep the part is, is not known.
            return (1..=STEPS as i32)
                .map(|step| point + inwards * (side * 0.5_f64.powi(step)))
                .find(|deep| around.contains(*deep) && sign * shape.distance(*deep) < 0.0);
        }
        point -= gradient * (value / square);
        if !around.contains(point) {
            return None;
        }
    }
    None
}
