// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that just touch, have no inside, are tiny, far away, or no numbers: an error, or
//! a right answer.

use palpate_field::kernel::{Ball, Cuboid, Segment, Sheet, Torus};
use palpate_field::scalar::{Dual, Scalar};
use palpate_field::{
    Aabb, BoundingBall, Bounds, Pose, Promise, Rotation, Shape, ShapeError, Vector,
};
use palpate_query::{
    Certified, Limits, Nearest, PairWorkspace, Placed, QueryError, any_point, overlap,
    separation,
};

type Answers<const D: usize> = [Certified<Nearest<D>>; 2];

/// The separation, and the sign alone.
fn ask<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    tolerance: f64,
) -> Answers<D> {
    let limits = Limits::new(tolerance);
    let mut workspace = PairWorkspace::new();
    let (a, b) = (a.into(), b.into());
    let answers =
        [separation(a, b, &limits, &mut workspace), overlap(a, b, &limits, &mut workspace)];
    answers.map(|answer| answer.unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn bodies_that_just_touch_are_said_to_within_the_tolerance() -> Result<(), ShapeError> {
    let block = Shape::from_kernel(Cuboid::new(Vector([0.4, 0.6, 0.8]))?);
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let quarter =
        Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.25 * std::f64::consts::PI)?;
    let half_diagonal = 0.5_f64.sqrt() * 0.4;
    let cube = Shape::from_kernel(Cuboid::new(Vector([0.4; 3]))?);
    // The last two: 0.5 m from (0.5, 0.7) to the edge at (0.2, 0.3), and a torus about y.
    for (what, a, b, turn, way) in [
        ("two faces", &block, &block, Rotation::identity(), [0.4, 0.1, -0.2]),
        ("two edges", &block, &block, Rotation::identity(), [0.4, 0.6, 0.3]),
        ("two corners", &block, &block, Rotation::identity(), [0.4, 0.6, 0.8]),
        ("an edge and a face", &block, &cube, quarter, [0.2 + half_diagonal, 0.1, 0.0]),
        ("two balls", &ball, &ball, Rotation::identity(), [0.6, 0.0, 0.8]),
        ("a ball and an edge", &block, &ball, Rotation::identity(), [0.5, 0.7, 0.1]),
        ("a torus and a face", &block, &torus, Rotation::identity(), [0.1, -0.05, 0.9]),
    ] {
        let there = Placed::new(b, Pose::new(turn, Vector(way)));
        for answer in ask(a, there, 1e-3) {
            assert!(answer.lower <= 1e-12 && -1e-12 <= answer.upper, "{what}: {answer:?}");
            assert!(answer.upper - answer.lower <= 1e-3, "{what}: {answer:?}");
        }
    }
    Ok(())
}

#[test]
fn bodies_without_an_inside_never_overlap() -> Result<(), ShapeError> {
    let corners = [[-0.5, -0.3, 0.0], [0.5, -0.3, 0.1], [0.0, 0.5, -0.1]].map(Vector);
    let sheet = Shape::from_kernel(Sheet::<3>::new(corners.to_vec(), 0.0)?);
    let wire = Shape::from_kernel(Segment::new(
        Vector([0.0, 0.0, -1.0]),
        Vector([0.0, 0.0, 1.0]),
        0.0,
    )?);
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    for (a, b) in [(&sheet, &wire), (&sheet, &sheet), (&wire, &wire), (&sheet, &ball)] {
        for answer in ask(a, b, 1e-4) {
            // They touch, or the one is in the other: nothing is deeper than its surface.
            assert!(answer.lower <= 1e-12 && -1e-12 <= answer.upper, "{answer:?}");
        }
    }
    Ok(())
}

#[test]
fn the_tiny_the_huge_and_the_far_are_as_far_apart_as_they_are() -> Result<(), ShapeError> {
    for (size, away) in [(1e-9, 1e-9), (1e-9, 1e3), (1e12, 1e12), (1.0, 1e9), (1e-3, 1e14)] {
        let ball = Shape::from_kernel(Ball::new(size)?);
        let block = Shape::from_kernel(Cuboid::new(Vector([size, 2.0 * size, 3.0 * size]))?);
        let here = Pose::translation(Vector([away, -away, 0.5 * away]));
        let there = here * Pose::translation(Vector([2.0 * size, 0.0, 0.0]));
        let [whole, sign] =
            ask(Placed::new(&ball, here), Placed::new(&block, there), 1e-4 * size);
        let truth = 0.5 * size;
        let rounding = 64.0 * f64::EPSILON * away;
        assert!(whole.lower <= truth + rounding, "{whole:?}");
        assert!(truth - rounding <= whole.upper, "{whole:?}");
        assert!(whole.upper - whole.lower <= 1e-4 * size + 16.0 * rounding, "{whole:?}");
        assert!(sign.is_hit() != Some(true) || rounding > truth, "{sign:?}");
    }
    Ok(())
}

#[test]
fn poses_that_are_no_numbers_are_refused() -> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let mut workspace = PairWorkspace::new();
    for wrong in [f64::NAN, f64::INFINITY] {
        let there = Placed::new(&ball, Pose::translation(Vector([wrong, 0.0])));
        let answer = separation(&ball, there, &Limits::new(1e-4), &mut workspace);
        assert_eq!(answer, Err(QueryError::Pose { index: 1 }));
    }
    // Squares of such numbers overflowed, and the upper bound was no number.
    let there = Placed::new(&ball, Pose::translation(Vector([0.0, 1e200])));
    let answer = separation(&ball, there, &Limits::new(1e-4), &mut workspace);
    assert_eq!(answer, Err(QueryError::Coordinate { what: "translation", value: 1e200 }));
    Ok(())
}

