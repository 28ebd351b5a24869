// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Promises never overclaim, on every primitive and on random trees.

use arbitrary::Unstructured;
use palpate_field::{Point, Quality, Shape, ShapeError, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;
use palpate_testkit::{cases, laws};

/// Deepest trees drawn.
const DEEPEST: usize = 6;

type Law<const D: usize> = fn(&mut Unstructured<'_>, &Shape<D>, Point<D>) -> Outcome;
type Outcome = arbitrary::Result<Result<(), String>>;

/// Checks a law at `points` points of each of `count` trees: as many leaves as
/// trees of each other depth.
fn on_trees<const D: usize>(count: u64, points: usize, law: Law<D>)
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(count, DEEPEST, |u, _, shape| {
        for _ in 0..points {
            let p = draw::point(u, shape)?;
            if let Err(complaint) = law(u, shape, p)? {
                return Ok(Err(complaint));
            }
        }
        Ok(Ok(()))
    });
}

fn overclaims<const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome {
    let directions = [draw::direction(u)?, draw::direction(u)?];
    Ok(laws::never_overclaims(shape, p, &directions))
}

/// Near pairs, and pairs across the shape.
fn lipschitz<const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome {
    let far = draw::point(u, shape)?;
    let step = draw::size(shape) * 10.0_f64.powf(draw::within(u, -9.0, 0.0)?);
    let near = p + draw::direction(u)? * step;
    let mut flipped = p;
    for x in &mut flipped.0 {
        // Across a plane of symmetry, where folds meet.
        if u.arbitrary()? {
            *x = -*x * draw::unit(u)?;
        }
    }
    let pairs = [far, near, flipped];
    Ok(pairs.into_iter().try_for_each(|q| laws::lipschitz_holds(shape, p, q)))
}

fn bounds<const D: usize>(u: &mut Unstructured<'_>, shape: &Shape<D>, p: Point<D>) -> Outcome {
    let mut outcome = laws::bounds_hold(shape, p);
    if let Some(bounds) = shape.promise().bounds {
        // Just outside the ball, and just outside a face of the box.
        let out = 1.0 + 10.0_f64.powf(draw::within(u, -12.0, 0.5)?);
        let direction = draw::direction(u)?;
        let q = bounds.ball.centre + direction * (bounds.ball.radius * out);
        outcome = outcome.and_then(|()| laws::bounds_hold(shape, q));
        let half = bounds.aabb.half_extents();
        let mut q = bounds.aabb.centre();
        for k in 0..D {
            q[k] += half[k] * draw::within(u, -1.0, 1.0)?;
        }
        let axis = u.int_in_range(0..=D - 1)?;
        q[axis] = bounds.aabb.centre()[axis] + half[axis] * direction[axis].signum() * out;
        outcome = outcome.and_then(|()| laws::bounds_hold(shape, q));
    }
    Ok(outcome.and_then(|()| laws::symmetric_where_promised(shape, p)))
}

fn convex<const D: usize>(u: &mut Unstructured<'_>, shape: &Shape<D>, p: Point<D>) -> Outcome {
    let q = draw::point(u, shape)?;
    let near: Vector<f64, D> = p + draw::direction(u)? * (0.01 * draw::size(shape));
    Ok([q, near].into_iter().try_for_each(|q| laws::convex_where_promised(shape, p, q)))
}

palpate_testkit::in_both_dimensions! {
    values_never_exceed_the_distance: overclaims, 1800, 40;
    values_are_no_steeper_than_promised: lipschitz, 1800, 60;
    shapes_stay_in_their_bounds: bounds, 1800, 60;
    convex_fields_lie_below_their_chords: convex, 1800, 60;
}

#[test]
fn a_wall_between_members_that_touch_is_zero_and_parts_that_overlap_have_none()
-> Result<(), ShapeError> {
    let pair = |reach: f64| {
        let part = |x: f64| Shape::<2>::cuboid([2.0 + reach, 2.0])?.translated([x, 0.0]);
        Shape::union([part(-1.0)?, part(1.0)?])
    };
    let touching = pair(0.0)?;
    assert_eq!(touching.promise().inside, Quality::Bound);
    // The surface is 1 m away, at the top and the bottom.
    assert_eq!(touching.distance([0.0, 0.0]), 0.0);
    // The zero at the wall was once named as surface.
    assert_eq!(touching.surface_point([0.25, 0.0]), None);
    assert_eq!(touching.surface_point([0.75, 0.75]), Some(Vector([0.75, 1.0])));
    assert_eq!(touching.safe_radius([0.0, 0.0]), 0.0);
    assert_eq!(pair(0.5)?.distance([0.0, 0.0]), -0.25);
    Ok(())
}
