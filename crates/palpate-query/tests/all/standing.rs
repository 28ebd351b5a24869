// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a solver needs of bodies that stand, tilt and start deep in each other.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use std::f64::consts::TAU;

use palpate_field::kernel::RegularStar;
use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_query::{
    Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, Track, TrackedContacts, manifold,
};

fn floor<const D: usize>() -> Shape<D> {
    Shape::half_space(Vector::unit(1), 0.0).unwrap()
}

/// The contacts of a pair in each of these steps.
fn steps<const D: usize>(
    [a, b]: [&Shape<D>; 2],
    poses: &[Pose<D>],
    settings: &ManifoldSettings,
) -> Vec<TrackedContacts<D>> {
    let mut track = Track::new(a.clone(), b.clone());
    let limits = Limits::new(settings.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    let step = |pose: &Pose<D>| {
        let poses = [Pose::identity(), *pose];
        track.contacts(poses, settings, &limits, &mut workspace).unwrap().clone()
    };
    poses.iter().map(step).collect()
}

#[test]
fn a_comb_stands_on_its_long_feet() {
    let foot = |x: f64, width: f64, y: f64| {
        [[x, 0.5], [x, y], [x + width, y], [x + width, 0.5]].map(Vector)
    };
    let mut outline = vec![Vector([1.0, 0.6]), Vector([0.0, 0.6])];
    for (x, width, y) in
        [(0.0, 0.01, 0.008), (0.25, 0.04, 0.0), (0.55, 0.05, 0.0), (0.99, 0.01, 0.008)]
    {
        outline.extend(foot(x, width, y));
    }
    let comb = Shape::<2>::polygon([outline]).unwrap();
    let settings = ManifoldSettings::for_solver(1.0);
    let found = &steps([&floor(), &comb], &[Pose::identity()], &settings)[0];
    let mut places: Vec<f64> = found.contacts.iter().map(|it| it.point_b[0]).collect();
    places.sort_by(f64::total_cmp);
    assert_eq!(found.groups, [2], "{places:?}");
    // Each foot is thinner than the spacing.
    assert!((0.25..=0.29).contains(&places[0]), "{places:?}");
    assert!((0.55..=0.6).contains(&places[1]), "{places:?}");
    assert!(found.contacts.iter().all(|contact| contact.gap.abs() < 1e-6));
}

#[test]
fn a_table_stands_on_its_long_legs() {
    let leg = |x: f64, z: f64, y: f64| {
        Shape::<3>::cuboid([0.02, 0.5 - y, 0.02]).unwrap().translated([x, 0.5 * (0.5 + y), z])
    };
    let mut parts =
        vec![Shape::cuboid([1.0, 0.05, 1.0]).unwrap().translated([0.0, 0.5, 0.0]).unwrap()];
    for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        parts.push(leg(0.3 * x, 0.3 * z, 0.0).unwrap());
        parts.push(leg(0.45 * x, 0.45 * z, 0.008).unwrap());
    }
    let table = Shape::union(parts).unwrap();
    let settings = ManifoldSettings::for_solver(1.0);
    let found = &steps([&floor(), &table], &[Pose::identity()], &settings)[0];
    assert_eq!(found.groups, [4], "{:?}", found.contacts);
    assert!(found.contacts.iter().all(|contact| contact.gap.abs() < 1e-6));
}

#[test]
fn a_torus_deep_in_a_floor_has_four_equal_contacts() {
    let torus = Shape::<3>::torus(0.1, 0.03).unwrap();
    let settings = ManifoldSettings::for_solver(Track::new(floor(), torus.clone()).size());
    for share in [0.0, 0.2, 0.3, 0.54, 0.8, 0.95] {
        let height = 0.03 - share * settings.margin;
        let pose = Pose::translation(Vector([0.01, height, 0.02]));
        let found = &steps([&floor(), &torus], &[pose], &settings)[0];
        assert_eq!(found.groups, [4], "{share}: {:?}", found.contacts);
        for contact in &found.contacts {
            assert!((contact.gap - (height - 0.03)).abs() < 1e-6, "{share}: {contact:?}");
            assert!((contact.normal - Vector::unit(1)).norm() < 1e-6, "{share}: {contact:?}");
        }
    }
}

#[test]
fn a_ball_has_one_contact_wherever_it_touches() {
    let ball = Shape::<3>::ball(0.4327).unwrap();
    let torus = Shape::<3>::torus(0.416, 0.0766).unwrap();
    let settings =
        ManifoldSettings { margin: 0.014, spacing: 0.112, most: 32, solver_slop: Some(0.0028) };
    let pose = Pose::translation(Vector([-0.0018, 0.3143, -0.0156]));
    let found = &steps([&torus, &ball], &[pose], &settings)[0];
    assert_eq!(found.groups, [1], "{:?}", found.contacts);
}

