// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Penetrations of known length, and that the bodies are apart after them.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_mesh::{Outline, Solid, TriangleMesh};
use palpate_query::{
    Certified, Limits, PairWorkspace, Penetration, Placed, QueryError, Stop, penetration,
    separation,
};
use palpate_testkit::soup::Soup;

const LIMITS: Limits = Limits::new(1e-4);

type Answer<const D: usize> = Certified<Penetration<D>>;

/// The penetration of two bodies, the second at `pose`. Checks that a translation as long as the upper bound
/// separates them.
fn asked<const D: usize>(
    a: &Shape<D>,
    b: &Shape<D>,
    pose: Pose<D>,
    limits: &Limits,
) -> Answer<D> {
    let mut workspace = PairWorkspace::new();
    let found = penetration(a, Placed::new(b, pose), limits, &mut workspace).unwrap();
    assert!(0.0 <= found.lower && found.lower <= found.upper, "{found:?}");
    // The last round may exceed the budget.
    assert!(
        f64::from(found.evaluations) < 1.1 * f64::from(limits.budget) + 4000.0,
        "{found:?}"
    );
    if let Some(direction) = found.best.direction {
        assert!((direction.norm() - 1.0).abs() < 1e-12, "{found:?}");
        let mut moved = pose;
        moved.translation += direction * found.upper;
        let tolerance = limits.tolerance;
        let after =
            separation(a, Placed::new(b, moved), &Limits::new(tolerance), &mut workspace)
                .unwrap();
        assert!(after.lower >= -tolerance, "{found:?} leads to {after:?}");
    }
    found
}

/// The same, that the bounds hold the known length and are as close as the tolerance.
#[track_caller]
fn known<const D: usize>(a: &Shape<D>, b: &Shape<D>, pose: Pose<D>, length: f64) -> Answer<D> {
    let found = asked(a, b, pose, &LIMITS);
    assert!(found.lower <= length && length <= found.upper, "{length}: {found:?}");
    assert!(found.upper - found.lower <= LIMITS.tolerance, "{length}: {found:?}");
    assert!(matches!(found.stop, Stop::Converged | Stop::SignKnown), "{found:?}");
    println!("{length}: {found}");
    // The same from the other side.
    let swapped = asked(b, a, pose.inverse(), &LIMITS);
    assert!(swapped.lower <= length && length <= swapped.upper, "{length}: {swapped:?}");
    found
}

fn along(x: f64, y: f64, z: f64) -> Pose<3> {
    Pose::translation(Vector([x, y, z]))
}

fn turned() -> Rotation<3> {
    Rotation::from_axis_angle(Vector([0.3, -0.5, 0.8]), 0.7).unwrap()
}

fn mesh(size: [f64; 3]) -> Shape<3> {
    let soup = Soup::cuboid([0.0; 3], size);
    let mesh = TriangleMesh::new(soup.vertices, soup.faces).unwrap();
    Shape::custom(Solid::from_mesh(&mesh).unwrap().0)
}

fn outline(points: &[[f64; 2]]) -> Shape<2> {
    let count = points.len() as u32;
    let sides = (0..count).map(|i| [i, (i + 1) % count]).collect();
    let mesh = Outline::new(points.iter().copied().map(Vector).collect(), sides).unwrap();
    Shape::custom(Solid::from_mesh(&mesh).unwrap().0)
}

#[test]
fn a_ball_in_a_cube_leaves_by_half_the_side_and_its_radius() -> Result<(), ShapeError> {
    let cube = Shape::<3>::cuboid([1.0; 3])?;
    let ball = Shape::<3>::ball(0.1)?;
    known(&cube, &ball, Pose::identity(), 0.6);
    known(&cube, &ball, along(0.1, -0.2, 0.15), 0.4);
    known(&cube.rotated(turned())?, &ball, Pose::identity(), 0.6);
    let square = Shape::<2>::rectangle([1.0, 1.0])?;
    known(&square, &Shape::<2>::circle(0.1)?, Pose::identity(), 0.6);
    Ok(())
}

#[test]
fn equal_cubes_that_coincide_leave_by_one_side() -> Result<(), ShapeError> {
    let cube = Shape::<3>::cuboid([1.0; 3])?;
    known(&cube, &cube, Pose::identity(), 1.0);
    let turned = cube.rotated(turned())?;
    known(&turned, &turned, Pose::identity(), 1.0);
    let square = Shape::<2>::rectangle([1.0, 1.0])?;
    known(&square, &square, Pose::identity(), 1.0);
    let tilted = square.rotated(Rotation::from_angle(0.4)?)?;
    known(&tilted, &tilted, Pose::identity(), 1.0);
    Ok(())
}

