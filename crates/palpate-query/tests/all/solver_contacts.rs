// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts for a solver: few, exact, lasting, and cheap while bodies rest.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use assert_no_alloc::assert_no_alloc;
use palpate_field::kernel::{CoolS, RegularStar};
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{
    Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, Track, manifold, separation,
};
use palpate_testkit::arbitrary::within;
use palpate_testkit::cases;

/// The largest sum of both unit gradients at a contact.
const OPPOSITE: f64 = 1e-6;

fn in_space(turn: f64, place: [f64; 3]) -> Pose<3> {
    let turn = Rotation::from_axis_angle(Vector([0.6, 0.0, 0.8]), turn).unwrap();
    Pose::new(turn, Vector(place))
}

fn in_the_plane(turn: f64, place: [f64; 2]) -> Pose<2> {
    Pose::new(Rotation::from_angle(turn).unwrap(), Vector(place))
}

fn for_solver<const D: usize>(
    a: &Shape<D>,
    b: &Shape<D>,
    pose: Pose<D>,
    tolerance: f64,
) -> Manifold<D> {
    let settings = ManifoldSettings::for_solver(Track::new(a.clone(), b.clone()).size());
    let limits = Limits::new(tolerance);
    let b = Placed::new(b, pose);
    manifold(a, b, &settings, &limits, &mut PairWorkspace::new()).unwrap()
}

#[test]
fn a_ball_has_one_contact_whose_normal_is_exact_whatever_the_tolerance() {
    let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    let ball = Shape::<3>::ball(0.08).unwrap();
    for tolerance in [1e-2, 1e-3, 1e-5] {
        for gap in [-5e-4, -1e-6, 0.0, 1e-6, 5e-4] {
            let pose = in_space(0.3, [0.013, 0.08 + gap, -0.021]);
            let found = for_solver(&floor, &ball, pose, tolerance);
            assert_eq!(found.groups, [1], "tolerance {tolerance} gap {gap}");
            let contact = found.contacts[0];
            assert!((contact.normal - Vector([0.0, 1.0, 0.0])).norm() <= OPPOSITE);
            assert!((contact.gap - gap).abs() < 1e-12, "{} for {gap}", contact.gap);
            let foot = Vector([0.013, gap, -0.021]);
            assert!((contact.point_b - foot).norm() < 1e-7, "{:?}", contact.point_b);
        }
    }
}

/// Shapes that lie on a floor, their heights and how many contacts hold them.
fn lying() -> Result<Vec<(&'static str, Shape<3>, f64, usize)>, ShapeError> {
    let upright = |shape: Shape<3>| shape.placed(&in_space_about([0.0, 0.0, 1.0], 0.25));
    Ok(vec![
        ("cube", Shape::cuboid([0.2, 0.2, 0.2])?, 0.1, 4),
        ("board", Shape::cuboid([0.3, 0.002, 0.2])?, 0.001, 4),
        ("coin", Shape::cylinder(0.1, 0.01)?, 0.005, 4),
        ("capsule", upright(Shape::capsule(0.02, 0.3)?)?, 0.02, 2),
        ("rod", upright(Shape::cylinder(0.01, 0.5)?)?, 0.01, 2),
        ("torus", Shape::torus(0.1, 0.03)?, 0.03, 4),
    ])
}

fn in_space_about(axis: [f64; 3], turns: f64) -> Pose<3> {
    let turn = Rotation::from_axis_angle(axis, turns * std::f64::consts::TAU).unwrap();
    Pose::new(turn, Vector::ZERO)
}

