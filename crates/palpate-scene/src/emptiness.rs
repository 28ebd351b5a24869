// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies without any point, such as a small ball minus a large one.

use palpate_field::Shape;
use palpate_query::{Limits, PairWorkspace, any_point};

/// Evaluations for each body: a point is found with a few, and most proofs take hundreds.
const BUDGET: u32 = 20_000;

/// The smallest part that counts as a point, as a share of the body's size.
const TOLERANCE: f64 = 1e-9;

/// Whether a shape is proven to have no point; `None` if none was found, and none is not proven.
/// Shapes without bounds, or without an inside, count as not empty.
#[must_use]
pub fn is_empty<const D: usize>(shape: &Shape<D>) -> Option<bool> {
    let promise = shape.promise();
    let Some(bounds) = promise.bounds.filter(|_| promise.has_interior) else {
        return Some(false);
    };
    let limits = Limits::new(TOLERANCE * bounds.aabb.half_extents().norm()).with_budget(BUDGET);
    let answer = any_point(shape, &limits, &mut PairWorkspace::new());
    answer.map_or(Some(false), |answer| answer.is_hit().map(|has_points| !has_points))
}
