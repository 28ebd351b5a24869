// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Screws from pose to pose.

use std::f64::consts::PI;

use palpate_field::{Pose, Rotation, Screw, Vector};
use palpate_testkit::cases::each as cases;

fn pose<const D: usize>(turn: [f64; 3], translation: [f64; D]) -> Pose<D> {
    Pose::new(Rotation::identity().turned(turn), Vector(translation))
}

fn difference<const D: usize>(a: &Pose<D>, b: &Pose<D>) -> f64 {
    (a.translation - b.translation).norm() + a.rotation.turn_to(&b.rotation).norm()
}

#[test]
fn steps_of_equal_length_are_the_same_motion_of_the_body() {
    cases(300, |u| {
        let mut draw = || u.int_in_range(-1000..=1000).map(|x| f64::from(x) * 2e-3);
        let from = pose([draw()?, draw()?, draw()?], [draw()?, draw()?, draw()?]);
        let by = pose([draw()?, draw()?, 0.7 * draw()?], [draw()?, draw()?, draw()?]);
        let turns = u.int_in_range(-2..=2)?;
        let screw = Screw::new(from, from * by, turns).unwrap();
        let step = screw.pose(0.0).inverse() * screw.pose(0.125);
        let mut stepped = from;
        for i in 1..=8 {
            stepped = stepped * step;
            let off = difference(&stepped, &screw.pose(0.125 * f64::from(i)));
            assert!(off < 1e-11, "{off:e} at step {i} of {screw:?}");
        }
        Ok(())
    });
}

#[test]
fn a_motion_in_the_plane_is_one_in_space_about_z() {
    cases(200, |u| {
        let mut draw = || u.int_in_range(-1000..=1000).map(|x| f64::from(x) * 3e-3);
        let (turn, [x, y]) = (draw()?, [draw()?, draw()?]);
        let flat = Screw::new(Pose::identity(), pose([0.0, 0.0, turn], [x, y]), 0).unwrap();
        let to = pose([0.0, 0.0, turn], [x, y, 0.0]);
        let solid = Screw::new(Pose::identity(), to, 0).unwrap();
        let share = 0.3;
        let [x, y] = flat.pose(share).translation.0;
        assert!((solid.pose(share).translation - Vector([x, y, 0.0])).norm() < 1e-14);
        Ok(())
    });
}

#[test]
fn small_rotations_lose_no_digits() {
    for angle in [0.0, 1e-15, 1e-10, 1e-8, 1e-5] {
        let to = pose([0.0, 0.0, angle], [0.3, 0.1]);
        let screw = Screw::new(Pose::identity(), to, 0).unwrap();
        let off = screw.pose(0.25).translation - Vector([0.075, 0.025]);
        assert!(off.norm() <= 0.1 * angle + 1e-16, "{off:?} at {angle:e}");
    }
}

#[test]
fn a_nut_turns_about_its_bolt_as_it_advances() {
    let screw =
        Screw::new(Pose::identity(), Pose::translation(Vector([0.0, 0.02, 0.0])), 5).unwrap();
    let quarter = screw.pose(0.05);
    assert!((quarter.translation - Vector([0.0, 0.001, 0.0])).norm() < 1e-17);
    let x = quarter.rotation.rotate(Vector([1.0, 0.0, 0.0]));
    assert!((x - Vector([0.0, 0.0, -1.0])).norm() < 1e-14, "{x:?}");
    assert_eq!(screw.pose(1.0), *screw.to());
}

#[test]
fn whole_turns_of_a_translation_in_the_plane_are_refused() {
    let to = Pose::translation(Vector([0.1, 0.0]));
    let error = Screw::new(Pose::identity(), to, 1).unwrap_err();
    assert_eq!(error.to_string(), "turns must be 0 for a translation in the plane, got 1");
    assert!(Screw::new(to, to, 1).is_ok());
}

/// The derivative of a point's place in the world, turned into the body.
#[test]
fn velocities_are_the_derivatives_of_places() {
    cases(300, |u| {
        let mut draw = || u.int_in_range(-1000..=1000).map(|x| f64::from(x) * 2e-3);
        let from = pose([draw()?, draw()?, draw()?], [draw()?, draw()?, draw()?]);
        let by = pose([draw()?, draw()?, 0.7 * draw()?], [draw()?, draw()?, draw()?]);
        let p = Vector([draw()?, draw()?, draw()?]);
        let turns = u.int_in_range(-2..=2)?;
        let screw = Screw::new(from, from * by, turns).unwrap();
        for share in [0.25, 0.5, 0.75] {
            let at = |share: f64| screw.pose(share).transform_point(p);
            let step = 1e-5;
            let moved = (at(share + step) - at(share - step)) * (0.5 / step);
            let seen = screw.pose(share).inverse().transform_vector(moved);
            let off = (seen - screw.velocity(p)).norm();
            assert!(off < 1e-6, "{off:e} at {share} of {screw:?}");
        }
        Ok(())
    });
    // A translation.
    let screw = Screw::new(Pose::identity(), pose([0.0; 3], [1.0, 2.0, 3.0]), 0).unwrap();
    assert_eq!(screw.velocity(Vector([5.0, 6.0, 7.0])), Vector([1.0, 2.0, 3.0]));
}

#[test]
fn a_part_of_a_motion_goes_the_same_way() {
    cases(500, |u| {
        let mut draw = || u.int_in_range(-1000..=1000).map(|x| f64::from(x) * 2e-3);
        let from = pose([draw()?, draw()?, draw()?], [draw()?, draw()?, draw()?]);
        let by = pose([draw()?, draw()?, 0.7 * draw()?], [draw()?, draw()?, draw()?]);
        let [first, last] = [0.5 + 0.25 * draw()?, 0.5 + 0.25 * draw()?];
        let turns = u.int_in_range(-3..=3)?;
        let screw = Screw::new(from, from * by, turns).unwrap();
        let angle = (screw.angle() * (last - first)).abs();
        let part = screw.part(first, last);
        if angle >= PI {
            assert!(part.is_err(), "{angle}");
            return Ok(());
        }
        for i in 0..=8 {
            let share = f64::from(i) / 8.0;
            let here = part.as_ref().unwrap().pose(share);
            let off = difference(&here, &screw.pose(first + (last - first) * share));
            // Near half a turn the axis of the part is less exact.
            assert!(off * (PI - angle) < 1e-9, "{off:e} of {screw:?} from {first} to {last}");
        }
        Ok(())
    });
}
