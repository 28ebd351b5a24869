// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a shape has any point.

use palpate_field::{Point, Pose, Shape};

use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::pair::{PairWorkspace, overlap};
use crate::placed::Placed;

/// The box around a shape is grown by this share of its size, so that its own surface decides nothing.
const GROWN: f64 = 1e-3;

/// Whether a shape has any point, in [`Certified::is_hit`]: whether its field is zero or less
/// anywhere. The first shape of a difference may be gone with all that is cut away.
///
/// The question is whether the shape [overlaps](overlap) the box around it, which holds all of
/// its points.
///
/// ```
/// use palpate_field::Shape;
/// use palpate_query::{Limits, PairWorkspace, any_point};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut workspace = PairWorkspace::new();
/// let (large, small) = (Shape::sphere(0.03)?, Shape::sphere(0.02)?);
/// let mut has_points = |shape: &Shape<3>| {
///     any_point(shape, &Limits::new(1e-9), &mut workspace).map(|answer| answer.is_hit())
/// };
/// assert_eq!(has_points(&(&large - &small))?, Some(true));
/// assert_eq!(has_points(&(&small - &large))?, Some(false));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If the shape is not bounded, or the tolerance is NaN or out of range.
#[inline(never)]
pub fn any_point<const D: usize>(
    shape: &Shape<D>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Point<D>>, QueryError> {
    let Some(bounds) = shape.promise().bounds else { return Err(QueryError::Unbounded) };
    let size = bounds.aabb.half_extents().norm();
    // Far from the origin, rounding may leave the box itself without a volume.
    let rounding = shape.promise().rounding.within(bounds.aabb.radius_about_origin());
    let aabb = bounds.aabb.grown((GROWN * size).max(rounding));
    let around = Shape::cuboid(aabb.half_extents() * 2.0);
    let around = around.map_err(|_| QueryError::Length { value: size })?;
    let around = Placed::new(&around, Pose::translation(aabb.centre()));
    Ok(overlap(shape, around, limits, workspace)?.map(|nearest| nearest.point))
}
