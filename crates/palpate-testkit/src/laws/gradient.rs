// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Gradients are never NaN, never too long, and of length one where promised.

use palpate_field::{Point, Quality, Shape, Vector};

use super::rounding;

/// The gradient is a number, no longer than the Lipschitz constant and, where
/// the value is exact, of length one, to `ulp` units; the value has the bits of
/// [`Shape::distance`].
///
/// # Errors
///
/// Says the gradient and its length.
pub fn gradient_is_bounded<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
    ulp: f64,
) -> Result<(), String> {
    let promise = shape.promise();
    let (f, g) = shape.distance_gradient(p);
    let alone = shape.distance(p);
    if f.to_bits() != alone.to_bits() {
        return Err(format!("{f:e} with the gradient, {alone:e} without, at {p:?}"));
    }
    if !f.is_finite() || !g.is_finite() {
        return Err(format!("value {f:e}, gradient {g:?} at {p:?}"));
    }
    let length = g.norm();
    let tolerance = ulp * f64::EPSILON;
    if promise.region.is_none() && length > promise.lipschitz * (1.0 + tolerance) {
        return Err(format!(
            "gradient {g:?} of length 1 + {:e} at {p:?}, Lipschitz constant {}",
            length - 1.0,
            promise.lipschitz
        ));
    }
    // On the surface, rounding decides the side.
    let sure = f.abs() > 2.0 * rounding(shape, p);
    let quality = if f < 0.0 { promise.inside } else { promise.outside };
    if sure && quality == Quality::Exact && (length - 1.0).abs() > tolerance {
        return Err(format!(
            "gradient {g:?} of length 1 + {:e} at {p:?} where the value {f:e} is exact",
            length - 1.0
        ));
    }
    Ok(())
}

/// Slopes that differ by more have a kink between them.
const KINK: f64 = 1e-3;

/// How much shorter the second step in the search for kinks is.
const SHORTER: f64 = 16.0;

/// Away from kinks, the gradient is the slope of the values around `p`.
///
/// At a kink, forward and backward differences disagree; between two kinks, differences over a
/// shorter step disagree with the others.
///
/// # Errors
///
/// Says both.
pub fn gradient_is_the_slope<const D: usize>(
    shape: &Shape<D>,
    p: Point<D>,
) -> Result<(), String> {
    let (f, g) = shape.distance_gradient(p);
    let step = 1e-6 * (p.norm() + f.abs()).max(1e-3);
    let error = (4.0 * rounding(shape, p) + 4.0 * f64::EPSILON * p.norm()) / step;
    let around = |along: Vector<f64, D>, step: f64| {
        let along = along * step;
        [shape.distance(p + along) - f, f - shape.distance(p - along)].map(|x| x / step)
    };
    let differences: [[f64; 2]; D] =
        std::array::from_fn(|axis| around(Vector::unit(axis), step));
    let shorter = step / SHORTER;
    let plateau = (0..D).fold(0.0_f64, |most, axis| {
        let closer = around(Vector::unit(axis), shorter);
        (0..2).fold(most, |most, i| most.max((closer[i] - differences[axis][i]).abs()))
    });
    let is_smooth = plateau <= KINK + 2.0 * SHORTER * error;
    let slope = Vector(differences.map(|[ahead, behind]| 0.5 * (ahead + behind)));
    // Several kinks that cross may not show along the axes.
    let diagonal = around(Vector::constant(1.0), step);
    let all = differences.iter().chain([&diagonal]);
    let bend = all.fold(0.0_f64, |m, [ahead, behind]| m.max((ahead - behind).abs()));
    let apart = (slope - g).norm();
    let tolerance = 4.0 * (bend + plateau) + 2.0 * error + 1e-5;
    // Where the kinks of two children cancel in the value, the gradient may take different
    // sides.
    let askew = Vector(std::array::from_fn(|i| shorter / (1.0 + i as f64)));
    let cancels = [p + askew, p - askew]
        .iter()
        .all(|q| (slope - shape.distance_gradient(*q).1).norm() <= tolerance + KINK);
    if bend < KINK && is_smooth && apart > tolerance && !cancels {
        return Err(format!("gradient {g:?} at {p:?}, but slope {slope:?}, value {f:e}"));
    }
    Ok(())
}
