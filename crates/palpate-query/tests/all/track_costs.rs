// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What it costs to follow a pair, beside a search anew for each step: never more, and hardly
//! anything in small motions.
//!
//! Evaluations are counted, which are the same on every machine.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::operator::Profile;
use palpate_field::{Aabb, Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{
    Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, Track, manifold, separation,
};

/// Bodies are about as large [m].
const SIZE: f64 = 0.02;

/// Steps of a pair, which goes to and fro in as many.
const STEPS: u32 = 60;
const FRO: u32 = 10;

/// How far a body moves in a step [m].
const MOTIONS: [f64; 5] = [0.0, 1e-6, 1e-5, 1e-4, 1e-3];

/// The gaps of pairs [m]: apart, touching, deep.
const GAPS: [f64; 3] = [5e-3, 0.0, -1e-3];

/// A pair whose second body is above the first, and the height at which both touch [m].
struct Pair<const D: usize> {
    name: &'static str,
    bodies: [Shape<D>; 2],
    height: f64,
}

fn in_space() -> Result<Vec<Pair<3>>, ShapeError> {
    let cube = Shape::<3>::cuboid([SIZE; 3])?;
    let table = Shape::<3>::cuboid([0.4, 0.02, 0.4])?;
    let ball = Shape::<3>::ball(0.5 * SIZE)?;
    let torus = Shape::<3>::torus(0.015, 0.004)?;
    let ring = Shape::<3>::torus(0.02, 0.002)?;
    let cup = Shape::<3>::cylinder(0.02, 0.04)?
        - Shape::<3>::cylinder(0.017, 0.04)?.translated([0.0, 0.003, 0.0])?;
    let upright = |shape: &Shape<3>| -> Result<Shape<3>, ShapeError> {
        let quarter = Rotation::from_axis_angle([1.0, 0.0, 0.0], 0.5 * std::f64::consts::PI)?;
        shape.clone().placed(&Pose::new(quarter, Vector::ZERO))
    };
    let blend = Shape::smooth_union(
        [cube.clone(), ball.clone().translated([0.01, 0.0, 0.0])?],
        Profile::Cubic,
        0.002,
    )?;
    let pair = |name, a: &Shape<3>, b: &Shape<3>, height| Pair {
        name,
        bodies: [a.clone(), b.clone()],
        height,
    };
    Ok(vec![
        pair("table, cube", &table, &cube, 0.02),
        pair("table, torus", &table, &torus, 0.014),
        pair("table, cup", &table, &cup, 0.03),
        pair("cup, cube", &cup, &cube, -0.007),
        pair("cup, cup", &cup, &cup, 0.04),
        pair("cup, ball", &cup, &ball, -0.007),
        pair("cube, cube", &cube, &cube, 0.02),
        pair("torus, torus", &torus, &torus, 0.008),
        pair("torus, ring on edge", &torus, &upright(&ring)?, 0.026),
        pair("blend, torus", &blend, &torus, 0.014),
        pair("ball, ball", &ball, &ball, 0.02),
    ])
}

fn in_the_plane() -> Result<Vec<Pair<2>>, ShapeError> {
    let floor = Shape::<2>::cuboid([0.4, 0.02])?;
    let square = Shape::<2>::cuboid([SIZE; 2])?;
    let disc = Shape::<2>::ball(0.5 * SIZE)?;
    let notched = floor.clone() - disc.clone().translated([0.0, 0.01])?;
    Ok(vec![
        Pair { name: "floor, square", bodies: [floor.clone(), square.clone()], height: 0.02 },
        Pair { name: "floor, disc", bodies: [floor, disc.clone()], height: 0.02 },
        Pair { name: "notch, disc", bodies: [notched, disc], height: 0.01 },
    ])
}

/// Evaluations of all steps: followed, and anew.
fn costs<const D: usize>(
    pair: &Pair<D>,
    gap: f64,
    limits: &Limits,
    pose: impl Fn(f64) -> Pose<D>,
) -> [u32; 2] {
    let [a, b] = &pair.bodies;
    let mut track = Track::new(a.clone(), b.clone());
    let mut workspace = PairWorkspace::new();
    let mut costs = [0; 2];
    for step in 0..STEPS {
        let phase = step % (2 * FRO);
        let way = f64::from(if phase < FRO { phase } else { 2 * FRO - phase });
        let mut there = pose(way);
        there.translation[1] += pair.height + gap;
        let warm = track.separation([Pose::identity(), there], limits, &mut workspace).unwrap();
        let cold = separation(a, Placed::new(b, there), limits, &mut workspace).unwrap();
        assert!(warm.lower <= cold.upper && cold.lower <= warm.upper, "{}", pair.name);
        let is_spent = cold.stop.is_early();
        assert!(
            is_spent || warm.upper - warm.lower <= limits.tolerance,
            "{}: {warm:?}",
            pair.name
        );
        costs[0] += warm.evaluations;
        costs[1] += cold.evaluations;
    }
    costs
}

/// Rows that are too dear.
fn table<const D: usize>(pairs: &[Pair<D>], pose: impl Fn(f64, f64) -> Pose<D>) -> Vec<String> {
    let mut wrong = Vec::new();
    for pair in pairs {
        for gap in GAPS {
            for tolerance in [1e-3 * SIZE, 1e-5 * SIZE] {
                for motion in MOTIONS {
                    for turn in [0.0, motion / SIZE] {
                        let limits = Limits::new(tolerance);
                        let pose = |way: f64| pose(motion * way, turn * way);
                        let [warm, cold] = costs(pair, gap, &limits, pose);
                        let share = f64::from(warm) / f64::from(cold);
                        let is_little = motion <= 1e-4 * SIZE && tolerance >= 1e-3 * SIZE;
                        let most = if is_little { 1.0 / 3.0 } else { 1.0 };
                        let row = format!(
                            "{:22} gap {gap:7} m, tolerance {tolerance:e} m, {motion:e} m and {turn:e} rad a \
                             step: {} / {} = {share:.3}",
                            pair.name,
                            warm / STEPS,
                            cold / STEPS
                        );
                        println!("{row}");
                        if share > most {
                            wrong.push(row);
                        }
                    }
                }
            }
        }
    }
    wrong
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn following_a_pair_costs_at_most_what_a_search_anew_costs() -> Result<(), ShapeError> {
    let mut wrong = table(&in_space()?, |way, turn| {
        let rotation = Rotation::from_axis_angle([0.6, 0.8, 0.0], turn).unwrap();
        Pose::new(rotation, Vector([0.8 * way, 0.36 * way, 0.48 * way]))
    });
    wrong.extend(table(&in_the_plane()?, |way, turn| {
        Pose::new(Rotation::from_angle(turn).unwrap(), Vector([0.8 * way, 0.6 * way]))
    }));
    assert!(wrong.is_empty(), "{} rows are too dear:\n{}", wrong.len(), wrong.join("\n"));
    Ok(())
}

/// Contacts of a pair that trembles for a thousand steps: their ids stay, they span what a manifold anew
/// spans, with gaps that are true, and cost at most twice a search for the separation.
#[test]
fn contacts_at_rest_last_and_are_cheap() -> Result<(), ShapeError> {
    let settings = ManifoldSettings::of_size(SIZE);
    let limits = Limits::new(0.5 * settings.margin);
    for pair in in_space()?.iter().take(7) {
        let [a, b] = &pair.bodies;
        let mut track = Track::new(a.clone(), b.clone());
        let mut workspace = PairWorkspace::new();
        let (mut ids, mut warm, mut cold) = (Vec::new(), 0, 0);
        for step in 0..1000 {
            // By up to 2 µm, along the floor too.
            let phase = f64::from(step);
            let mut tremble =
                Vector([(0.7 * phase).sin(), (1.1 * phase).sin(), (1.3 * phase).cos()]);
            tremble = tremble * (1e-4 * SIZE);
            let there = Pose::translation(tremble + Vector([0.0, pair.height - 1e-5, 0.0]));
            let poses = [Pose::identity(), there];
            let found = track.manifold(poses, &settings, &limits, &mut workspace).unwrap();
            let mut now: Vec<u64> = found.contacts.iter().map(|contact| contact.id).collect();
            now.sort_unstable();
            if step == 1 {
                ids.clone_from(&now);
            }
            assert!(step < 2 || now == ids, "{}, step {step}: {now:?}, not {ids:?}", pair.name);
            warm += found.separation.evaluations;
            if step % 100 == 7 {
                let b = Placed::new(b, there);
                cold += 100 * separation(a, b, &limits, &mut workspace).unwrap().evaluations;
                let anew = manifold(a, b, &settings, &limits, &mut workspace).unwrap();
                let gap = |found: &Manifold<3>| {
                    found
                        .contacts
                        .iter()
                        .map(|contact| contact.gap)
                        .fold(f64::INFINITY, f64::min)
                };
                assert!(
                    (gap(&found) - gap(&anew)).abs() < 1e-3 * settings.margin,
                    "{}",
                    pair.name
                );
                // Both span the same region; where it is a circle, no points of it are its corners.
                let spread = |found: &Manifold<3>| {
                    let points = found.contacts.iter().map(|contact| contact.point_a);
                    Aabb::around(points).unwrap().half_extents().norm()
                };
                let [ours, other] = [spread(&found), spread(&anew)];
                assert!(
                    ours >= 0.7 * other,
                    "{}, step {step}: {ours} m of {other} m",
                    pair.name
                );
                for contact in &found.contacts {
                    let middle = (contact.point_a + contact.point_b) * 0.5;
                    let local = there.inverse().transform_point(middle);
                    let gap = 2.0 * a.distance(middle).max(pair.bodies[1].distance(local));
                    // Values of a bound say less.
                    let depth = there.translation[1] - pair.height - 0.01 * settings.margin;
                    let is_true = (depth..gap + 0.01 * settings.margin).contains(&contact.gap);
                    assert!(is_true, "{}, step {step}: {contact:?}, {gap} m", pair.name);
                }
            }
        }
        let share = f64::from(warm) / f64::from(cold);
        println!(
            "{}: {} contacts, {share:.2} of a search for the separation",
            pair.name,
            ids.len()
        );
        assert!(share <= 2.0, "{}: {share}", pair.name);
    }
    Ok(())
}

/// The largest reach of contacts along directions of the floor, less than which no other contacts reach.
fn reaches(found: &Manifold<3>, most: f64) -> [f64; 16] {
    std::array::from_fn(|i| {
        let (sine, cosine) = (f64::from(i as u32) * std::f64::consts::TAU / 16.0).sin_cos();
        let within = found.contacts.iter().filter(|contact| contact.gap <= most);
        within.fold(f64::NEG_INFINITY, |far, contact| {
            far.max(contact.point_a.dot(Vector([cosine, 0.0, sine])))
        })
    })
}

/// Contacts of a pair that rocks and slides by up to a margin for 300 steps: the deepest is as deep as
/// that of a manifold anew, and all reach as far as those whose gaps are within the margin.
#[test]
fn contacts_of_a_pair_that_rocks_span_what_those_anew_span() -> Result<(), ShapeError> {
    let settings = ManifoldSettings::of_size(SIZE);
    let limits = Limits::new(0.05 * settings.margin);
    for pair in in_space()?.iter().take(7) {
        let [a, b] = &pair.bodies;
        let mut track = Track::new(a.clone(), b.clone());
        let mut workspace = PairWorkspace::new();
        let (mut warm, mut cold) = (0, 0);
        for step in 0..300 {
            let phase = f64::from(step);
            let wave = |rate: f64| (rate * phase).sin();
            let axis = Vector([wave(0.13), 0.2 * wave(0.05), (0.17 * phase).cos()]);
            let turn = Rotation::from_axis_angle(axis, 1e-3 * wave(0.7)).unwrap();
            let way = Vector([wave(0.7), 0.3 * wave(1.1), wave(1.3)]) * (0.4 * settings.margin);
            let there = Pose::new(turn, way + Vector([0.0, pair.height - 1e-5, 0.0]));
            let poses = [Pose::identity(), there];
            let found = track.manifold(poses, &settings, &limits, &mut workspace).unwrap();
            let b = Placed::new(b, there);
            let anew = manifold(a, b, &settings, &limits, &mut workspace).unwrap();
            (warm, cold) =
                (warm + found.separation.evaluations, cold + anew.separation.evaluations);
            let apart = (found.separation.upper - anew.separation.upper).abs();
            assert!(apart <= limits.tolerance, "{}, step {step}: {apart}", pair.name);
            // Corners are found to a share of the spacing; of a circle, which has none, contacts reach
            // as far as those of a square.
            let is_round = ["torus", "cup", "ball"].iter().any(|word| pair.name.contains(word));
            let ours = reaches(&found, settings.margin);
            let theirs = reaches(&anew, 0.9 * settings.margin);
            for (ours, theirs) in ours.iter().zip(theirs) {
                let least = if is_round { 0.7 * theirs } else { theirs };
                let is_as_far = *ours >= least.min(theirs) - 1.5 * settings.spacing;
                assert!(is_as_far, "{}, step {step}: {ours} m of {theirs} m", pair.name);
            }
        }
        let share = f64::from(warm) / f64::from(cold);
        println!("{}: {share:.2} of a manifold anew", pair.name);
        let most =
            if pair.name.ends_with("cube") && pair.name != "cup, cube" { 0.5 } else { 1.0 };
        assert!(share <= most, "{}: {share}", pair.name);
    }
    Ok(())
}