#[test]
fn the_normal_of_a_tilted_box_is_that_of_the_floor() {
    let plate = Shape::<2>::rectangle([0.3, 0.2]).unwrap();
    for tilt in [1e-5_f64, 1e-3, 5e-3, 9e-3, 0.02] {
        let turn = Rotation::from_angle(tilt).unwrap();
        let low = turn.rotate(Vector([-0.15, -0.1]));
        let pose = Pose::new(turn, Vector([0.0, -1e-5 - low[1]]));
        let settings = ManifoldSettings::for_solver(0.36);
        for found in steps([&floor(), &plate], &[pose; 3], &settings) {
            let deepest = found.contacts[0];
            assert!((deepest.normal - Vector::unit(1)).norm() < 1e-9, "{tilt}: {deepest:?}");
            let precise = 1e-4 * settings.margin;
            assert!((deepest.gap + 1e-5).abs() < precise, "{tilt}: {deepest:?}");
            let away = (deepest.point_b[0] - low[0]).abs() * tilt;
            assert!(away < precise, "{tilt}: {deepest:?}");
        }
    }
}

/// The steps of a pair at rest: each contact stays with one id, and is as old as the steps are many.
fn last<const D: usize>(found: &[TrackedContacts<D>]) {
    let ids = |found: &TrackedContacts<D>| -> Vec<u64> {
        found.contacts.iter().map(|contact| contact.id).collect()
    };
    for (step, now) in found.iter().enumerate() {
        assert_eq!(ids(now), ids(&found[0]), "step {step}");
        let ages: Vec<u32> = now.contacts.iter().map(|contact| contact.age).collect();
        assert!(ages.iter().all(|age| *age as usize == step), "step {step}: {ages:?}");
    }
}

#[test]
fn contacts_deeper_than_the_margin_keep_their_ids_and_ages() {
    let square = Shape::<2>::rectangle([0.3, 0.3]).unwrap();
    let settings = ManifoldSettings::for_solver(Track::new(floor(), square.clone()).size());
    let turn = Rotation::from_angle(0.78).unwrap();
    let height = 0.15 * 2.0_f64.sqrt() - 1.1 * settings.margin;
    last(&steps([&floor(), &square], &[Pose::new(turn, [0.0, height]); 4], &settings));
    let ring = Shape::<2>::ring(0.28, 0.3).unwrap();
    let bar = Shape::<2>::rectangle([1.0, 0.02]).unwrap();
    let settings = ManifoldSettings::for_solver(Track::new(ring.clone(), bar.clone()).size());
    let turn = Rotation::from_angle(-1.316_870_1).unwrap();
    let height = 0.763_192_862 - 1.3 * settings.margin;
    last(&steps([&ring, &bar], &[Pose::new(turn, [0.0, height]); 4], &settings));
}

#[test]
fn smooth_bodies_have_one_contact_also_with_a_larger_margin() {
    let capsule = Shape::<2>::capsule(0.0923, 0.647).unwrap();
    let ball = Shape::<2>::ball(0.499).unwrap();
    let mut track = Track::new(capsule, ball);
    let small = ManifoldSettings {
        margin: 0.0105,
        spacing: 0.0531,
        most: 32,
        solver_slop: Some(0.0013),
    };
    let mut workspace = PairWorkspace::new();
    for (step, y) in [0.8075, 0.8061, 0.8046, 0.8032, 0.8017].into_iter().enumerate() {
        let margin = if step == 0 { small.margin } else { 0.0198 };
        let settings = ManifoldSettings { margin, ..small };
        let limits = Limits::new(settings.usual_tolerance());
        let poses = [Pose::identity(), Pose::translation([-0.048, y])];
        let found = track.contacts(poses, &settings, &limits, &mut workspace).unwrap();
        assert_eq!(found.groups, [1], "step {step}: {:?}", found.contacts);
    }
}

