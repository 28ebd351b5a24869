// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! No evaluation allocates, in a tree with every operator.
#![expect(unsafe_code, reason = "a global allocator is an unsafe trait")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::f64::consts::TAU;
use std::hint::black_box;

use palpate_field::catalogue::Entry;
use palpate_field::kernel::{Ball, Cuboid, Cylinder, RegularStar, Torus};
use palpate_field::operator::Profile;
use palpate_field::scalar::{Model, Scalar};
use palpate_field::{
    BLOCK, Block, Column, Gradients, InstructionSet, Point, Pose, Promise, Rotation, Shape,
    ShapeError, Vector,
};

/// The system's allocator, with the calls of each thread counted.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

thread_local! {
    // Has no destructor and no lazy start, so that counting does not allocate.
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    CALLS.set(CALLS.get() + 1);
}

// SAFETY: everything is left to the system's allocator, which keeps the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: `pointer` came from `alloc` or `realloc`, which are the system's.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as for `dealloc`, and the caller keeps the contract on `size`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// How often `work` calls the allocator.
fn calls(work: impl FnOnce()) -> u64 {
    let before = CALLS.get();
    work();
    CALLS.get() - before
}

/// Evaluates `shape` in every way there is at `points`, at most [`BLOCK`].
fn evaluate<const D: usize>(shape: &Shape<D>, points: &[Point<D>]) {
    let count = points.len();
    let mut distances = [0.0; BLOCK];
    shape.distances(points, &mut distances[..count]);
    for p in points {
        black_box(shape.distance(*p));
        black_box(shape.distance_gradient(*p));
        black_box(shape.safe_radius(*p));
        black_box(shape.surface_point(*p));
        let single = Vector(p.0.map(|x| x as f32));
        black_box(shape.distance_f32(single));
        black_box(shape.distance_gradient_f32(single));
    }

    let mut block = Block::<f64, D>::zero();
    let mut cells = Block::<Model, D>::zero();
    for (i, p) in points.iter().enumerate() {
        block.set(i, *p);
        cells.set(i, Vector(Model::cell(p.0, [0.1; D])));
    }
    shape.block_distances(&block, count, black_box(&mut Column::zero()));
    shape.block_gradients(&block, count, black_box(&mut Gradients::zero()));
    shape.block_distances(&cells, count, black_box(&mut Column::zero()));
}

/// Points on a spiral through the scene.
fn points<const D: usize>() -> Vec<Point<D>> {
    let on_spiral = |i: usize| {
        let (t, sizes) = (i as f64 / BLOCK as f64, [2.0, 1.5, 1.0]);
        Vector(std::array::from_fn(|k| {
            sizes[k] * t * f64::cos(5.0 * TAU * t - TAU / 4.0 * k as f64)
        }))
    };
    (0..BLOCK).map(on_spiral).collect()
}

fn assert_no_allocation<const D: usize>(what: &str, shape: &Shape<D>) {
    let points = points::<D>();
    for set in InstructionSet::ALL.into_iter().filter(|set| set.select()) {
        shape.prepare();
        for count in [1, 7, 33, BLOCK] {
            let calls = calls(|| evaluate(shape, &points[..count]));
            assert_eq!(
                calls, 0,
                "calls of the allocator for {count} points of {what}, {set:?}"
            );
        }
    }
}

/// Many members, of which most are skipped at any one point.
fn crowd<const D: usize>(members: usize) -> Result<Shape<D>, ShapeError> {
    let radius = 0.1;
    let member = |i: usize| {
        let centre = Vector(std::array::from_fn(|k| [i % 8, i / 8 % 8, i % 5][k] as f64 - 3.5));
        Shape::from_kernel(Ball::new(radius)?).translated(centre)
    };
    Shape::union((0..members).map(member).collect::<Result<Vec<_>, _>>()?)
}

/// Every operator of both dimensions.
fn every_operator<const D: usize>(
    leaf: Shape<D>,
    other: Shape<D>,
) -> Result<Shape<D>, ShapeError> {
    let promise = Promise::lipschitz(None, 1.02);
    let wavy = Shape::from_fn(promise, |p: Vector<_, D>| {
        p.0[1] - p.0[0].scale(20.0).sin().scale(0.01)
    });
    let pair = || [leaf.clone(), other.clone()];
    let moved = other.clone().stretched([0.8; D])?.translated(Vector::constant(0.25))?;
    let parts = [
        Shape::intersection([Shape::union(pair())?, wavy])?,
        leaf.clone().difference([moved.clone()])?,
        Shape::symmetric_difference(pair())?,
        Shape::smooth_union(pair(), Profile::Quadratic, 0.05)?,
        Shape::smooth_union([moved.clone(), other.clone()], Profile::Cubic, 0.05)?,
        leaf.clone().offset(0.1)?.shell(0.05)?,
        moved.elongated([0.3; D])?.offset(0.05)?,
        other.clone().translated(Vector::constant(0.5))?.mirrored(0)?,
        leaf.scaled(0.5)?,
        crowd(64)?,
    ];
    Shape::smooth_union([Shape::union(parts)?, other], Profile::Quadratic, 0.01)
}

#[test]
fn the_counter_counts() {
    assert!(calls(|| drop(black_box(Box::new(1)))) >= 2);
}

// One test, since the choice of the instruction set is the process's.
#[test]
fn no_evaluation_allocates() -> Result<(), ShapeError> {
    no_operator_allocates()?;
    no_primitive_allocates()
}

fn no_operator_allocates() -> Result<(), ShapeError> {
    let star = Shape::from_kernel(RegularStar::new(5, 1.0, 0.5)?);
    let ball = Shape::from_kernel(Ball::new(0.7)?);
    let flat = every_operator::<2>(star.clone(), ball)?;
    assert_no_allocation("every operator of the plane", &flat);

    let third = Rotation::from_axis_angle(Vector([1.0, 1.0, 1.0]), TAU / 3.0)?;
    let torus = Shape::from_kernel(Torus::new(0.8, 0.2)?);
    let cube = Shape::from_kernel(Cuboid::new(Vector([1.0, 0.8, 0.6]))?);
    let solid = Shape::union([
        every_operator::<3>(torus, cube)?,
        star.clone().extruded(0.4)?.placed(&Pose::new(third, Vector([0.2, 0.1, 0.0])))?,
        star.translated(Vector([2.0, 0.0]))?.revolved()?,
        Shape::from_kernel(Cylinder::new(0.3, 2.0)?),
    ])?;
    assert_no_allocation("every operator of space", &solid);
    assert_no_allocation("a crowd in the plane", &crowd::<2>(64)?);
    assert_no_allocation("a crowd in space", &crowd::<3>(200)?);
    Ok(())
}

fn no_primitive_allocates() -> Result<(), ShapeError> {
    for entry in Entry::<2>::ALL {
        assert_no_allocation(entry.name, &entry.example()?);
    }
    for entry in Entry::<3>::ALL {
        assert_no_allocation(entry.name, &entry.example()?);
    }
    Ok(())
}

#[test]
fn clones_of_shapes_do_not_allocate() -> Result<(), ShapeError> {
    let crowd = crowd::<3>(64)?;
    assert_eq!(calls(|| drop(black_box(crowd.clone()))), 0);
    Ok(())
}