#[test]
fn a_ball_leaves_a_ball_by_both_radii_less_their_distance() -> Result<(), ShapeError> {
    let (a, b) = (Shape::<3>::ball(1.0)?, Shape::<3>::ball(0.5)?);
    let way = known(&a, &b, along(0.72, 0.0, 0.96), 0.3);
    let direction = way.best.direction.unwrap();
    assert!((direction - Vector([0.6, 0.0, 0.8])).norm() < 0.02, "{way:?}");
    // Concentric: every way is as good, and none shorter than both radii.
    let way = known(&a, &b, Pose::identity(), 1.5);
    assert!(way.evaluations < 2000, "{way:?}");
    let (a, b) = (Shape::<2>::circle(1.0)?, Shape::<2>::circle(0.5)?);
    known(&a, &b, Pose::translation([0.0, -1.2]), 0.3);
    known(&a, &b, Pose::identity(), 1.5);
    Ok(())
}

#[test]
fn a_rod_through_a_plate_leaves_along_itself() -> Result<(), ShapeError> {
    let plate = Shape::<3>::cuboid([2.0, 0.1, 2.0])?;
    let rod = Shape::<3>::cylinder(0.05, 0.6)?;
    // Half of the rod, half of the plate, less how far it has moved; sideways it is 1.05.
    for of_mesh in [false, true] {
        let plate = if of_mesh { mesh([2.0, 0.1, 2.0]) } else { plate.clone() };
        let way = known(&plate, &rod, along(0.1, 0.07, -0.2), 0.28);
        assert!(way.best.direction.unwrap()[1] > 0.999, "{way:?}");
        let away = plate.rotated(turned())?.translated([700.0, -300.0, 200.0])?;
        let there = rod.clone().translated([0.1, 0.07, -0.2])?.rotated(turned())?;
        known(&away, &there.translated([700.0, -300.0, 200.0])?, Pose::identity(), 0.28);
    }
    // The largest ball in both says less: as wide as the plate or the rod, whichever is thinner.
    let apart = separation(&plate, &rod, &LIMITS, &mut PairWorkspace::new()).unwrap();
    assert!((apart.upper + 0.1).abs() < 2e-4, "{apart:?}");
    let rod = Shape::<2>::rectangle([0.1, 0.6])?;
    let corners = [[-1.0, -0.05], [1.0, -0.05], [1.0, 0.05], [-1.0, 0.05]];
    for plate in [Shape::<2>::rectangle([2.0, 0.1])?, outline(&corners)] {
        known(&plate, &rod, Pose::translation([0.1, 0.07]), 0.28);
    }
    Ok(())
}

#[test]
fn a_cube_leaves_a_beam_by_its_nearest_side() -> Result<(), ShapeError> {
    let beam = Shape::<3>::cuboid([4.0, 1.0, 1.0])?;
    let cube = Shape::<3>::cuboid([1.0; 3])?;
    for (centre, length) in [
        ([0.3, 0.6, 0.0], 0.4),
        ([0.0, 0.0, -0.9], 0.1),
        ([2.3, 0.0, 0.0], 0.2),
        // In the middle: half of both widths, not of the length.
        ([0.0, 0.0, 0.0], 1.0),
    ] {
        known(&beam, &cube, Pose::translation(Vector(centre)), length);
    }
    Ok(())
}

/// A cylinder's side, a cone's and an ellipsoid's are round, and have no corner that is farthest out.
#[test]
fn round_bodies_leave_by_their_widths() -> Result<(), ShapeError> {
    let cylinder = Shape::<3>::cylinder(0.3, 1.0)?;
    // Around the axis every way is as good.
    known(&cylinder, &Shape::<3>::cylinder(0.2, 2.0)?, Pose::identity(), 0.5);
    let egg = Shape::<3>::ellipsoid([0.5, 0.2, 0.4])?;
    known(&egg, &egg, Pose::rotation(Rotation::identity()), 0.4);
    known(&egg.clone().rotated(turned())?, &egg.rotated(turned())?, Pose::identity(), 0.4);
    let rounded = Shape::<3>::cuboid([0.6, 0.2, 0.4])?.offset(0.1)?;
    known(&rounded, &Shape::<3>::ball(0.05)?, along(0.02, 0.03, 0.0), 0.22);
    let capsule = Shape::<3>::segment([0.0, -0.5, 0.0], [0.0, 0.5, 0.0], 0.1)?;
    known(&capsule, &capsule, along(0.0, 0.3, 0.0), 0.2);
    Ok(())
}