#[test]
fn groups_stay_within_their_angle_where_bodies_start_deep() {
    let bar = Shape::<2>::rectangle([1.0, 0.02]).unwrap();
    let corners = [[-0.5, 0.0], [0.5, 0.0], [0.0, 0.3]].map(Vector);
    let wedge = Shape::<2>::polygon([corners.to_vec()]).unwrap();
    let settings = ManifoldSettings::for_solver(Track::new(bar.clone(), wedge.clone()).size());
    let pose = Pose::translation([0.0, 0.010_005 - 6.0 * settings.margin]);
    for found in steps([&bar, &wedge], &[pose; 3], &settings) {
        let mut start = 0;
        for count in &found.groups {
            let group = &found.contacts[start..start + count];
            start += count;
            for contact in group {
                assert!(contact.normal.dot(group[0].normal) > 0.996, "{group:?}");
                assert!(contact.gap >= group[0].gap, "{group:?}");
            }
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_track_whose_budget_ended_at_once_can_be_stored() {
    let ball = Shape::<3>::ball(0.1).unwrap();
    let mut track = Track::new(ball.clone(), ball.clone());
    let settings = ManifoldSettings::for_solver(track.size());
    let limits = Limits::new(settings.usual_tolerance()).with_budget(0);
    let poses = [Pose::identity(), Pose::translation([0.0, 0.2, 0.0])];
    track.contacts(poses, &settings, &limits, &mut PairWorkspace::new()).unwrap();
    let text = serde_json::to_string(track.memory()).unwrap();
    let memory: palpate_query::TrackMemory<3> = serde_json::from_str(&text).unwrap();
    let _ = Track::with_memory(ball.clone(), ball, memory);
}

/// The contacts of a tilted plate reach as far as the gap is within the margin, whatever the tolerance of the
/// separation.
#[test]
fn contacts_of_a_tilted_plate_reach_as_far_as_the_margin() {
    let plate = Shape::<2>::rectangle([1.0, 0.5]).unwrap();
    let settings =
        ManifoldSettings { margin: 0.002, spacing: 0.06, ..ManifoldSettings::of_size(1.0) };
    let turn = Rotation::from_angle(0.0008 / 0.48).unwrap();
    let low = turn.rotate(Vector([-0.5, -0.25]))[1];
    let there = Pose::new(turn, [0.0, 0.0012 - low]);
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let limits = Limits::new(tolerance);
        let mut workspace = PairWorkspace::new();
        let found: Manifold<2> =
            manifold(&floor(), Placed::new(&plate, there), &settings, &limits, &mut workspace)
                .unwrap();
        let far =
            found.contacts.iter().map(|it| it.point_b[0]).fold(f64::NEG_INFINITY, f64::max);
        assert!(!found.is_whole || far > -0.02 - 0.12, "{tolerance}: {far}");
    }
}

/// An id that lasts is one of a contact that has not turned: what a solver keeps by it acts along the
/// normal.
#[test]
fn no_contact_keeps_its_id_when_its_normal_turns() {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06).unwrap());
    let own = ManifoldSettings::for_solver(Track::new(star.clone(), star.clone()).size());
    for settings in [own, ManifoldSettings { margin: 0.0265, ..own }] {
        let ways = (0..6).map(|i| (0.02 * f64::from(i), 0.35 * f64::from(i)));
        for (height, angle) in ways {
            let poses: Vec<_> = (0..240)
                .map(|step| {
                    let s = f64::from(step) / 240.0;
                    let turn = Rotation::from_angle(angle + s).unwrap();
                    Pose::new(turn, [0.3 - 0.6 * s, 0.15 - height])
                })
                .collect();
            let found = steps([&star, &star], &poses, &settings);
            for (step, pair) in found.windows(2).enumerate() {
                for now in &pair[1].contacts {
                    let before = pair[0].contacts.iter().find(|last| last.id == now.id);
                    let Some(before) = before else { continue };
                    let cosine = now.normal.dot(before.normal);
                    assert!(cosine > 0.69, "step {step}: {before:?} {now:?}");
                }
            }
        }
    }
}

/// The middle of the line may carry before its ends do.
#[test]
fn a_cylinder_that_lies_is_held_at_both_of_its_ends() {
    let cylinder = Shape::<3>::cylinder(0.05, 0.2).unwrap();
    let settings = ManifoldSettings::for_solver(Track::new(floor(), cylinder.clone()).size());
    let height = 0.05 - 0.1 * settings.margin;
    for spin in (0..60).map(|i| 0.1 * f64::from(i)) {
        let turn = |axis: [f64; 3], angle| Rotation::from_axis_angle(axis, angle).unwrap();
        let lying = turn([0.0, 1.0, 0.0], spin) * turn([0.0, 0.0, 1.0], 0.25 * TAU);
        let pose = Pose::new(lying, Vector([0.013, height, -0.02]));
        let found = &steps([&floor(), &cylinder], &[pose], &settings)[0];
        let axis = pose.transform_vector(Vector::unit(1));
        let places = found.contacts.iter();
        let places = places.map(|contact| (contact.point_b - pose.translation).dot(axis));
        let [first, last] =
            places.fold([0.0_f64; 2], |[low, high], at| [low.min(at), high.max(at)]);
        assert!(first < -0.08 && last > 0.08, "{spin}: from {first} to {last}");
    }
}
