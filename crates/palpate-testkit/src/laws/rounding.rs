// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rounding is as small as promised.

use palpate_field::scalar::Scalar;
use palpate_field::{Point, Shape, Vector};

use crate::double::Double;
use crate::kernels::Space;
use crate::tree::{Solid, Tree};

/// The shape's value at `p` is within its promised rounding of the tree's
/// formula in twice the precision.
///
/// # Errors
///
/// Says the value, the error and the promise.
pub fn rounding_holds<const D: usize>(
    tree: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Result<(), String>
where
    Space: Solid<D>,
{
    let value = shape.distance(p);
    let precise = tree.distance(Vector(p.0.map(Double::constant)));
    let error = (Double::constant(value) - precise).to_f64().abs();
    let promised = super::rounding(shape, p);
    if error <= promised {
        return Ok(());
    }
    Err(format!(
        "{value:e} at {p:?} is off by {error:e}, {:.1} times the promised {promised:e}",
        error / promised
    ))
}

/// In single precision the value and the gradient are numbers, and the value is
/// off by at most twice the promised rounding, in units of single precision.
///
/// # Errors
///
/// Says the values in both precisions.
pub fn single_precision_holds<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
) -> Result<(), String> {
    let q = Vector(p.0.map(|x| x as f32));
    let exact = shape.distance(Vector(q.0.map(f64::from)));
    let value = shape.distance_f32(q);
    let (_, gradient) = shape.distance_gradient_f32(q);
    if !value.is_finite() || !gradient.0.iter().all(|x| x.is_finite()) {
        return Err(format!("{value:e} with gradient {gradient:?} at {q:?}"));
    }
    let promised = 2.0 * f64::from(f32::EPSILON) / f64::EPSILON * super::rounding(shape, p);
    let error = (f64::from(value) - exact).abs();
    if error <= promised {
        return Ok(());
    }
    Err(format!(
        "{value:e} in single precision at {q:?} is off by {error:e}, {:.1} times the \
         promised {promised:e}",
        error / promised
    ))
}
