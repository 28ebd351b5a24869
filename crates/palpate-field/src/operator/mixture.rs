// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sums of two fields: displacement and morphing.

use super::boolean::{combined, joined, promise_of_union};
use super::surface::guarded;
use crate::error::{ShapeError, Unit, positive};
use crate::field::{Combine, SharedField};
use crate::promise::{Deviation, Promise, Quality, Rounding};
use crate::scalar::Scalar;

/// `a − clamp(b, −h, h)`.
#[derive(Clone, Debug)]
pub(crate) struct Displacement {
    height: f64,
}

impl Combine for Displacement {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a - b.clamp(-self.height, self.height)
    }
}

/// `(1 − t)·a + t·b`.
#[derive(Clone, Debug)]
pub(crate) struct Morph {
    weights: [f64; 2],
}

impl Combine for Morph {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        S::weighted_sum([a, b], &self.weights)
    }
}

/// The steepness is the sum of both; the surface moves by at most the height.
fn promise_of_displacement<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
    height: f64,
) -> Promise<D> {
    let size = a.bounds.map_or(0.0, |bounds| bounds.radius_about_origin()) + height;
    Promise {
        outside: Quality::Lipschitz,
        inside: Quality::Lipschitz,
        lipschitz: (a.lipschitz + b.lipschitz) * (1.0 + f64::EPSILON),
        bounds: a.bounds.map(|bounds| bounds.grown(height)),
        has_interior: true,
        rounding: a.rounding.plus(&b.rounding).plus(&Rounding::of_operations(2.0, size)),
        deviation: summed(a.deviation, b.deviation).map(|deviation| deviation.moved(height)),
        ..joined(a, b)
    }
}

fn summed(a: Option<Deviation>, b: Option<Deviation>) -> Option<Deviation> {
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    Some(Deviation { value: a.value + b.value, within: a.within.min(b.within) })
}

fn promise_of_morph<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
    weights: [f64; 2],
) -> Promise<D> {
    let union = promise_of_union(a, b);
    let size = union.bounds.map_or(0.0, |bounds| bounds.radius_about_origin());
    let quality = a.outside.and(a.inside).and(b.outside).and(b.inside).bounded();
    Promise {
        outside: quality,
        inside: quality,
        lipschitz: (weights[0] * a.lipschitz + weights[1] * b.lipschitz)
            * (1.0 + 4.0 * f64::EPSILON),
        rounding: a.rounding.or(&b.rounding).plus(&Rounding::of_operations(4.0, size)),
        // A mean is small also where both values are large.
        deviation: union.deviation.map(|deviation| Deviation { within: 0.0, ..deviation }),
        ..union
    }
}

/// The `child` with its surface moved by the field `by`, by at most `height`.
pub(crate) fn displaced<const D: usize>(
    child: SharedField<D>,
    by: SharedField<D>,
    height: f64,
) -> Result<SharedField<D>, ShapeError> {
    let height = positive("height", height, Unit::Metre)?;
    let rule = |a: &Promise<D>, b: &Promise<D>| promise_of_displacement(a, b, height);
    combined(Displacement { height }, "displace", vec![guarded(child)?, by], rule)
}

/// The weighted mean of two fields.
pub(crate) fn morphed<const D: usize>(
    from: SharedField<D>,
    into: SharedField<D>,
    progress: f64,
) -> Result<SharedField<D>, ShapeError> {
    if !(0.0..=1.0).contains(&progress) {
        return Err(ShapeError::number("morph", "from 0 to 1", progress, Unit::One));
    }
    let weights = [1.0 - progress, progress];
    let rule = |a: &Promise<D>, b: &Promise<D>| promise_of_morph(a, b, weights);
    combined(Morph { weights }, "morph", vec![from, into], rule)
}
