// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Separating translations: closed forms, and that the bodies are apart after them.

use palpate_field::kernel::{Ball, Cuboid, Cylinder, HalfSpace, Torus};
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{
    Limits, PairWorkspace, Placed, SeparatingTranslation, separating_translation, separation,
};

const LIMITS: Limits = Limits::new(1e-4).with_budget(200_000);

/// The separating translation, proven to separate.
fn out<const D: usize>(a: &Shape<D>, b: &Shape<D>, pose: Pose<D>) -> SeparatingTranslation<D> {
    let mut workspace = PairWorkspace::new();
    let there = Placed::new(b, pose);
    let way = separating_translation(a, there, &LIMITS, &mut workspace)
        .expect("bounded")
        .expect("a translation");
    let mut moved = pose;
    moved.translation += way.direction * way.length;
    let after = separation(a, Placed::new(b, moved), &LIMITS, &mut workspace).expect("bounded");
    assert!(after.lower >= -LIMITS.tolerance, "{way:?} leads to {after:?}");
    assert!((way.direction.norm() - 1.0).abs() < 1e-12, "{way:?}");
    assert!(way.at_least <= way.length, "{way:?}");
    way
}

#[test]
fn balls_leave_along_their_centres() -> Result<(), ShapeError> {
    let (a, b) = (Shape::from_kernel(Ball::new(1.0)?), Shape::from_kernel(Ball::new(0.5)?));
    let centre = Vector([0.6, 0.0, 0.8]) * 1.2;
    let way = out(&a, &b, Pose::translation(centre));
    assert!((way.length - 0.3).abs() < 3e-4, "{way:?}");
    assert!((way.direction - Vector([0.6, 0.0, 0.8])).norm() < 0.02, "{way:?}");
    // Concentric: every way is as good, and none shorter than both radii.
    let way = out(&a, &b, Pose::identity());
    assert!((way.length - 1.5).abs() < 3e-4, "{way:?}");
    let (a, b) = (Shape::from_kernel(Ball::new(1.0)?), Shape::from_kernel(Ball::new(0.5)?));
    let way = out(&a, &b, Pose::translation(Vector([0.0, -1.2])));
    assert!((way.length - 0.3).abs() < 3e-4, "{way:?}");
    Ok(())
}

#[test]
fn a_cube_leaves_a_beam_by_its_nearest_side() -> Result<(), ShapeError> {
    let beam = Shape::from_kernel(Cuboid::new(Vector([4.0, 1.0, 1.0]))?);
    let cube = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?);
    for (centre, length) in [
        ([0.3, 0.6, 0.0], 0.4),
        ([0.0, 0.0, -0.9], 0.1),
        ([2.3, 0.0, 0.0], 0.2),
        // In the middle: half of both widths, not of the length.
        ([0.0, 0.0, 0.0], 1.0),
    ] {
        let way = out(&beam, &cube, Pose::translation(Vector(centre)));
        assert!((way.length - length).abs() < 0.005 * length + 3e-4, "{centre:?}: {way:?}");
    }
    Ok(())
}

#[test]
fn out_of_a_floor_the_way_is_up() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    let post = Shape::from_kernel(Cylinder::new(0.1, 0.4)?);
    let way = out(&floor, &post, Pose::translation(Vector([3.0, 0.05, -2.0])));
    assert!((way.length - 0.15).abs() < 3e-4, "{way:?}");
    assert!(way.direction[1] > 0.999, "{way:?}");
    Ok(())
}

#[test]
fn concave_bodies_leave_each_other() -> Result<(), ShapeError> {
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let turn = Rotation::from_axis_angle(Vector([1.0, 0.0, 0.0]), 1.5)?;
    // Two links of a chain, pushed together by 1 cm: the way apart is along the chain.
    let linked = Pose::new(turn, Vector([0.41, 0.0, 0.0]));
    let way = out(&torus, &torus, linked);
    assert!(way.length < 0.02, "{way:?}");
    Ok(())
}

#[test]
fn bodies_apart_need_no_way() -> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let way = out(&ball, &ball, Pose::translation(Vector([2.0, 0.0, 0.0])));
    assert_eq!((way.length, way.at_least), (0.0, 0.0));
    Ok(())
}

/// Steps of what overlaps once left a speck in a cube without a translation.
#[test]
fn what_is_tiny_leaves_what_is_large() -> Result<(), ShapeError> {
    let cube = Shape::from_kernel(Cuboid::new(Vector([0.4, 0.4, 0.4]))?);
    let speck = Shape::from_kernel(Ball::new(1e-6)?);
    let way = out(&cube, &speck, Pose::translation(Vector([0.1, 0.05, 0.02])));
    assert!((way.length - 0.1).abs() < 2e-3, "{way:?}");
    Ok(())
}
