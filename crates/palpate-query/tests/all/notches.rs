// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Separations of a ball from shapes that are not convex: in a notch, on stairs, beside a bent
//! bar. They converge to a micrometre in a few thousand evaluations, however both are turned.

use palpate_field::kernel::Ball;
use palpate_field::{Point, Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{Limits, PairWorkspace, Placed, Stop, separation};

/// The most evaluations of a search.
const BUDGET: u32 = 10_000;

/// How far the bounds may be apart at the end [m].
const TOLERANCE: f64 = 1e-6;

/// The side of the shapes [m].
const SIDE: f64 = 0.04;

/// How far the ball is from them [m].
const GAP: f64 = 0.5e-3;

/// Poses of both bodies: their own, and turned.
fn poses() -> Result<[Pose<3>; 3], ShapeError> {
    let turned = |axis: [f64; 3], angle| {
        let rotation = Rotation::from_axis_angle(Vector(axis), angle)?;
        Ok(Pose::new(rotation, Vector([0.011, -0.002, 0.007])))
    };
    Ok([Pose::identity(), turned([1.0, 2.0, 3.0], 0.65)?, turned([-0.3, 0.2, 1.0], 2.2)?])
}

/// Asks for the separation of a ball from the shape, once it is as far away as `GAP`.
#[track_caller]
fn converges(
    shape: &Shape<3>,
    centre: impl Into<Point<3>>,
    radius: f64,
) -> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(radius)?);
    let mut workspace = PairWorkspace::new();
    let centre = centre.into();
    for pose in poses()? {
        let there = pose.transform_point(centre);
        let limits = Limits::new(TOLERANCE).with_budget(BUDGET);
        let ball = Placed::new(&ball, Pose::translation(there));
        let answer = separation(Placed::new(shape, pose), ball, &limits, &mut workspace);
        let Ok(answer) = answer else { panic!("bounded") };
        assert_eq!(answer.stop, Stop::Converged, "{answer:?}");
        let truth = shape.distance(centre) - radius;
        assert!((truth - GAP).abs() < 1e-4, "{truth} m");
        assert!(answer.lower <= truth + 1e-12 && truth <= answer.upper + 1e-12, "{answer:?}");
    }
    Ok(())
}

/// A polygon of an L, or the like, with its corners in hundredths of the side.
fn polygon(corners: &[[i32; 2]]) -> Result<Shape<2>, ShapeError> {
    let corner = |p: &[i32; 2]| Vector(p.map(|x| f64::from(x) * 0.01 * SIDE));
    Shape::polygon([corners.iter().map(corner).collect::<Vec<_>>()])
}

#[test]
fn a_ball_in_the_notch_of_an_extruded_polygon() -> Result<(), ShapeError> {
    let l = polygon(&[[-50, -50], [50, -50], [50, 0], [0, 0], [0, 50], [-50, 50]])?;
    let bar = l.extruded(SIDE)?;
    converges(&bar, [8.5e-3, 1.3e-3, 8.5e-3], 8e-3)?;
    // On one face alone.
    converges(&bar, [11e-3, 1.3e-3, 8.5e-3], 8e-3)?;
    Ok(())
}

#[test]
fn a_ball_in_the_notch_of_a_revolved_polygon() -> Result<(), ShapeError> {
    // A shaft with a flange, and a dish.
    let shaft = polygon(&[[10, -50], [100, -50], [100, 0], [50, 0], [50, 50], [10, 50]])?;
    let shaft = shaft.revolved()?;
    converges(&shaft, [28.5e-3 * 0.6, 8.5e-3, 28.5e-3 * 0.8], 8e-3)?;
    let dish = polygon(&[[20, -50], [100, -50], [100, 50], [75, 50], [75, 0], [20, 0]])?;
    let dish = dish.revolved()?;
    converges(&dish, [21.5e-3 * 0.6, 8.5e-3, 21.5e-3 * 0.8], 8e-3)?;
    Ok(())
}

#[test]
fn a_ball_on_stairs() -> Result<(), ShapeError> {
    let stairs = Shape::stairs(0.01, 0.008, 5)?;
    // Before the third riser, over the second tread.
    let (x, y) = (-5e-3 - 3.5e-3, -4e-3 + 3.5e-3);
    converges(&stairs.clone().extruded(SIDE)?, [x, 1.3e-3, y], 3e-3)?;
    // A hopper with steps: turned about an axis to their right.
    let hopper = stairs.translated([0.06, 0.0])?.revolved()?;
    let x = x + 0.06;
    converges(&hopper, [x * 0.6, y, x * 0.8], 3e-3)?;
    Ok(())
}

#[test]
fn a_ball_beside_a_bezier_curve() -> Result<(), ShapeError> {
    let curve = Shape::quadratic_bezier([-0.02, 0.01], [0.0, -0.03], [0.02, 0.01], 3e-3);
    let curve = curve?;
    let bar = curve.clone().extruded(SIDE)?;
    // In its bend, and outside of it.
    converges(&bar, [0.0, 1.3e-3, -3.5e-3], 3e-3)?;
    converges(&bar, [0.0, 1.3e-3, -16.5e-3], 3e-3)?;
    let ring = curve.translated([0.03, 0.0])?.revolved()?;
    converges(&ring, [0.03 * 0.6, -3.5e-3, 0.03 * 0.8], 3e-3)?;
    converges(&ring, [0.03 * 0.6, -16.5e-3, 0.03 * 0.8], 3e-3)?;
    Ok(())
}

#[test]
fn a_ball_in_the_hollow_of_a_bobbly_cross() -> Result<(), ShapeError> {
    let cross = Shape::bobbly_cross(SIDE, 4e-3, 2e-3)?;
    let bar = cross.extruded(SIDE)?;
    // The vertex of an arc, from the centre.
    let vertex = 18e-3 / 2.0_f64.sqrt() - 4e-3 + 2e-3;
    let away = (vertex + 4.5e-3) / 2.0_f64.sqrt();
    converges(&bar, [away, 1.3e-3, away], 4e-3)?;
    Ok(())
}
