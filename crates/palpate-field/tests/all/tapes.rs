// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What tapes must also do: norms of many numbers, shapes whose formula would be very long, and
//! blocks that are empty, filled in part, or far away.

use std::panic::{AssertUnwindSafe, catch_unwind};

use palpate_field::operator::Profile;
use palpate_field::scalar::{AffineModel, Model, Scalar, SpaceTimeModel};
use palpate_field::{
    BLOCK, Block, Column, InstructionSet, Kernel, Layout, Promise, Shape, ShapeError, Strided,
    Vector,
};

/// A norm of four numbers, which is more than a step of a tape takes.
#[derive(Clone, Copy, Debug)]
enum OfFour {
    Norm,
    Orthant,
    PowerNorm,
    PowerOrthant,
}

impl Kernel<3> for OfFour {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let q = [p[0], p[1], p[2], S::constant(0.75)];
        match self {
            Self::Norm => S::norm(q) - S::constant(1.0),
            Self::Orthant => S::orthant(q) - S::constant(1.0),
            Self::PowerNorm => S::power_norm::<4, 4>(q) - S::constant(1.0),
            Self::PowerOrthant => S::power_orthant::<6, 4>(q) - S::constant(1.0),
        }
    }

    fn promise(&self) -> Promise<3> {
        Promise::lipschitz(None, 1.0)
    }
}

/// Shapes of kernels with norms of four numbers.
pub(crate) fn of_four() -> [Shape<3>; 4] {
    [OfFour::Norm, OfFour::Orthant, OfFour::PowerNorm, OfFour::PowerOrthant]
        .map(Shape::from_kernel)
}

/// Points in a cube of side 2, none alike.
pub(crate) fn points() -> Vec<Vector<f64, 3>> {
    let spread = |i: u32, k: u32| (f64::from(7 * i + k) * 0.618_033_988_749_895).fract() - 0.5;
    (0..BLOCK as u32).map(|i| Vector([1, 2, 3].map(|k| 2.0 * spread(i, k)))).collect()
}

/// Bounds over a cell that moves by `(0.5, 0, 0)` m/s for one second.
fn in_space_and_time(shape: &Shape<3>, centre: Vector<f64, 3>, half: f64) -> SpaceTimeModel {
    let [x, y, z, t] =
        AffineModel::<4>::cell([centre[0], centre[1], centre[2], 0.0], [half, half, half, 0.5]);
    let mut cells = Block::<SpaceTimeModel, 3, BLOCK>::zero();
    cells.set(0, Vector([x + t.scale(0.5), y, z]));
    let mut models = Column::scratch();
    shape.block_distances(&cells, 1, &mut models);
    models.get(0)
}

#[test]
fn norms_of_four_numbers_are_bounded_in_space_and_time() {
    for shape in of_four() {
        for centre in points() {
            let model = in_space_and_time(&shape, centre, 0.05);
            for time in [-0.5, 0.0, 0.5] {
                for corner in [-0.05, 0.0, 0.05] {
                    let moved = centre + Vector([0.5 * time + corner, corner, -corner]);
                    let value = shape.distance(moved);
                    let is_inside =
                        model.minimum() <= value + 1e-12 && value <= model.maximum() + 1e-12;
                    assert!(is_inside, "{shape:?}: {value} at {moved:?}, {model:?}");
                }
            }
        }
    }
}

/// Unions of 16 copies within unions: a tape of six levels would have 16 777 216 leaves.
#[test]
fn unions_of_few_members_within_unions_are_bounded_without_a_long_tape()
-> Result<(), ShapeError> {
    let mut shape = Shape::ball(0.01)?;
    for level in 0..6 {
        let step = 0.1 * f64::from(level + 1);
        let copy = |i: u32| {
            let at = Vector([f64::from(i % 4), f64::from(i / 4), 0.0]) * step;
            shape.clone().offset(0.001)?.translated(at)
        };
        shape = Shape::union((0..16).map(copy).collect::<Result<Vec<_>, _>>()?)?;
    }
    shape.prepare();
    let model = in_space_and_time(&shape, Vector([0.0, 0.0, 1.0]), 0.01);
    let value = shape.distance([0.0, 0.0, 1.0]);
    assert!(model.minimum() <= value && value <= model.maximum());
    Ok(())
}

/// How long a tape would be is known without counting a shared shape each time.
#[test]
fn intersections_of_a_shape_with_itself_are_built_at_once() -> Result<(), ShapeError> {
    let mut shape = Shape::<3>::ball(0.5)?;
    for level in 0..60 {
        let other = shape.clone();
        shape = if level % 2 == 0 {
            Shape::intersection([shape, other])?
        } else {
            Shape::smooth_union([shape, other], Profile::Quadratic, 0.01)?
        };
    }
    Shape::union([shape, Shape::ball(0.1)?]).map(drop)
}