/// A field of which only within half a metre of the origin is known how steep it is: one
/// there, and 0.02 m about (0.55, 0) beyond.
fn known_nearby(is_there: bool) -> Shape<2> {
    let aabb = Aabb { min: Vector([-1.0, -1.0]), max: Vector([1.0, 1.0]) };
    let promise = Promise::lipschitz(Some(Bounds::of_box(aabb)), 1.0)
        .with_region(BoundingBall { centre: Vector::ZERO, radius: 0.5 });
    Shape::from_fn(promise, move |Vector([x, y])| {
        let near = Scalar::norm([x, y]).value <= 0.5;
        if near || !is_there {
            Dual::constant(1.0)
        } else {
            Scalar::norm([x - Dual::constant(0.55), y]) - Dual::constant(0.02)
        }
    })
}

/// Beyond the region a body's value was taken for minus infinity, and called a hit; and
/// boxes with their centre in it were bounded as if it had no end.
#[test]
fn beyond_the_region_of_a_promise_nothing_is_missed_and_nothing_is_made_up()
-> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    for x in [0.3, 0.4, 0.45, 0.5, 0.6, 0.7] {
        let there = Pose::translation(Vector([x, 0.1]));
        for is_there in [false, true] {
            for answer in ask(&known_nearby(is_there), Placed::new(&ball, there), 1e-3) {
                // That nothing is there cannot be proven.
                let hit = is_there.then_some(true);
                assert_eq!(answer.is_hit(), hit, "{x} {is_there}: {answer:?}");
                let truth = if is_there { -0.04 } else { f64::INFINITY };
                assert!(answer.lower <= truth && truth.min(0.0) <= answer.upper, "{answer:?}");
            }
        }
    }
    Ok(())
}

/// A point is found in every primitive that has an inside, and in none of what is cut away whole.
#[test]
fn a_shape_has_points_unless_all_of_it_is_cut_away() -> Result<(), Box<dyn std::error::Error>> {
    fn has_points<const D: usize>(shape: &Shape<D>) -> Result<Option<bool>, QueryError> {
        let limits = Limits::new(1e-9).with_budget(20_000);
        any_point(shape, &limits, &mut PairWorkspace::new()).map(|answer| answer.is_hit())
    }
    fn check<const D: usize>(shape: Shape<D>) -> Result<(), Box<dyn std::error::Error>> {
        let promise = shape.promise();
        if promise.bounds.is_none() {
            assert_eq!(has_points(&shape), Err(QueryError::Unbounded));
            return Ok(());
        }
        if promise.has_interior {
            assert_eq!(has_points(&shape)?, Some(true), "{shape}");
        }
        let larger = shape.clone().offset(0.01)?;
        let rest = shape.clone().difference([larger])?;
        assert_ne!(has_points(&rest)?, Some(true), "{shape}");
        let far = shape.clone().translated(Vector([9.0; D]))?;
        assert_eq!(has_points(&Shape::intersection([shape, far])?)?, Some(false));
        Ok(())
    }
    for entry in palpate_field::catalogue::Entry::<2>::ALL {
        check(entry.example()?)?;
    }
    for entry in palpate_field::catalogue::Entry::<3>::ALL {
        check(entry.example()?)?;
    }
    // A ball smaller than the last place of its coordinates is not proven to be empty.
    let distant = Shape::sphere(0.01)?.translated(Vector([1e15, 0.0, 0.0]))?;
    assert_ne!(has_points(&distant)?, Some(false));
    // What is cut away to its surface is open.
    let ball = Shape::sphere(0.5)?;
    assert_eq!(has_points(&(&ball - &ball))?, None);
    Ok(())
}
