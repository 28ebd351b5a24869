// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Gradients, rounding and models, on every primitive and on random trees.

use arbitrary::Unstructured;
use palpate_field::{Point, Shape, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::Space;
use palpate_testkit::laws::Cell;
use palpate_testkit::tree::{Solid, Tree};
use palpate_testkit::{cases, laws};

/// Deepest trees drawn.
const DEEPEST: usize = 6;

/// Room for the length of a gradient that promises one, in ulp: 6 of the kernel, since a
/// star of many branches folds the plane nine times,
/// and as many for each node that turns or scales it.
const GRADIENT_ULP: f64 = 6.0;

type Law<const D: usize> = fn(&mut Unstructured<'_>, &Tree<D>, &Shape<D>, Point<D>) -> Outcome;
type Outcome = arbitrary::Result<Result<(), String>>;

/// Checks a law at `points` points of each of `count` trees.
fn on_trees<const D: usize>(count: u64, points: usize, law: Law<D>)
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(count, DEEPEST, |u, tree, shape| {
        for _ in 0..points {
            let p = draw::point(u, shape)?;
            if let Err(complaint) = law(u, tree, shape, p)? {
                return Ok(Err(complaint));
            }
        }
        Ok(Ok(()))
    });
}

fn bounded<const D: usize>(
    _: &mut Unstructured<'_>,
    tree: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome
where
    Space: Solid<D>,
{
    Ok(laws::gradient_is_bounded(shape, p, GRADIENT_ULP * tree.depth() as f64))
}

fn slope<const D: usize>(
    _: &mut Unstructured<'_>,
    _: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome {
    Ok(laws::gradient_is_the_slope(shape, p))
}

fn rounding<const D: usize>(
    _: &mut Unstructured<'_>,
    tree: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome
where
    Space: Solid<D>,
{
    Ok(laws::rounding_holds(tree, shape, p))
}

/// Cells about a point, from a millionth of the scene to all of it, long and
/// flat ones too.
fn models<const D: usize>(
    u: &mut Unstructured<'_>,
    _: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome
where
    Space: Turn<D>,
{
    let size = draw::size(shape);
    let mut cells = Vec::new();
    for _ in 0..4 {
        let largest = size * 10.0_f64.powf(draw::within(u, -6.0, 0.0)?);
        let mut half = Vector::ZERO;
        for h in &mut half.0 {
            *h = match u.int_in_range(0..=7_u8)? {
                0 => 0.0,
                1 => largest,
                _ => largest * draw::within(u, 0.02, 1.0)?,
            };
        }
        // With the point at the centre, a corner or anywhere.
        let mut centre = p;
        let place = u.int_in_range(0..=2_u8)?;
        for k in 0..D {
            centre[k] += half[k]
                * match place {
                    0 => 0.0,
                    1 => f64::from(u.int_in_range(-1..=1_i8)?),
                    _ => draw::within(u, -1.0, 1.0)?,
                };
        }
        cells.push(Cell { centre, half });
    }
    let mut samples = Vec::new();
    for _ in 0..12 {
        let mut sample = [0.0; D];
        for x in &mut sample {
            *x = if u.ratio(1_u8, 3_u8)? {
                f64::from(u.int_in_range(-1..=1_i8)?)
            } else {
                draw::within(u, -1.0, 1.0)?
            };
        }
        samples.push(sample);
    }
    let turn = if u.arbitrary()? { Some(draw::pose::<D>(u)?.rotation) } else { None };
    Ok(laws::model_encloses(shape, turn.as_ref(), &cells, &samples))
}

fn tight<const D: usize>(
    u: &mut Unstructured<'_>,
    _: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome {
    let half = Vector::constant(draw::size(shape) * 10.0_f64.powf(draw::within(u, -6.0, 0.0)?));
    Ok(laws::convex_models_are_tight(shape, &[Cell { centre: p, half }]))
}

/// What the culling of unions relies on: single precision is off by at most its
/// own rounding, 2²⁹ times that of double, of point and value.
fn single<const D: usize>(
    _: &mut Unstructured<'_>,
    _: &Tree<D>,
    shape: &Shape<D>,
    p: Point<D>,
) -> Outcome {
    Ok(laws::single_precision_holds(shape, p))
}

palpate_testkit::in_both_dimensions! {
    gradients_are_as_long_as_promised: bounded, 1800, 60;
    gradients_are_slopes: slope, 1800, 60;
    rounding_is_as_promised: rounding, 1200, 30;
    single_precision_is_as_good_as_it_can_be: single, 1800, 60;
    models_enclose_their_samples: models, 1800, 24;
    models_of_convex_fields_are_tight: tight, 1800, 24;
}
