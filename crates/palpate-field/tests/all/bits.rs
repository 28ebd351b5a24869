// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scalar calls, blocks and instruction sets agree bit for bit.
//!
//! One test, since the choice of the instruction set is the process's.

use palpate_field::{BLOCK, InstructionSet, Point, Shape, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::{Solid, Tree};
use palpate_testkit::{cases, laws};

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
            let q = Vector(p.0.map(|x| x as f32));
            let fold = |a: f32, b: f32| if b < a { b } else { a };
            let by_hand = shapes.iter().map(|s| s.distance_f32(q)).reduce(fold);
            let culled = union.distance_f32(q);
            if by_hand.map(f32::to_bits) != Some(culled.to_bits()) {
                return Ok(Err(format!(
                    "{culled:e} culled f32, {by_hand:?} by hand, at {p:?}"
                )));
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

#[test]
fn every_way_to_evaluate_gives_the_same_bits() {
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
    }
}
