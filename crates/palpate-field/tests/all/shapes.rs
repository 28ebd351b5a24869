// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators of shapes: where surfaces pass, and which nodes they build.

use palpate_field::kernel::{Ball, HalfSpace};
use palpate_field::operator::Profile;
use palpate_field::{Rotation, Shape, ShapeError, Vector};
use palpate_testkit::arbitrary::PROFILES;

#[test]
fn every_profile_moves_a_right_angle_by_its_width() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
    for profile in PROFILES {
        let pair = || [floor.clone(), wall.clone()];
        let passes = |shape: Shape<2>, p: [f64; 2]| {
            let distance = shape.distance(Vector(p));
            assert!(distance.abs() < 1e-16, "{profile:?}: {distance} at {p:?}");
        };
        // Where both distances are the width.
        passes(Shape::smooth_union(pair(), profile, 0.01)?, [0.01, 0.01]);
        passes(Shape::smooth_intersection(pair(), profile, 0.01)?, [-0.01, -0.01]);
        let difference = floor.clone().smooth_difference([wall.clone()], profile, 0.01)?;
        passes(difference, [0.01, -0.01]);
    }
    Ok(())
}

#[test]
fn the_geometrical_circle_is_a_fillet() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
    let radius = 0.1;
    let width = radius * (1.0 - std::f64::consts::FRAC_1_SQRT_2);
    let corner = Shape::smooth_union([floor, wall], Profile::CircularGeometrical, width)?;
    for angle in [0.1, 0.7, 1.5_f64] {
        // On the circle about (r, r), seen from the corner.
        let p = Vector([radius * (1.0 - angle.cos()), radius * (1.0 - angle.sin())]);
        assert!(corner.distance(p).abs() < 1e-16);
    }
    Ok(())
}

#[test]
fn moves_of_a_leaf_become_one_node() -> Result<(), ShapeError> {
    let ball = Shape::<2>::from_kernel(Ball::new(1.0)?);
    let moved = ball.translated(Vector([1.0, 0.0]))?.rotated(Rotation::from_angle(1.0)?)?;
    assert_eq!(moved.depth(), 1);
    Ok(())
}

#[test]
fn operators_of_rust_build_the_nodes_of_methods() -> Result<(), ShapeError> {
    let (a, b) = (Shape::circle(0.5)?, Shape::rectangle([0.9, 0.7])?);
    let pair = || [a.clone(), b.clone()];
    assert_eq!(Shape::square(0.5)?, Shape::rectangle([0.5, 0.5])?);
    assert_eq!(&a | &b, Shape::union(pair())?);
    assert_eq!(a.clone() & &b, Shape::intersection(pair())?);
    assert_eq!(&a ^ b.clone(), Shape::symmetric_difference(pair())?);
    assert_eq!(a.clone() - b.clone(), a.difference([b])?);
    Ok(())
}