#[test]
fn out_of_a_floor_the_way_is_up() -> Result<(), ShapeError> {
    let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)?;
    let post = Shape::<3>::cylinder(0.1, 0.4)?;
    let way = known(&floor, &post, along(3.0, 0.05, -2.0), 0.15);
    assert!(way.best.direction.unwrap()[1] > 0.999, "{way:?}");
    // A body that is not convex, whose field is exact outside.
    let fork = post.clone() | post.clone().translated([0.3, -0.1, 0.0])?;
    known(&floor, &fork, along(3.0, 0.05, -2.0), 0.25);
    // A hole in a floor is no half-space.
    let holed = floor.clone() - Shape::<3>::cylinder(0.5, 4.0)?;
    let found = asked(&holed, &post, along(0.35, 0.0, 0.0), &Limits::new(0.02));
    assert!(found.lower <= 0.0 + 1e-12 && found.upper < 0.04, "{found:?}");
    let wall = Shape::<3>::half_space([1.0, 0.0, 0.0], 0.0)?;
    let both = penetration(&floor, &wall, &LIMITS, &mut PairWorkspace::new());
    assert_eq!(both, Err(QueryError::Unbounded));
    Ok(())
}

#[test]
fn bodies_that_are_apart_or_touch_need_no_way() -> Result<(), ShapeError> {
    let ball = Shape::<3>::ball(0.5)?;
    let found = asked(&ball, &ball, along(2.0, 0.0, 0.0), &LIMITS);
    assert_eq!((found.lower, found.upper, found.best.direction), (0.0, 0.0, None));
    // Apart along a diagonal, where the boxes overlap.
    let found = asked(&ball, &ball, along(0.6, 0.6, 0.6), &LIMITS);
    assert_eq!((found.lower, found.upper, found.best.direction), (0.0, 0.0, None));
    let cube = Shape::<3>::cuboid([1.0; 3])?;
    let found = asked(&cube, &cube, along(1.0, 0.3, 0.2), &LIMITS);
    // A normal is known to the root of the roundings, about 1e-7.
    assert!(found.lower == 0.0 && found.upper < 1e-6, "{found:?}");
    let pair = ball.clone() | ball.clone().translated([0.0, 0.0, 3.0])?;
    let found = asked(&pair, &ball, along(0.3, 0.0, 1.5), &LIMITS);
    assert_eq!((found.lower, found.upper, found.best.direction), (0.0, 0.0, None));
    // A body without an interior has nothing to take out.
    let needle = Shape::<3>::segment([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.0)?;
    let found = asked(&cube, &needle, Pose::identity(), &LIMITS);
    assert_eq!((found.lower, found.upper, found.best.direction), (0.0, 0.0, None));
    Ok(())
}

/// Two bars along the axes with a common corner, of length 1 and width 0.2.
fn angle() -> Result<Shape<2>, ShapeError> {
    let bar = |x: f64, y: f64| Shape::<2>::rectangle([x, y])?.translated([0.5 * x, 0.5 * y]);
    Ok(bar(1.0, 0.2)? | bar(0.2, 1.0)?)
}

/// Two bars along the axes with a common middle, of length 1 and width 0.2.
fn cross() -> Result<Shape<2>, ShapeError> {
    Ok(Shape::<2>::rectangle([1.0, 0.2])? | Shape::<2>::rectangle([0.2, 1.0])?)
}

/// Bounds of bodies that are not convex, which the budget may leave apart.
#[track_caller]
fn bounded<const D: usize>(
    [a, b]: [&Shape<D>; 2],
    pose: Pose<D>,
    length: f64,
    limits: &Limits,
) -> Answer<D> {
    let found = asked(a, b, pose, limits);
    println!("{length}: {found}");
    let rounding = 1e-9;
    assert!(found.lower <= length + rounding && length <= found.upper + rounding, "{found:?}");
    found
}

#[test]
fn an_angle_leaves_an_angle_along_the_diagonal() -> Result<(), ShapeError> {
    let angle = angle()?;
    let length = 0.08_f64.sqrt();
    let found = bounded([&angle, &angle], Pose::identity(), length, &Limits::new(2e-3));
    assert!(found.upper - found.lower <= 2e-3, "{found:?}");
    let turn = Rotation::from_angle(0.4)?;
    let there = angle.rotated(turn)?.translated([30.0, -80.0])?;
    let found = bounded([&there, &there], Pose::identity(), length, &Limits::new(2e-3));
    assert!(found.upper - found.lower <= 2e-3, "{found:?}");
    Ok(())
}

#[test]
fn a_cross_leaves_a_cross_between_its_arms() -> Result<(), ShapeError> {
    let cross = cross()?;
    // Past the other's arm along one axis, and past the own along the other.
    let length = (0.6_f64 * 0.6 + 0.2 * 0.2).sqrt();
    let found = bounded([&cross, &cross], Pose::identity(), length, &Limits::new(0.02));
    assert!(found.upper - found.lower <= 0.02, "{found:?}");
    Ok(())
}

#[test]
fn a_star_leaves_a_star() -> Result<(), ShapeError> {
    let corner = |i: u32| {
        let angle = 0.2 * std::f64::consts::PI * f64::from(i);
        let radius = if i.is_multiple_of(2) { 0.5 } else { 0.2 };
        Vector([radius * angle.cos(), radius * angle.sin()])
    };
    let star = Shape::polygon(vec![(0..10).map(corner).collect::<Vec<_>>()])?;
    // A tip leaves along its axis, until it is at the notch that lies opposite.
    let length = 0.7;
    let found = asked(&star, &star, Pose::identity(), &Limits::new(0.02));
    println!("star: {found}");
    assert!(found.upper - found.lower <= 0.02, "{found:?}");
    assert!(found.lower <= length && length <= found.upper, "{found:?}");
    Ok(())
}

#[test]
fn a_ball_leaves_the_tube_of_a_torus() -> Result<(), ShapeError> {
    let torus = Shape::<3>::torus(0.35, 0.15)?;
    let ball = Shape::<3>::ball(0.1)?;
    let limits = Limits::new(0.01).with_budget(1_000_000);
    let found = bounded([&torus, &ball], along(0.35, 0.0, 0.0), 0.25, &limits);
    assert!(found.upper - found.lower <= 0.03, "{found:?}");
    Ok(())
}

#[test]
fn links_of_a_chain_leave_each_other() -> Result<(), ShapeError> {
    let torus = Shape::<3>::torus(0.35, 0.15)?;
    let turn = Rotation::from_axis_angle(Vector([1.0, 0.0, 0.0]), 1.5)?;
    // Pushed together by 1 cm: the way apart is along the chain.
    let linked = Pose::new(turn, Vector([0.41, 0.0, 0.0]));
    let found = asked(&torus, &torus, linked, &Limits::new(1e-3));
    assert!(found.upper < 0.02 && found.lower > 0.005, "{found:?}");
    Ok(())
}

/// Steps of what overlaps once left a speck in a cube without a translation.
#[test]
fn what_is_tiny_leaves_what_is_large() -> Result<(), ShapeError> {
    let cube = Shape::<3>::cuboid([0.4; 3])?;
    let speck = Shape::<3>::ball(1e-6)?;
    known(&cube, &speck, along(0.1, 0.05, 0.02), 0.1 + 1e-6);
    let hollow = cube - Shape::<3>::ball(0.1)?.translated([-0.2, 0.0, 0.0])?;
    let found = asked(&hollow, &speck, along(0.1, 0.05, 0.02), &Limits::new(1e-3));
    assert!(found.lower <= 0.1 + 1e-6 && 0.1 <= found.upper, "{found:?}");
    assert!(found.upper < 0.102, "{found:?}");
    Ok(())
}

#[test]
fn a_small_budget_leaves_bounds_that_hold() -> Result<(), ShapeError> {
    let (angle, cube) = (angle()?, Shape::<3>::cuboid([1.0; 3])?.rotated(turned())?);
    for budget in [0, 1, 10, 100, 1000, 10_000] {
        let limits = Limits::new(1e-6).with_budget(budget);
        let found = bounded([&angle, &angle], Pose::identity(), 0.08_f64.sqrt(), &limits);
        assert_eq!(found.stop, Stop::BudgetSpent, "{found:?}");
        assert!(found.evaluations < budget + 4000, "{found:?}");
        let ask =
            |limits: &Limits| penetration(&cube, &cube, limits, &mut PairWorkspace::new());
        let found = ask(&limits).unwrap();
        assert!(found.lower <= 1.0 && 1.0 <= found.upper, "{found:?}");
    }
    Ok(())
}

#[test]
fn what_is_no_number_is_refused() -> Result<(), ShapeError> {
    let ball = Shape::<3>::ball(1.0)?;
    let ask = |pose: Pose<3>, tolerance: f64| {
        let limits = Limits::new(tolerance);
        penetration(&ball, Placed::new(&ball, pose), &limits, &mut PairWorkspace::new())
    };
    for wrong in [f64::NAN, f64::INFINITY] {
        let found = ask(along(wrong, 0.0, 0.0), 1e-4);
        assert_eq!(found, Err(QueryError::Pose { index: 1 }));
        let found = ask(Pose::identity(), wrong);
        assert!(matches!(found, Err(QueryError::Length { .. })), "{found:?}");
    }
    Ok(())
}
