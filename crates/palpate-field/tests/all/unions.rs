// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of unions of many members, of which each cell asks few: they enclose the union, and
//! are no wider than if all members were asked.

use arbitrary::{Result, Unstructured};
use palpate_field::kernel::{Ball, Cuboid};
use palpate_field::scalar::{Model, Scalar};
use palpate_field::{BLOCK, Shape, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::laws::{self, Cell};
use palpate_testkit::tree::Solid;

/// Roundings by which the orders of two folds may differ, relative to the largest number.
const ROUNDINGS: f64 = 64.0;

/// Some members, small beside the space that they are in.
fn members<const D: usize>(u: &mut Unstructured<'_>, count: usize) -> Result<Vec<Shape<D>>>
where
    Space: Solid<D> + Turn<D>,
{
    let mut shapes = Vec::new();
    let apart = draw::within(u, 1.0, 12.0)?;
    while shapes.len() < count {
        let mut pose = draw::pose(u)?;
        pose.translation = pose.translation * apart;
        let placed = draw::leaf::<D>(u)?.shape().and_then(|shape| shape.placed(&pose));
        shapes.extend(placed.ok());
    }
    Ok(shapes)
}

/// Cells from the whole union down to a thousandth, all of a block of one size or of many.
fn cells<const D: usize>(u: &mut Unstructured<'_>, union: &Shape<D>) -> Result<Vec<Cell<D>>> {
    let size = draw::size(union);
    let exponent = draw::within(u, -3.0, 0.0)?;
    let is_mixed: bool = u.arbitrary()?;
    (0..u.int_in_range(1..=BLOCK)?)
        .map(|_| {
            let exponent = if is_mixed { draw::within(u, -3.0, 0.0)? } else { exponent };
            let mut half = Vector::constant(size * 10.0_f64.powf(exponent));
            for x in &mut half.0 {
                *x *= draw::unit(u)?;
            }
            Ok(Cell { centre: draw::point(u, union)?, half })
        })
        .collect()
}

/// Checks unions of 7 to `most` members: of more than a block of them, those that are near each
/// other share a line.
fn on_unions<const D: usize>(
    count: u64,
    most: usize,
    law: impl Fn(
        &mut Unstructured<'_>,
        &[Shape<D>],
        &Shape<D>,
    ) -> Result<std::result::Result<(), String>>,
) where
    Space: Solid<D> + Turn<D>,
{
    cases::check(count, |u| {
        let count = u.int_in_range(7..=most)?;
        let shapes = members::<D>(u, count)?;
        let Ok(union) = Shape::union(shapes.clone()) else { return Ok(Err("no union".into())) };
        law(u, &shapes, &union)
    });
}

fn models_enclose<const D: usize>()
where
    Space: Solid<D> + Turn<D>,
{
    on_unions::<D>(120, 200, |u, _, union| {
        let cells = cells(u, union)?;
        let mut samples = [[0.0; D]; 24];
        for x in samples.as_flattened_mut() {
            *x = if u.ratio(1_u8, 3_u8)? {
                f64::from(u.int_in_range(-1..=1_i8)?)
            } else {
                draw::within(u, -1.0, 1.0)?
            };
        }
        let turn = if u.arbitrary()? { Some(draw::pose::<D>(u)?.rotation) } else { None };
        Ok(laws::model_encloses(union, turn.as_ref(), &cells, &samples))
    });
}

#[test]
fn models_of_planar_unions_enclose_their_samples() {
    models_enclose::<2>();
}

#[test]
fn models_of_spatial_unions_enclose_their_samples() {
    models_enclose::<3>();
}

fn no_wider<const D: usize>()
where
    Space: Solid<D> + Turn<D>,
{
    on_unions::<D>(60, 64, |u, shapes, union| {
        let cells = cells(u, union)?;
        let of_union = laws::models(union, None, &cells);
        let of_members: Vec<_> =
            shapes.iter().map(|member| laws::models(member, None, &cells)).collect();
        for (i, model) in of_union.iter().enumerate() {
            let all: Vec<Model> = of_members.iter().map(|models| models[i]).collect();
            let Some(by_hand) = all.iter().copied().reduce(Scalar::min) else { continue };
            let largest = draw::size(union) + cells[i].centre.norm() + by_hand.deviation();
            let slack = ROUNDINGS * f64::EPSILON * largest;
            let is_alike = (model.value - by_hand.value).abs() <= slack;
            let nearest = all.iter().filter(|member| member.value <= by_hand.value + slack);
            // Of members that are equally near, any may be the one whose plane is kept.
            let is_narrow = nearest.count() > 1
                || (model.lower <= by_hand.lower + slack
                    && model.upper <= by_hand.upper + slack);
            if !is_alike || !is_narrow {
                return Ok(Err(format!("{model:?}, by hand {by_hand:?}, over {:?}", cells[i])));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn models_of_planar_unions_are_no_wider_than_of_all_members() {
    no_wider::<2>();
}

#[test]
fn models_of_spatial_unions_are_no_wider_than_of_all_members() {
    no_wider::<3>();
}

#[test]
fn a_cell_far_from_others_has_the_model_of_its_member() {
    // A row of balls and cuboids in turn, 1 m apart.
    let place = |i: u32| Vector([f64::from(i), 0.1 * f64::from(i % 5), 0.0]);
    let shapes: Vec<Shape<3>> = (0..48)
        .map(|i| {
            let shape = if i % 2 == 0 {
                Shape::from_kernel(Ball::new(0.2).unwrap())
            } else {
                Shape::from_kernel(Cuboid::new(Vector([0.3, 0.2, 0.25])).unwrap())
            };
            shape.translated(place(i)).unwrap()
        })
        .collect();
    let union = Shape::union(shapes.clone()).unwrap();
    let cells: Vec<Cell<3>> = (0..48)
        .map(|i| Cell { centre: place(i) + Vector([0.02, 0.3, 0.1]), half: Vector([0.01; 3]) })
        .collect();
    let of_union = laws::models(&union, None, &cells);
    for (i, shape) in shapes.iter().enumerate() {
        assert_eq!(of_union[i], laws::models(shape, None, &cells)[i], "member {i}");
    }
}
