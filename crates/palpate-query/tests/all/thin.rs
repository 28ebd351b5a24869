// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts of bodies that overlap by more than one of them is thick.

#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_query::{
    Contact, Limits, Manifold, ManifoldSettings, NormalSource, PairWorkspace, Placed, Track,
    manifold,
};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Outside, and how thick its wall is [m].
const RADIUS: f64 = 0.02;
const HEIGHT: f64 = 0.05;
const WALL: f64 = 0.003;

/// How far a step leads down [m].
const STEP: f64 = 1e-4;

/// An open cup about the origin, its axis along y.
fn cup() -> Shape<3> {
    let inside = Shape::cylinder(RADIUS - WALL, HEIGHT).unwrap();
    let inside = inside.translated([0.0, WALL, 0.0]).unwrap();
    Shape::difference(Shape::cylinder(RADIUS, HEIGHT).unwrap(), [inside]).unwrap()
}

fn floor() -> Shape<3> {
    Shape::cuboid([0.2, 0.1, 0.2]).unwrap().translated([0.0, -0.05, 0.0]).unwrap()
}

/// A cup that is tilted by this angle [rad], about an axis that is turned as far about y, with its
/// lowest point at this height [m].
fn tilted(angle: f64, lowest: f64) -> Pose<3> {
    let axis = Vector([angle.cos(), 0.0, angle.sin()]);
    let turn = Rotation::from_axis_angle(axis, angle).unwrap();
    // Of a cylinder.
    let below = 0.5 * HEIGHT * angle.cos().abs() + RADIUS * angle.sin().abs();
    Pose::new(turn, [0.0, lowest + below, 0.0])
}

fn deepest(found: &Manifold<3>) -> &Contact<3> {
    found.contacts.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)).unwrap()
}

/// Its wall's own gradient leads sideways; a floor that is 100 mm thick knows better.
#[test]
fn a_cup_that_sinks_into_a_floor_is_pushed_up() -> Outcome {
    let (floor, cup) = (floor(), cup());
    let settings = ManifoldSettings::of_size(RADIUS);
    let limits = Limits::new(0.5 * settings.margin);
    let mut workspace = PairWorkspace::new();
    for attitude in 0..10 {
        // Bottom down, and rim down.
        let angle = [0.15, 0.3, 0.5, 0.8, 1.2, 1.9, 2.2, 2.5, 2.8, 3.0][attitude];
        let mut track = Track::new(floor.clone(), cup.clone());
        for step in -2..=80 {
            let depth = f64::from(step) * STEP;
            let poses = [Pose::identity(), tilted(angle, -depth)];
            let found = track.manifold(poses, &settings, &limits, &mut workspace)?;
            if depth < 0.001 {
                continue;
            }
            let contact = deepest(&found);
            let said = format!("{angle} rad, {depth} m: {contact:?}");
            assert!(contact.normal[1] >= 0.7, "{said}");
            assert!((contact.gap + depth).abs() <= 0.2 * depth, "{said}");
            assert!(contact.gap <= found.separation.upper, "{said}");
        }
    }
    Ok(())
}

/// Without a past the floor tells the normal, and the contact says so.
#[test]
fn a_cup_in_a_floor_that_was_not_followed_says_so() -> Outcome {
    let (floor, cup) = (floor(), cup());
    let settings = ManifoldSettings::of_size(RADIUS);
    let limits = Limits::new(0.5 * settings.margin);
    let there = Placed::new(&cup, tilted(2.5, -0.006));
    let found = manifold(&floor, there, &settings, &limits, &mut PairWorkspace::new())?;
    let contact = deepest(&found);
    assert_eq!(contact.normal_from, NormalSource::ThickerBody, "{contact:?}");
    assert!(contact.normal[1] > 0.7 && (contact.gap + 0.006).abs() < 0.0012, "{contact:?}");
    Ok(())
}

/// The rest on a floor says nothing about plates that cross after a jump.
#[test]
fn a_contact_has_no_history_of_another() -> Outcome {
    let floor = Shape::<3>::cuboid([0.2, 0.02, 0.2])?.translated([0.0, -0.01, 0.0])?;
    let plate = Shape::<3>::cuboid([0.003, 0.04, 0.04])?.translated([0.05, 0.05, 0.0])?;
    let other = Shape::<3>::cuboid([0.04, 0.003, 0.04])?.translated([0.05, 0.05, 0.0])?;
    let block = Shape::<3>::cuboid([0.02, 0.02, 0.02])?.translated([-0.05, 0.01, 0.0])?;
    let settings = ManifoldSettings::of_size(0.02);
    let limits = Limits::new(0.5 * settings.margin);
    let mut workspace = PairWorkspace::new();
    let ground = Shape::union([floor, plate])?;
    let body = Shape::union([block, other])?;
    let mut track = Track::new(ground, body);
    // The block rests on the floor all the time.
    for step in 0..6 {
        let x = if step == 0 { -0.03 } else { 1e-5 * f64::from(step) };
        let poses = [Pose::identity(), Pose::translation([x, -1e-5, 0.0])];
        let found = track.manifold(poses, &settings, &limits, &mut workspace)?;
        if step == 0 {
            assert!(!found.contacts.is_empty() && found.separation.upper > -1e-4, "{found:?}");
            continue;
        }
        let crossing: Vec<_> =
            found.contacts.iter().filter(|contact| contact.point_a[0] > 0.02).collect();
        assert!(!crossing.is_empty());
        for contact in crossing {
            assert!(contact.normal_from != NormalSource::History, "{contact:?}");
        }
    }
    Ok(())
}

/// Of two plates neither is thick: what tells the side is where they came from, and how far they have
/// moved past each other.
#[test]
fn plates_that_pass_through_each_other_are_pushed_back() -> Outcome {
    let plate = Shape::<3>::cuboid([0.1, WALL, 0.1])?;
    let small = Shape::<3>::cuboid([0.04, WALL, 0.03])?;
    let settings = ManifoldSettings::of_size(0.02);
    let limits = Limits::new(0.5 * settings.margin);
    let mut workspace = PairWorkspace::new();
    let mut track = Track::new(plate.clone(), small.clone());
    let mut from_history = 0;
    for step in -2..=55 {
        let depth = f64::from(step) * STEP;
        let poses = [Pose::identity(), Pose::translation([0.01, WALL - depth, 0.0])];
        let found = track.manifold(poses, &settings, &limits, &mut workspace)?;
        if depth < 0.001 {
            continue;
        }
        let contact = deepest(&found);
        let said = format!("{depth} m: {contact:?}");
        assert!(contact.normal[1] >= 0.7, "{said}");
        assert!((contact.gap + depth).abs() <= 0.2 * depth, "{said}");
        from_history += usize::from(contact.normal_from == NormalSource::History);
    }
    assert!(from_history > 10, "{from_history}");
    // Whoever sees them first then sees the near side.
    let there = Placed::new(&small, Pose::translation([0.01, WALL - 0.0055, 0.0]));
    let found = manifold(&plate, there, &settings, &limits, &mut workspace)?;
    // The far side is nearer.
    assert!(deepest(&found).normal[1] < -0.7, "{:?}", deepest(&found));
    Ok(())
}
