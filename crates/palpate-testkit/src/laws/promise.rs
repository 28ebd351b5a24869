// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Promises never overclaim.

use palpate_field::{Aabb, Point, Quality, Shape, Vector};

use super::{exceeds, rounding};

/// The rounding of points in the laws themselves, relative to coordinates.
const POINT: f64 = 8.0 * f64::EPSILON;

/// Steps of the search for a surface inside a ball that is promised to be free.
const STEPS: usize = 12;

/// No surface lies within the radius that a value promises, and where the value
/// is exact, a surface lies at it.
///
/// `directions` are unit vectors to search along, besides the gradient.
///
/// # Errors
///
/// Says where the surface is and what was promised.
pub fn never_overclaims<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
    directions: &[Vector<f64, D>],
) -> Result<(), String> {
    let promise = shape.promise();
    let (f, g) = shape.distance_gradient(p);
    let quality = if f < 0.0 { promise.inside } else { promise.outside };
    let slack = rounding(shape, p) + POINT * (p.norm() + f.abs());
    let free = promise.safe_radius(p, f) - slack;
    if free > 0.0 {
        let towards = -f.signum();
        let starts = directions.iter().copied().chain([g * towards, g * -towards]);
        for start in starts {
            if let Some(q) = surface_within(shape, p, free, start) {
                return Err(format!(
                    "{quality:?} value {f:e} at {p:?}, but at {q:?}, {:e} away, it is {:e} \
                     (rounding {slack:e})",
                    (q - p).norm(),
                    shape.distance(q),
                ));
            }
        }
    }
    if quality == Quality::Exact && promise.region.is_none() {
        let q = p - g * f;
        let landed = shape.distance(q);
        let slack = 4.0 * (slack + rounding(shape, q)) + 32.0 * f64::EPSILON * f.abs();
        if exceeds(landed.abs(), slack) {
            return Err(format!(
                "exact value {f:e} at {p:?} with gradient {g:?}, but the surface is not \
                 there: {landed:e} (allowed {slack:e})"
            ));
        }
    }
    Ok(())
}

/// A point within `radius` of `p` on the other side of the surface, looked for
/// along `direction` and then downhill.
fn surface_within<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
    radius: f64,
    direction: Vector<f64, D>,
) -> Option<Point<D>> {
    let sign = if shape.distance(p) < 0.0 { -1.0 } else { 1.0 };
    let mut q = p + direction * (0.999 * radius);
    for _ in 0..STEPS {
        let (f, g) = shape.distance_gradient(q);
        // More than rounding, which may flip the sign on the surface.
        if sign * f < -rounding(shape, q) && (q - p).norm() < radius {
            return Some(q);
        }
        q -= g * (1.01 * f);
        let away = q - p;
        let distance = away.norm();
        if distance > radius {
            q = p + away * (0.999 * radius / distance);
        }
    }
    None
}

/// Values at `p` and `q` differ by at most the Lipschitz constant times their
/// distance.
///
/// # Errors
///
/// Says the values and the steepness between them.
pub fn lipschitz_holds<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
    q: Point<D>,
) -> Result<(), String> {
    let promise = shape.promise();
    if let Some(region) = promise.region
        && [p, q].iter().any(|x| (*x - region.centre).norm() > region.radius)
    {
        return Ok(());
    }
    let (fp, fq) = (shape.distance(p), shape.distance(q));
    let apart = (p - q).norm();
    let slack = rounding(shape, p) + rounding(shape, q) + POINT * apart;
    if (fp - fq).abs() <= promise.lipschitz * apart + slack {
        return Ok(());
    }
    Err(format!(
        "from {p:?} to {q:?}, {apart:e} apart, the value goes from {fp:e} to {fq:e}: \
         {} times as much, promised {} (rounding {slack:e})",
        (fp - fq).abs() / apart,
        promise.lipschitz,
    ))
}

/// The distance to a box, zero inside.
fn to_box<const D: usize>(aabb: &Aabb<D>, p: Point<D>) -> f64 {
    Vector::<f64, D>(std::array::from_fn(|i| {
        f64::max(0.0, f64::max(aabb.min[i] - p[i], p[i] - aabb.max[i]))
    }))
    .norm()
}

/// Outside the bounds the value is positive and, where promised, at least the distance to box
/// and ball; a field without interior is nowhere negative.
///
/// # Errors
///
/// Says which bound is broken and by how much.
pub fn bounds_hold<const D: usize>(shape: &Shape<D>, p: Point<D>) -> Result<(), String> {
    let promise = shape.promise();
    let f = shape.distance(p);
    let slack = rounding(shape, p) + POINT * p.norm();
    if !promise.has_interior && f < -slack {
        return Err(format!("no interior promised, but {f:e} at {p:?}"));
    }
    let Some(bounds) = promise.bounds else { return Ok(()) };
    let slack = slack + POINT * bounds.radius_about_origin();
    let from_box = to_box(&bounds.aabb, p);
    let from_ball = (p - bounds.ball.centre).norm() - bounds.ball.radius;
    for (what, outside) in [("box", from_box), ("ball", from_ball)] {
        if outside > slack && f < -slack {
            return Err(format!("{outside:e} outside the {what}, but {f:e} at {p:?}"));
        }
        if promise.above_bounds && outside > 0.0 && f < outside - slack {
            return Err(format!("{outside:e} from the {what}, but {f:e} at {p:?}"));
        }
    }
    Ok(())
}

/// Half-way between `p` and `q` a convex field is at most the mean.
///
/// # Errors
///
/// Says by how much it is above.
pub fn convex_where_promised<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
    q: Point<D>,
) -> Result<(), String> {
    if !shape.promise().convex {
        return Ok(());
    }
    let middle = (p + q) * 0.5;
    let mean = 0.5 * (shape.distance(p) + shape.distance(q));
    let slack = rounding(shape, p) + rounding(shape, q) + POINT * (p.norm() + q.norm());
    let f = shape.distance(middle);
    if f <= mean + slack {
        return Ok(());
    }
    Err(format!("convex promised, but {f:e} half-way between {p:?} and {q:?}, mean {mean:e}"))
}

/// Mirroring a promised axis changes nothing beyond rounding.
///
/// # Errors
///
/// Says the axis and both values.
pub fn symmetric_where_promised<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
) -> Result<(), String> {
    for (axis, symmetric) in shape.promise().symmetric.into_iter().enumerate() {
        let mut image = p;
        image[axis] = -image[axis];
        let (f, mirrored) = (shape.distance(p), shape.distance(image));
        if symmetric && exceeds((f - mirrored).abs(), 2.0 * rounding(shape, p)) {
            return Err(format!("axis {axis} of {p:?}: {f:e}, mirrored {mirrored:e}"));
        }
    }
    Ok(())
}
