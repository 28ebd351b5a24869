// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scalar calls, blocks and instruction sets agree bit for bit.
//!
//! One test, since the choice of the instruction set is the process's.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, InstructionSet, Point, Shape, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::Space;
use palpate_testkit::laws::Cell;
use palpate_testkit::tree::{Solid, Tree};
use palpate_testkit::{cases, laws};

/// Roundings by which models evaluated in two ways may differ, beside those of the promise.
const WIDTH_ROUNDINGS: f64 = 32.0;

/// Checks random trees; `spread` puts the points of a block near each other or
/// all over the scene.
fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(count, 6, |u, _, shape| {
        let points = block_of_points(u, shape)?;
        Ok(laws::bits_agree(shape, &points))
    });
}

fn block_of_points<const D: usize>(
    u: &mut arbitrary::Unstructured<'_>,
    shape: &Shape<D>,
) -> arbitrary::Result<Vec<Point<D>>> {
    let count = u.int_in_range(1..=BLOCK)?;
    let centre = draw::point(u, shape)?;
    let spread = draw::size(shape) * 10.0_f64.powf(draw::within(u, -4.0, 0.0)?);
    let near = u.arbitrary()?;
    (0..count)
        .map(
            |_| {
                if near {
                    Ok(centre + draw::vector(u)? * spread)
                } else {
                    draw::point(u, shape)
                }
            },
        )
        .collect()
}

/// The union of many members, which skips those out of reach, is the fold of
/// their values by hand, with the sign of zero.
fn unions_are_folds<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    cases::check(count, |u| {
        let members = u.int_in_range(7..=80_usize)?;
        let mut trees = Vec::new();
        for _ in 0..members {
            let leaf = draw::leaf::<D>(u)?;
            let mut pose = draw::pose(u)?;
            pose.translation = pose.translation * 4.0;
            trees.push(Tree::Placed(Box::new(leaf), pose));
        }
        let shapes: Vec<Shape<D>> = trees.iter().filter_map(|tree| tree.shape().ok()).collect();
        let Ok(union) = Shape::union(shapes.clone()) else {
            return Ok(Err("no union".into()));
        };
        let points = block_of_points(u, &union)?;
        for p in &points {
            let fold = |a: f64, b: f64| if b < a { b } else { a };
            let by_hand = shapes.iter().map(|s| s.distance(*p)).reduce(fold);
            let culled = union.distance(*p);
            if by_hand.map(f64::to_bits) != Some(culled.to_bits()) {
                return Ok(Err(format!("{culled:e} culled, {by_hand:?} by hand, at {p:?}")));
            }
        }
        Ok(laws::bits_agree(&union, &points))
    });
}

/// Blocks of every number of points, from one to a whole block.
fn partial_blocks<const D: usize>()
where
    Space: Solid<D> + Turn<D>,
{
    cases::check(12, |u| {
        let tree: Tree<D> = draw::tree(u, 4)?;
        let shape = match tree.shape() {
            Ok(shape) => shape,
            Err(error) => return Ok(Err(format!("{error}: {tree:?}"))),
        };
        let points =
            (0..BLOCK).map(|_| draw::point(u, &shape)).collect::<Result<Vec<_>, _>>()?;
        Ok((1..=BLOCK).try_for_each(|count| {
            laws::bits_agree(&shape, &points[..count])
                .map_err(|complaint| format!("{complaint}, {count} points\n  {tree:?}"))
        }))
    });
}

/// Models evaluated with the instruction set in use. They enclose the field, and are no wider than
/// `others`, models of the same cells evaluated in another way. Gives the models.
fn models_of_trees<const D: usize>(count: u64, others: &[Model]) -> Vec<Model>
where
    Space: Solid<D> + Turn<D>,
{
    let mut all = Vec::new();
    cases::on_trees(count, 6, |u, _, shape| {
        let samples: Vec<[f64; D]> =
            (0..16).map(|_| draw::vector(u).map(|v| v.0)).collect::<arbitrary::Result<_>>()?;
        let samples: Vec<[f64; D]> =
            samples.into_iter().map(|u| u.map(|x| x.clamp(-1.0, 1.0))).collect();
        let mut cells = Vec::new();
        for _ in 0..u.int_in_range(1..=BLOCK)? {
            let half = draw::size(shape) * 10.0_f64.powf(draw::within(u, -4.0, 0.0)?);
            cells.push(Cell { centre: draw::point(u, shape)?, half: Vector::constant(half) });
        }
        if let Err(complaint) = laws::model_encloses(shape, None, &cells, &samples) {
            return Ok(Err(complaint));
        }
        let models = laws::models(shape, None, &cells);
        for (cell, model) in cells.iter().zip(&models) {
            if let Some(other) = others.get(all.len()) {
                let reach = cell.centre.norm() + cell.half.norm();
                let rounding = shape.promise().rounding.within(reach) + f64::EPSILON * reach;
                let width = |model: &Model| model.maximum() - model.minimum();
                let (here, there) = (width(model), width(other));
                if here > there * (1.0 + 1e-12) + WIDTH_ROUNDINGS * rounding {
                    return Ok(Err(format!(
                        "{here:e} wide, {there:e} in another way: {cell:?}"
                    )));
                }
            }
            all.push(*model);
        }
        Ok(Ok(()))
    });
    all
}

#[test]
fn every_way_to_evaluate_gives_the_same_bits() {
    let mut models: Option<(Vec<Model>, Vec<Model>)> = None;
    for set in InstructionSet::ALL {
        if !set.select() {
            println!("skipped: this machine has no {set:?}");
            continue;
        }
        on_trees::<2>(900);
        on_trees::<3>(900);
        partial_blocks::<2>();
        partial_blocks::<3>();
        unions_are_folds::<2>(60);
        unions_are_folds::<3>(60);
        crate::tapes::norms_have_the_bits_of_points();
        let (planar, spatial) = models.take().unwrap_or_default();
        let (planar, spatial) =
            (models_of_trees::<2>(300, &planar), models_of_trees::<3>(300, &spatial));
        models = Some((planar, spatial));
    }
}