/// Each field is prepared once, however many tapes call it.
#[test]
fn unions_of_many_members_within_unions_are_prepared() -> Result<(), ShapeError> {
    let balls = (0..17).map(|i| Shape::ball(0.1)?.translated([f64::from(i), 0.0, 0.0]));
    let balls = balls.collect::<Result<Vec<_>, ShapeError>>()?;
    let mut shape = Shape::ball(0.5)?;
    for _ in 0..30 {
        shape = Shape::union(balls.iter().cloned().chain([shape]))?.offset(1e-3)?;
    }
    shape.prepare();
    shape.prepare();
    Ok(())
}

#[test]
fn no_cells_have_no_models() -> Result<(), ShapeError> {
    for members in [1, 16, 17, 80] {
        let balls =
            (0..members).map(|i| Shape::ball(0.1)?.translated([f64::from(i), 0.0, 0.0]));
        let shape = Shape::union(balls.collect::<Result<Vec<_>, ShapeError>>()?)?;
        let cells = Block::<Model, 3, BLOCK>::zero();
        let mut models = Column::zero();
        shape.block_distances(&cells, 0, &mut models);
    }
    Ok(())
}

#[test]
fn unions_at_infinity_have_the_bits_of_blocks() -> Result<(), ShapeError> {
    let shape = Shape::ball(0.5)?.translated([0.1, 0.0, 0.0])? | Shape::cuboid([0.4; 3])?;
    let p = Vector([f64::INFINITY; 3]);
    let mut block = Block::<f64, 3, BLOCK>::zero();
    block.set(0, p);
    let mut values = Column::zero();
    shape.block_distances(&block, 1, &mut values);
    let (value, with_gradient) = (shape.distance(p), shape.distance_gradient(p).0);
    assert_eq!(value.is_nan(), values.get(0).is_nan(), "{value}");
    assert_eq!(value.is_nan(), with_gradient.is_nan(), "{value}");
    Ok(())
}

/// Once lanes were boxes along the axes; then filling them with others was broken off.
#[test]
fn cells_of_a_block_that_was_filled_in_part_are_bounded() -> Result<(), ShapeError> {
    let [x, _, z] = Model::cell([1.0, 1.0, 1.0], [1.0, 1.0, 1.0]);
    // Both x and y are the first parameter.
    let slanted = Vector([x, x, z]);
    let mut block = Block::<Model, 3, BLOCK>::zero();
    let broken_off = catch_unwind(AssertUnwindSafe(|| {
        block.fill(2, |i| if i == 0 { slanted } else { panic!("broken off") });
    }));
    assert!(broken_off.is_err());
    let turned = palpate_field::Rotation::from_quaternion([0.0, 0.0, 0.6, 0.8])?;
    let shape = Shape::cuboid([1.0; 3])?.rotated(turned)?;
    let mut models = Column::scratch();
    shape.block_distances(&block, 1, &mut models);
    let model = models.get(0);
    for u in [-1.0, 0.0, 1.0] {
        for w in [-1.0, 0.0, 1.0] {
            let value = shape.distance([1.0 + u, 1.0 + u, 1.0 + w]);
            let is_inside =
                model.minimum() <= value + 1e-12 && value <= model.maximum() + 1e-12;
            assert!(is_inside, "{value}: {model:?}");
        }
    }
    Ok(())
}

#[test]
fn blocks_have_so_many_lanes_and_no_more() -> Result<(), ShapeError> {
    let shape = Shape::ball(0.5)?;
    let (block, mut values) = (Block::<f64, 3, BLOCK>::zero(), Column::zero());
    for count in [BLOCK + 1, usize::MAX] {
        let asked = catch_unwind(AssertUnwindSafe(|| {
            shape.block_distances(&block, count, &mut values);
        }));
        assert!(asked.is_err(), "{count} points");
    }
    Ok(())
}

#[test]
fn rows_of_many_numbers_stay_in_their_slice() {
    let layout = Layout {
        start: usize::MAX,
        rows: usize::MAX,
        row_stride: isize::MAX,
        column_stride: isize::MAX,
    };
    for sign in [1, -1] {
        let layout = Layout { row_stride: sign * layout.row_stride, ..layout };
        assert!(Strided::<f64, 8>::new(&[0.0; 10], layout).is_err());
    }
}

/// Every instruction set of this machine, in one test, since the choice is the process's.
pub(crate) fn norms_have_the_bits_of_points() {
    let set = InstructionSet::in_use();
    for shape in of_four() {
        let agree = palpate_testkit::laws::bits_agree(&shape, &points());
        assert_eq!(agree, Ok(()), "{set:?}, {shape:?}");
    }
}