#[test]
fn bodies_that_lie_have_as_many_contacts_as_hold_them() {
    let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    for (name, shape, height, count) in lying().unwrap() {
        for gap in [-2e-4, 0.0, 2e-4] {
            let pose = in_space_about([0.0, 1.0, 0.0], 0.07);
            let pose = Pose::new(pose.rotation, Vector([0.01, height + gap, 0.02]));
            let found = for_solver(&floor, &shape, pose, 1e-3);
            let note = format!("{name} at {gap}: {:?}", found.contacts);
            assert_eq!(found.groups, [count], "{note}");
            for contact in &found.contacts {
                assert!(
                    (contact.normal - Vector([0.0, 1.0, 0.0])).norm() <= OPPOSITE,
                    "{note}"
                );
                assert!((contact.gap - gap).abs() < 1e-9, "{note}");
            }
        }
    }
}

#[test]
fn a_box_in_the_plane_has_two_contacts_and_a_corner_between_two_walls_two_groups() {
    let floor = Shape::<2>::half_space([0.0, 1.0], 0.0).unwrap();
    let plate = Shape::<2>::rectangle([0.3, 0.1]).unwrap();
    let found = for_solver(&floor, &plate, in_the_plane(0.0, [0.0, 0.0499]), 1e-3);
    assert_eq!(found.groups, [2]);
    let apart = found.contacts[0].point_b - found.contacts[1].point_b;
    assert!((apart.norm() - 0.3).abs() < 2e-3, "{apart:?}");
    let wall = Shape::<2>::half_space([1.0, 0.0], -0.15).unwrap();
    let corner = Shape::union([floor, wall]).unwrap();
    let found = for_solver(&corner, &plate, in_the_plane(0.0, [-0.0001, 0.0499]), 1e-3);
    assert_eq!(found.groups.len(), 2, "{:?}", found.contacts);
}

/// A pair at rest: its name, its shapes, and where the second one is.
type Pair<const D: usize> = (&'static str, [Shape<D>; 2], Pose<D>);

fn resting_in_space() -> Vec<Pair<3>> {
    let cube = Shape::<3>::cuboid([0.1; 3]).unwrap();
    let large = Shape::<3>::cuboid([0.4, 0.1, 0.4]).unwrap();
    let cup = Shape::<3>::cylinder(0.1, 0.2).unwrap()
        - Shape::<3>::cylinder(0.085, 0.2).unwrap().translated([0.0, 0.015, 0.0]).unwrap();
    let leg = |x: f64, z: f64| {
        Shape::<3>::cuboid([0.01, 0.3, 0.01]).unwrap().translated([x, -0.15, z]).unwrap()
    };
    let top = Shape::<3>::cuboid([0.4, 0.02, 0.4]).unwrap();
    let table = Shape::union([
        top,
        leg(0.19, 0.19),
        leg(-0.19, 0.19),
        leg(0.19, -0.19),
        leg(-0.19, -0.19),
    ]);
    vec![
        ("boxes", [large.clone(), cube.clone()], in_space(0.0, [0.1, 0.0999, 0.05])),
        ("cup and cube", [cup, cube.clone()], in_space(0.0, [0.0, -0.0351, 0.0])),
        ("table and cube", [table.unwrap(), cube], in_space(0.0, [0.05, 0.0599, -0.03])),
    ]
}

fn resting_in_the_plane() -> Vec<Pair<2>> {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06).unwrap());
    let floor = Shape::<2>::half_space([0.0, 1.0], 0.0).unwrap();
    let cool = Shape::from_kernel(CoolS::new(0.3).unwrap());
    let height = 0.12 * (0.1 * std::f64::consts::TAU).cos();
    let onto = |a: &Shape<2>, b: &Shape<2>, turn, x| onto(a, b, in_the_plane(turn, [x, 1.0]));
    vec![
        ("floor and star", [floor, star.clone()], in_the_plane(0.0, [0.0, height - 1e-4])),
        ("star on star", [star.clone(), star.clone()], onto(&star, &star, 0.1, 0.03)),
        ("Cool S on Cool S", [cool.clone(), cool.clone()], onto(&cool, &cool, 0.4, 0.05)),
    ]
}

