// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sharp booleans: union, intersection, difference, symmetric difference.

use crate::bounds::{BoundingBall, Bounds};
use crate::error::ShapeError;
use crate::field::{Combine, Combined, SharedField, Union};
use crate::promise::{Deviation, Promise, Quality};
use crate::scalar::Scalar;

/// Intersection: `max(a, b)`.
#[derive(Clone, Debug)]
pub(crate) struct Maximum;

impl Combine for Maximum {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.max(b)
    }
}

/// Difference, a without b: `max(a, −b)`.
#[derive(Clone, Debug)]
pub(crate) struct Subtraction;

impl Combine for Subtraction {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.max(-b)
    }
}

/// Symmetric difference: `max(min(a, b), −max(a, b))`.
#[derive(Clone, Debug)]
pub(crate) struct ExclusiveOr;

impl Combine for ExclusiveOr {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.min(b).max(-a.max(b))
    }
}

/// The parts of a promise that every operator on two fields joins alike; the qualities
/// are those of `a`.
pub(crate) fn joined<const D: usize>(a: &Promise<D>, b: &Promise<D>) -> Promise<D> {
    let mut both = *a;
    join(&mut both, b);
    both
}

/// As [`joined`], in place, so that a union of many members copies no promise.
fn join<const D: usize>(a: &mut Promise<D>, b: &Promise<D>) {
    a.lipschitz = Scalar::max(a.lipschitz, b.lipschitz);
    if b.region.is_some() {
        a.region = common_region(a.region, b.region);
    }
    a.convex = false;
    for (a, b) in a.symmetric.iter_mut().zip(b.symmetric) {
        *a &= b;
    }
    a.reach = Scalar::max(a.reach, b.reach);
    a.rounding = a.rounding.or(&b.rounding);
    a.deviation = Deviation::either(a.deviation, b.deviation);
}

/// A ball in which both Lipschitz constants hold.
fn common_region<const D: usize>(
    a: Option<BoundingBall<D>>,
    b: Option<BoundingBall<D>>,
) -> Option<BoundingBall<D>> {
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    let (small, large) = if a.radius <= b.radius { (a, b) } else { (b, a) };
    let room = large.radius - (small.centre - large.centre).norm();
    Some(BoundingBall { radius: small.radius.min(room).max(0.0), ..small })
}

/// Bounds that hold both sets; none if one has none.
fn both_bounds<const D: usize>(a: &Promise<D>, b: &Promise<D>) -> Option<Bounds<D>> {
    Some(a.bounds?.union(&b.bounds?))
}

/// Exact outside if both are, a bound inside.
pub(crate) fn promise_of_union<const D: usize>(a: &Promise<D>, b: &Promise<D>) -> Promise<D> {
    let mut union = Promise { bounds: both_bounds(a, b), ..*a };
    unite(&mut union, b);
    union
}

/// The same in place, with bounds left as of `a`.
fn unite<const D: usize>(a: &mut Promise<D>, b: &Promise<D>) {
    join(a, b);
    a.outside = a.outside.and(b.outside);
    a.inside = a.inside.and(b.inside).bounded();
    a.above_bounds &= b.above_bounds;
    a.has_interior |= b.has_interior;
}

/// The promise of the union of `members`; `None` if there are none.
fn promise_of_members<const D: usize>(members: &[SharedField<D>]) -> Option<Promise<D>> {
    let (first, rest) = members.split_first()?;
    let mut promise = *first.promise();
    for member in rest {
        unite(&mut promise, member.promise());
    }
    promise.bounds = Bounds::union_of(members.iter().map(|m| m.promise().bounds.as_ref()));
    Some(promise)
}

