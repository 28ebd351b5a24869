// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid motions and uniform scales change a field as they change space.

use palpate_field::{Point, Pose, Shape, ShapeError, Vector};

use super::{exceeds, rounding, smooth_at};

/// The largest difference of corresponding gradients where the field is smooth.
const GRADIENT: f64 = 1e-4;

/// Moving the shape by `pose` moves its values and turns its gradients.
///
/// # Errors
///
/// Says what differs, and by how much.
pub fn motion_keeps_distances<const D: usize>(
    shape: &Shape<D>,
    pose: &Pose<D>,
    p: Point<D>,
) -> Result<(), String> {
    let moved = shape.clone().placed(pose).map_err(|error| error.to_string())?;
    let q = pose.transform_point(p);
    let turn = |g| pose.transform_vector(g);
    corresponds("moved", shape, p, (&moved, q, 1.0), turn)
}

/// Scaling the shape by `factor` scales its values and keeps its gradients. Passes shapes that
/// are nested too deeply to be scaled.
///
/// # Errors
///
/// Says what differs, and by how much.
pub fn scale_scales_distances<const D: usize>(
    shape: &Shape<D>,
    factor: f64,
    p: Point<D>,
) -> Result<(), String> {
    match shape.clone().scaled(factor) {
        Ok(scaled) => {
            corresponds("scaled", shape, p, (&scaled, p * factor, factor), |gradient| gradient)
        }
        Err(ShapeError::TooDeep { .. }) => Ok(()),
        Err(error) => Err(error.to_string()),
    }
}

/// `image` has at its point `factor` times the value of `shape` at `p`, and `turn` of
/// its gradient.
fn corresponds<const D: usize>(
    what: &str,
    shape: &Shape<D>,
    p: Point<D>,
    image: (&Shape<D>, Point<D>, f64),
    turn: impl Fn(Vector<f64, D>) -> Vector<f64, D>,
) -> Result<(), String> {
    let (image, q, factor) = image;
    let (f, g) = shape.distance_gradient(p);
    let (image_f, image_g) = image.distance_gradient(q);
    // The point itself is rounded too.
    let point = 8.0 * f64::EPSILON * q.norm() * shape.promise().lipschitz;
    let slack = factor * rounding(shape, p) + rounding(image, q) + point;
    let apart = (image_f - factor * f).abs();
    if exceeds(apart, slack) {
        return Err(format!(
            "{image_f:e} {what}, {factor} times {f:e} before, {apart:e} apart (allowed \
             {slack:e}) at {p:?}"
        ));
    }
    let turned = turn(g);
    // The error of the distance to the nearest kink.
    let blur = slack / factor + 1e-9 * (p.norm() + f.abs());
    if (image_g - turned).norm() > GRADIENT && smooth_at(shape, p, blur) {
        return Err(format!("gradient {image_g:?} {what}, {turned:?} expected, at {p:?}"));
    }
    Ok(())
}
