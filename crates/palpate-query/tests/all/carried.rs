// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts that are carried with their bodies, against closed forms: every one has the normal and the
//! gap that the place has, not only the deepest.
//!
//! Corners that were put back on the surfaces once took the gradient of a side face as soon as the body
//! sank by more than they were away from it: normals of 45° with gaps of the side, which stayed at rest.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::kernel::HalfSpace;
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{Limits, Manifold, ManifoldSettings, PairWorkspace, Track};

const SETTINGS: ManifoldSettings = ManifoldSettings::of_size(1.0);
const MARGIN: f64 = SETTINGS.margin;

/// A table whose top is at height zero, and the half space below it.
fn grounds() -> Result<[Shape<3>; 2], ShapeError> {
    let table = Shape::<3>::cuboid([4.0, 1.0, 4.0])?.translated([0.0, -0.5, 0.0])?;
    let below = HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?;
    Ok([table, Shape::from_kernel(below)])
}

/// Follows a cube over each ground, as the second body and as the first, through poses with the height of
/// its lower face; each contact has its gap and the normal of the ground.
fn follow(poses: impl Fn(usize) -> (Pose<3>, f64)) -> Result<(), ShapeError> {
    let cube = Shape::<3>::cuboid([1.0; 3])?;
    let limits = Limits::new(0.05 * MARGIN);
    let mut workspace = PairWorkspace::new();
    for ground in grounds()? {
        for is_first in [false, true] {
            let bodies = if is_first { [&cube, &ground] } else { [&ground, &cube] };
            let mut track = Track::new(bodies[0].clone(), bodies[1].clone());
            for step in 0..200 {
                let (pose, height) = poses(step);
                let both =
                    if is_first { [pose, Pose::identity()] } else { [Pose::identity(), pose] };
                let found = track.manifold(both, &SETTINGS, &limits, &mut workspace).unwrap();
                assert!(found.contacts.len() >= 4, "step {step}: {found:?}");
                let up = if is_first { -1.0 } else { 1.0 };
                for contact in &found.contacts {
                    let is_true = (contact.gap - height).abs() <= 0.1 * MARGIN
                        && up * contact.normal[1] > 0.99;
                    assert!(is_true, "step {step}, {height} m: {contact:?}");
                }
            }
        }
    }
    Ok(())
}

#[test]
fn a_cube_that_is_pressed_down_and_let_up() -> Result<(), ShapeError> {
    for speed in [0.02, 0.1, 0.3, 1.0] {
        follow(|step| {
            let depth = 2.0 * MARGIN * (0.8 * speed * step as f64).sin().abs();
            (Pose::translation(Vector([0.1, 0.5 - depth, 0.1])), -depth)
        })?;
    }
    Ok(())
}

#[test]
fn a_cube_that_slides_and_spins() -> Result<(), ShapeError> {
    for (depth, speed) in [(0.05, 0.1), (0.2, 0.6), (0.5, 1.4)] {
        follow(|step| {
            let way = speed * MARGIN * step as f64;
            let turn = Rotation::from_axis_angle([0.0, 1.0, 0.0], way).unwrap();
            let there = Vector([way - 0.2, 0.5 - depth * MARGIN, 0.1]);
            (Pose::new(turn, there), -depth * MARGIN)
        })?;
    }
    Ok(())
}

/// Where the margin is larger than the spacing, a cube that sinks is in the ground by as much everywhere.
#[test]
fn a_margin_above_the_spacing() -> Result<(), ShapeError> {
    let (cube, [table, _]) = (Shape::<3>::cuboid([1.0; 3])?, grounds()?);
    let settings =
        ManifoldSettings { margin: 0.1, spacing: 0.02, ..ManifoldSettings::of_size(1.0) };
    let mut track = Track::new(table, cube);
    let mut workspace = PairWorkspace::new();
    for step in 0..100 {
        let height = 0.03 - 0.002 * f64::from(step);
        let poses = [Pose::identity(), Pose::translation(Vector([0.1, 0.5 + height, 0.1]))];
        let limits = Limits::new(0.005);
        let found = track.manifold(poses, &settings, &limits, &mut workspace).unwrap();
        for contact in &found.contacts {
            assert!(
                (contact.gap - height).abs() <= 0.025,
                "step {step}, {height} m: {contact:?}"
            );
        }
    }
    Ok(())
}

/// A plate on three feet that slides: its sole, which is nearer to the ground than 2.5 margins, once became
/// one patch with the feet, of which one foot was left.
#[test]
fn feet_under_a_plate_keep_their_contacts() -> Result<(), ShapeError> {
    let feet = [[-0.4, -0.3], [0.4, -0.3], [0.0, 0.4]];
    let touches = |found: &Manifold<3>, [x, z]: [f64; 2]| {
        let near = |p: Vector<f64, 3>| (p[0] - x).hypot(p[2] - z) < 0.07;
        found.contacts.iter().any(|contact| contact.gap < 0.0 && near(contact.point_a))
    };
    for height in [1.1, 2.0, 3.0] {
        let plate = Shape::<3>::cuboid([1.0, 0.1, 1.0])?;
        let mut parts = vec![plate.translated([0.0, 0.05 + height * MARGIN, 0.0])?];
        for [x, z] in feet {
            parts.push(Shape::<3>::cylinder(0.05, 0.05)?.translated([x, 0.025, z])?);
        }
        let body = Shape::union(parts)?;
        for ground in grounds()? {
            let mut track = Track::new(ground, body.clone());
            let mut workspace = PairWorkspace::new();
            for step in 0..60 {
                let way = 0.15 * MARGIN * f64::from(step);
                let there = Pose::translation(Vector([way, -0.05 * MARGIN, 0.1]));
                let poses = [Pose::identity(), there];
                let limits = Limits::new(0.5 * MARGIN);
                let found = track.manifold(poses, &SETTINGS, &limits, &mut workspace).unwrap();
                for [x, z] in feet {
                    assert!(
                        touches(&found, [x + way, z + 0.1]),
                        "{height}, step {step}: {found:?}"
                    );
                }
            }
        }
    }
    Ok(())
}

/// A region that a small budget cut off is searched again once the budget is larger.
#[test]
fn a_larger_budget_completes_a_region() -> Result<(), ShapeError> {
    let (cube, [table, _]) = (Shape::<3>::cuboid([1.0; 3])?, grounds()?);
    let mut track = Track::new(table, cube);
    let mut workspace = PairWorkspace::new();
    let poses = [Pose::identity(), Pose::translation(Vector([0.1, 0.4998, 0.1]))];
    let limits = Limits::new(0.5 * MARGIN);
    for (limits, is_whole) in [(limits.with_budget(200), false), (limits, true)] {
        let found = track.manifold(poses, &SETTINGS, &limits, &mut workspace).unwrap();
        assert_eq!(found.is_whole, is_whole);
    }
    Ok(())
}