/// A bound outside, exact inside if both are. The value is at least that of
/// either side, so the bounds of either serve: the smaller.
pub(crate) fn promise_of_intersection<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
) -> Promise<D> {
    let radius = |p: &Promise<D>| p.bounds.map_or(f64::INFINITY, |bounds| bounds.ball.radius);
    let tighter = if radius(b) < radius(a) { b } else { a };
    Promise {
        outside: a.outside.and(b.outside).bounded(),
        inside: a.inside.and(b.inside),
        bounds: tighter.bounds,
        above_bounds: tighter.above_bounds,
        convex: a.convex && b.convex,
        has_interior: a.has_interior && b.has_interior,
        ..joined(a, b)
    }
}

/// The dual: inside is exact if `a` is exact inside and `b` outside.
pub(crate) fn promise_of_difference<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
) -> Promise<D> {
    Promise {
        outside: a.outside.and(b.inside).bounded(),
        inside: a.inside.and(b.outside),
        has_interior: a.has_interior,
        ..joined(a, b)
    }
}

fn promise_of_symmetric_difference<const D: usize>(
    a: &Promise<D>,
    b: &Promise<D>,
) -> Promise<D> {
    let quality: Quality = a.outside.and(a.inside).and(b.outside).and(b.inside).bounded();
    Promise { outside: quality, inside: quality, ..promise_of_union(a, b) }
}

/// The promise of an operation folded over `children`.
fn fold_promises<const D: usize>(
    children: &[SharedField<D>],
    rule: impl Fn(&Promise<D>, &Promise<D>) -> Promise<D>,
) -> Option<Promise<D>> {
    let (first, rest) = children.split_first()?;
    Some(rest.iter().fold(*first.promise(), |so_far, child| rule(&so_far, child.promise())))
}

/// Folds `operation` over `children`, with its rule for promises; one child alone stays as
/// it is.
pub(crate) fn combined<const D: usize, O: Combine + Clone>(
    operation: O,
    name: &'static str,
    mut children: Vec<SharedField<D>>,
    rule: impl Fn(&Promise<D>, &Promise<D>) -> Promise<D>,
) -> Result<SharedField<D>, ShapeError> {
    let promise = fold_promises(&children, rule).ok_or_else(|| nothing_in(name))?;
    if children.len() == 1 {
        return Ok(children.swap_remove(0));
    }
    Combined::shared(operation, children, promise)
}

/// The error of an operator over no shape.
pub(crate) fn nothing_in(name: &'static str) -> ShapeError {
    ShapeError::Count { parameter: name.into(), rule: "at least 1 shape".into(), count: 0 }
}

/// The members of a union, or the field itself.
fn parts<const D: usize>(field: &SharedField<D>) -> &[SharedField<D>] {
    field.members().unwrap_or(std::slice::from_ref(field))
}

/// The union of `children`, those of unions among them taken apart.
pub(crate) fn union<const D: usize>(
    children: Vec<SharedField<D>>,
) -> Result<SharedField<D>, ShapeError> {
    let mut members = children;
    if members.iter().any(|child| child.members().is_some()) {
        members = members.iter().flat_map(parts).cloned().collect();
    }
    if members.len() == 1 {
        return Ok(members.swap_remove(0));
    }
    let promise = promise_of_members(&members).ok_or_else(|| nothing_in("union"))?;
    Union::shared(members, promise)
}

/// The intersection of `children`.
pub(crate) fn intersection<const D: usize>(
    children: Vec<SharedField<D>>,
) -> Result<SharedField<D>, ShapeError> {
    combined(Maximum, "intersection", children, promise_of_intersection)
}

/// The first of `children` without the union of the others.
pub(crate) fn difference<const D: usize>(
    mut children: Vec<SharedField<D>>,
) -> Result<SharedField<D>, ShapeError> {
    if children.len() > 1 {
        let others = union(children.split_off(1))?;
        children.push(others);
    }
    combined(Subtraction, "difference", children, promise_of_difference)
}

/// What is in an odd number of `children`.
pub(crate) fn symmetric_difference<const D: usize>(
    children: Vec<SharedField<D>>,
) -> Result<SharedField<D>, ShapeError> {
    let rule = promise_of_symmetric_difference;
    combined(ExclusiveOr, "symmetric_difference", children, rule)
}
