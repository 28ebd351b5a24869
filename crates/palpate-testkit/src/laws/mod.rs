// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What every field must obey, whatever its formula.
//!
//! Each law looks at one shape and one point, and says what is wrong.

mod bits;
mod gradient;
mod model;
mod promise;
mod rounding;

pub use bits::bits_agree;
pub use gradient::{gradient_is_bounded, gradient_is_the_slope};
pub use model::{Cell, convex_models_are_tight, model_encloses};
pub use promise::{
    bounds_hold, convex_where_promised, lipschitz_holds, never_overclaims,
    symmetric_where_promised,
};
pub use rounding::{rounding_holds, single_precision_holds};

use palpate_field::{Point, Shape};

/// The absolute error of a value at `p` [m].
#[must_use]
pub fn rounding<const D: usize>(shape: &Shape<D>, p: Point<D>) -> f64 {
    shape.promise().rounding.within(p.norm())
}
