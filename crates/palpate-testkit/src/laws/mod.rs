// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Laws that every field must obey, whatever its formula. Most check one shape at one point;
//! each says what is wrong.

mod bits;
mod dual;
mod gradient;
mod model;
mod motion;
mod promise;
mod rounding;

pub use bits::bits_agree;
pub use dual::GradientIsTheDual;
pub use gradient::{gradient_is_bounded, gradient_is_the_slope};
pub use model::{
    Cell, convex_models_are_tight, model_encloses, model_says_as_much_as_the_steepness, models,
};
pub use motion::{motion_keeps_distances, scale_scales_distances};
pub use promise::{
    bounds_hold, convex_where_promised, lipschitz_holds, never_overclaims,
    symmetric_where_promised,
};
pub use rounding::{rounding_holds, single_precision_holds};

use palpate_field::{Point, Shape, Vector};

/// The absolute error of a value at `p` [m].
#[must_use]
pub fn rounding<const D: usize>(shape: &Shape<D>, p: Point<D>) -> f64 {
    shape.promise().rounding.within(p.norm())
}

/// `true` if `error` is larger than `allowed`, or no number.
pub(crate) fn exceeds(error: f64, allowed: f64) -> bool {
    error.is_nan() || error > allowed
}

/// Gradients at points `step` from `p` may differ this much from that at `p` if the
/// field is smooth there.
const SMOOTH: f64 = 1e-5;

/// `true` if the gradient is nearly the same at all points `step` [m] from `p` along the axes
/// and diagonals, so that no kink is near.
#[must_use]
pub fn smooth_at<const D: usize>(shape: &Shape<D>, p: Point<D>, step: f64) -> bool {
    let (_, g) = shape.distance_gradient(p);
    // Each number in base 3 is a direction: −1, 0 or 1 along each axis.
    (0..3_usize.pow(D as u32)).all(|number| {
        let offset: Vector<f64, D> = Vector(std::array::from_fn(|axis| {
            step * ((number / 3_usize.pow(axis as u32) % 3) as f64 - 1.0)
        }));
        (shape.distance_gradient(p + offset).1 - g).norm() <= SMOOTH
    })
}