/// The second body let down onto the first until they overlap by up to 0.2 mm.
fn onto<const D: usize>(a: &Shape<D>, b: &Shape<D>, above: Pose<D>) -> Pose<D> {
    let (mut workspace, limits) = (PairWorkspace::new(), Limits::new(2e-5));
    let mut pose = above;
    loop {
        let apart = separation(a, Placed::new(b, pose), &limits, &mut workspace).unwrap();
        if apart.upper <= 0.0 {
            return pose;
        }
        pose.translation[1] -= apart.lower.max(0.0) + 5e-5;
    }
}

/// A motion of a pair at rest, as a solver leaves it.
fn trembling<const D: usize>(pose: &Pose<D>, step: u32) -> Pose<D> {
    let mut moved = *pose;
    moved.translation[0] += 1e-9 * f64::from(step % 5);
    moved.translation[1] -= 1e-9 * f64::from(step % 3);
    moved
}

/// The evaluations of each body for each contact of a step at rest.
fn cost_at_rest<const D: usize>((name, shapes, pose): Pair<D>) -> f64 {
    let [a, b] = shapes;
    let mut track = Track::new(a, b);
    let settings = ManifoldSettings::for_solver(track.size());
    let limits = Limits::new(settings.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    let (mut most, mut count) = (0.0_f64, 0);
    for step in 0..100 {
        let poses = [Pose::identity(), trembling(&pose, step)];
        let (track, memory) = (&mut track, &mut workspace);
        let found = if step == 0 {
            track.contacts(poses, &settings, &limits, memory).unwrap()
        } else {
            assert_no_alloc(|| track.contacts(poses, &settings, &limits, memory).unwrap())
        };
        assert!(found.is_whole && !found.contacts.is_empty(), "{name}");
        assert_eq!(found.is_searched, step == 0, "{name} in step {step}");
        assert!(found.contacts.iter().all(|contact| contact.age == step), "{name}");
        count = found.contacts.len();
        if step > 0 {
            // A value with its gradient counts twice, for each of both bodies.
            most = most.max(f64::from(found.evaluations) / 4.0 / count as f64);
        }
    }
    println!("{name}: {most} for each of {} contacts", count);
    most
}

#[test]
fn a_pair_at_rest_costs_few_evaluations_and_no_allocation() {
    for pair in resting_in_space() {
        let cost = cost_at_rest(pair);
        assert!(cost <= 6.0, "{cost}");
    }
    for pair in resting_in_the_plane() {
        let cost = cost_at_rest(pair);
        assert!(cost <= 6.0, "{cost}");
    }
}

/// Poses of a cube that slides, sinks and tilts on a floor.
#[cfg(feature = "serde")]
fn poses_of_a_cube() -> impl Iterator<Item = [Pose<3>; 2]> {
    (0..200).map(|step| {
        let t = f64::from(step);
        let tilt = Rotation::from_axis_angle([0.0, 0.0, 1.0], 2e-5 * t).unwrap();
        let place = Vector([2e-4 * t, 0.0499 + 2e-6 * t, 1e-4 * t]);
        [Pose::identity(), Pose::new(tilt, place)]
    })
}

fn floor_and_cube() -> [Shape<3>; 2] {
    let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    [floor, Shape::<3>::cuboid([0.1; 3]).unwrap()]
}

#[cfg(feature = "serde")]
#[test]
fn equal_calls_give_equal_contacts_ids_and_ages_also_after_a_snapshot() {
    let [floor, cube] = floor_and_cube();
    let new = || Track::new(floor.clone(), cube.clone());
    let (mut one, mut other, mut restored) = (new(), new(), new());
    let settings = ManifoldSettings::for_solver(one.size());
    let limits = Limits::new(settings.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    for (step, poses) in poses_of_a_cube().enumerate() {
        let first = one.contacts(poses, &settings, &limits, &mut workspace).unwrap();
        let second = other.contacts(poses, &settings, &limits, &mut workspace).unwrap();
        assert_eq!(first, second, "step {step}");
        let third = restored.contacts(poses, &settings, &limits, &mut workspace).unwrap();
        assert_eq!(first, third, "step {step}, restored");
        if step % 37 == 0 {
            let text = serde_json::to_string(restored.memory()).unwrap();
            let memory = serde_json::from_str(&text).unwrap();
            restored = Track::with_memory(floor.clone(), cube.clone(), memory);
        }
    }
}

#[test]
fn a_smaller_margin_asks_for_no_search_and_a_larger_one_keeps_the_ids() {
    let [floor, cube] = floor_and_cube();
    let mut track = Track::new(floor, cube);
    let own = ManifoldSettings::for_solver(track.size());
    let limits = Limits::new(own.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    let poses = [Pose::identity(), Pose::translation(Vector([0.0, 0.0499, 0.0]))];
    let mut ids = Vec::new();
    for (factor, is_searched) in [(1.0, true), (0.5, false), (1.0, false), (4.0, true)] {
        let settings = ManifoldSettings { margin: factor * own.margin, ..own };
        let found = track.contacts(poses, &settings, &limits, &mut workspace).unwrap();
        assert_eq!(found.is_searched, is_searched, "{factor}");
        let mut now: Vec<u64> = found.contacts.iter().map(|contact| contact.id).collect();
        now.sort_unstable();
        if ids.is_empty() {
            ids.clone_from(&now);
        }
        assert_eq!(now, ids, "{factor}");
    }
}

/// What the contacts of a moving pair must be: no shallower than the bodies are proven to be, and on
/// the surfaces with opposite normals or at an edge.
fn contacts_tell_the_depth<const D: usize>(
    [a, b]: [Shape<D>; 2],
    poses: &[Pose<D>],
) -> Result<(), String> {
    let mut track = Track::new(a.clone(), b.clone());
    let settings = ManifoldSettings::for_solver(track.size());
    let limits = Limits::new(settings.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    for (step, pose) in poses.iter().enumerate() {
        let there = [Pose::identity(), *pose];
        let found = track.contacts(there, &settings, &limits, &mut workspace);
        let found = found.map_err(|error| error.to_string())?.clone();
        let proof = separation(&a, Placed::new(&b, *pose), &limits, &mut workspace);
        let proof = proof.map_err(|error| error.to_string())?;
        if found.separation_at_least > proof.upper {
            let bound = found.separation_at_least;
            return Err(format!("step {step}: {bound} m is no bound of {} m", proof.upper));
        }
        let gaps = found.contacts.iter().map(|contact| contact.gap);
        let deepest = gaps.fold(settings.margin, f64::min);
        // What moves may hide a part of the way since the search.
        let hidden = deepest - proof.upper;
        if hidden > 0.3 * settings.margin {
            return Err(format!(
                "step {step}: the deepest contact is at {deepest} m where the bodies are at {} m",
                proof.upper
            ));
        }
    }
    Ok(())
}

#[test]
fn contacts_of_moving_stars_and_boxes_tell_their_depth() {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06).unwrap());
    let cool = Shape::from_kernel(CoolS::new(0.3).unwrap());
    let plate = Shape::<2>::rectangle([0.3, 0.05]).unwrap();
    let shapes = [star, cool, plate];
    cases::check(300, |u| {
        let mut any = || shapes[u.choose_index(3).unwrap_or(0)].clone();
        let pair = [any(), any()];
        let start =
            in_the_plane(within(u, 0.0, std::f64::consts::TAU)?, [within(u, -0.1, 0.1)?, 0.5]);
        let pose = onto(&pair[0], &pair[1], start);
        let way = [within(u, -2e-3, 2e-3)?, within(u, -1e-3, 1e-3)?];
        let spin = within(u, -0.01, 0.01)?;
        let poses: Vec<_> = (0..40)
            .map(|step| {
                let t = f64::from(step);
                let turn = Rotation::from_angle(spin * t).unwrap() * pose.rotation;
                Pose::new(turn, pose.translation + Vector(way) * t)
            })
            .collect();
        Ok(contacts_tell_the_depth(pair, &poses))
    });
}
