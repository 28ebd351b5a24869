// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many bodies, against all their pairs one by one.

use palpate_field::kernel::{Ball, Cuboid, Cylinder, HalfSpace, Torus};
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{
    BodyId, Limits, ManifoldSettings, PairWorkspace, Placed, QueryError, Verdict, World,
    WorldSettings, overlap, separation,
};

type Test = Result<(), Box<dyn std::error::Error>>;

/// The fractional parts of multiples of the plastic number's powers: places without order.
fn place(i: usize) -> [f64; 3] {
    [0.819_172_513_396_164, 0.671_043_606_703_789, 0.549_700_477_901_929]
        .map(|step| (step * (i + 1) as f64).fract())
}

fn in_space(i: usize) -> Result<(Shape<3>, Pose<3>), ShapeError> {
    let shape = match i % 4 {
        0 => Shape::from_kernel(Ball::new(0.2)?),
        1 => Shape::from_kernel(Cuboid::new(Vector([0.5, 0.2, 0.3]))?),
        2 => Shape::from_kernel(Torus::new(0.2, 0.08)?),
        _ => Shape::from_kernel(Cylinder::new(0.12, 0.5)?),
    };
    let [x, y, z] = place(i);
    let turn = Rotation::from_axis_angle(Vector([x, 1.0, z]), 6.0 * y)?;
    Ok((shape, Pose::new(turn, Vector([x, y, z]) * 1.6)))
}

fn in_the_plane(i: usize) -> Result<(Shape<2>, Pose<2>), ShapeError> {
    let shape = match i % 2 {
        0 => Shape::from_kernel(Ball::new(0.1)?),
        _ => Shape::from_kernel(Cuboid::new(Vector([0.3, 0.1]))?),
    };
    let [x, y, z] = place(i);
    Ok((shape, Pose::new(Rotation::from_angle(6.0 * z)?, Vector([x, y]) * 2.0)))
}

/// A world, the names of its bodies, and they once more.
type Made<const D: usize> = (World<D>, Vec<BodyId>, Vec<(Shape<D>, Pose<D>)>);

/// A world of `count` bodies.
fn made<const D: usize>(
    count: usize,
    make: impl Fn(usize) -> Result<(Shape<D>, Pose<D>), ShapeError>,
) -> Result<Made<D>, Box<dyn std::error::Error>> {
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    let bodies = (0..count).map(make).collect::<Result<Vec<_>, _>>()?;
    let ids = bodies.iter().map(|(shape, pose)| world.add(shape.clone(), *pose));
    let ids = ids.collect::<Result<_, _>>()?;
    Ok((world, ids, bodies))
}

/// That a world says of all pairs what each says alone.
fn agrees<const D: usize>(world: &mut World<D>, bodies: &[(Shape<D>, Pose<D>)]) -> usize {
    let WorldSettings { manifold, limits: asked, .. } = *world.settings();
    let margin = manifold.margin;
    let mut workspace = PairWorkspace::new();
    let limits = Limits::new(1e-5).with_budget(200_000);
    let found = world.step();
    let mut touching = 0;
    for (k, (b, of_b)) in bodies.iter().enumerate() {
        for (i, (a, of_a)) in bodies[..k].iter().enumerate() {
            let said = found.iter().find(|pair| pair.bodies.map(BodyId::index) == [i, k]);
            let two = [Placed::new(a, *of_a), Placed::new(b, *of_b)];
            let truth = separation(two[0], two[1], &limits, &mut workspace).expect("bounded");
            if truth.upper <= margin {
                touching += 1;
                let said = said.unwrap_or_else(|| panic!("{i}, {k} is missing: {truth:?}"));
                assert_eq!(said.verdict(margin), Verdict::Touching, "{i}, {k}: {said:?}");
                assert!(!said.contacts().is_empty(), "{i}, {k}: {said:?}");
                let [lower, upper] = said.bounds();
                assert!(lower <= truth.upper && truth.lower <= upper, "{i}, {k}: {said:?}");
            } else if truth.lower > margin + asked.tolerance {
                assert!(said.is_none(), "{i}, {k} is apart: {said:?}");
            }
        }
    }
    touching
}

#[test]
fn a_world_says_what_all_pairs_say() -> Test {
    let (mut world, ids, mut bodies) = made(60, in_space)?;
    assert!(agrees(&mut world, &bodies) > 20);
    // Some move, and are asked again from what was known.
    for step in 0..3 {
        let mut moves = Vec::new();
        for i in (step..bodies.len()).step_by(7) {
            let [x, y, z] = place(100 + i);
            bodies[i].1.translation += Vector([x - 0.5, y - 0.5, z - 0.5]) * 0.1;
            moves.push((ids[i], bodies[i].1));
        }
        world.set_poses(&moves)?;
        assert!(agrees(&mut world, &bodies) > 20);
    }
    let (mut world, _, bodies) = made(80, in_the_plane)?;
    assert!(agrees(&mut world, &bodies) > 20);
    Ok(())
}

#[test]
fn bodies_that_come_and_go_are_asked_while_they_are_there() -> Test {
    let margin = WorldSettings::of_size(1.0).manifold.margin;
    let limits = Limits::new(1e-5).with_budget(200_000);
    let mut workspace = PairWorkspace::new();
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    // Name, shape, pose, groups and mask of those that are there.
    let mut there: Vec<(BodyId, Shape<3>, Pose<3>, u32, u32)> = Vec::new();
    let mut touching = 0;
    for step in 0..60 {
        let (shape, mut pose) = in_space(step)?;
        pose.translation = pose.translation * 0.5;
        there.push((world.add(shape.clone(), pose)?, shape, pose, 1, u32::MAX));
        if step % 3 == 2 {
            let gone = there.remove(step * 7 % there.len());
            world.remove(gone.0)?;
        }
        let chosen = step * 5 % there.len();
        let (id, _, pose, groups, mask) = &mut there[chosen];
        if step % 4 == 0 {
            (*groups, *mask) = (1 + step as u32 % 3, 1 + step as u32 / 2 % 3);
            world.set_groups(*id, *groups, *mask)?;
        } else {
            let far = 0.1_f64.powi((step % 5) as i32);
            pose.translation += (Vector(place(step)) - Vector([0.5, 0.5, 0.5])) * far;
            world.set_poses(&[(*id, *pose)])?;
        }
        if there.len() > 12 {
            world.remove(there.remove(0).0)?;
        }
        let found = world.step();
        for (k, b) in there.iter().enumerate() {
            for a in &there[..k] {
                let said = found.iter().find(|pair| pair.bodies == [a.0, b.0]);
                if a.3 & b.4 == 0 || b.3 & a.4 == 0 {
                    assert!(said.is_none(), "step {step}: {said:?} is not asked");
                    continue;
                }
                let two = [Placed::new(&a.1, a.2), Placed::new(&b.1, b.2)];
                let truth = separation(two[0], two[1], &limits, &mut workspace)?;
                if truth.upper <= margin {
                    touching += 1;
                    let said = said.unwrap_or_else(|| panic!("step {step}: {truth:?}"));
                    let [lower, upper] = said.bounds();
                    assert!(lower <= truth.upper && truth.lower <= upper, "{said:?}");
                    assert!(!said.contacts().is_empty(), "{said:?}");
                } else if truth.lower > 2.0 * margin {
                    assert!(said.is_none(), "step {step}: {said:?}, {truth:?}");
                }
            }
        }
    }
    assert!(touching > 100, "{touching}");
    Ok(())
}

#[test]
fn threads_change_no_bit() -> Test {
    let run = |threads: usize| -> Result<String, Box<dyn std::error::Error>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let (mut world, ..) = made(60, in_space)?;
        Ok(pool.install(|| format!("{:?}", world.step())))
    };
    let alone = run(1)?;
    for threads in [2, 5] {
        assert_eq!(run(threads)?, alone, "{threads} threads");
    }
    Ok(())
}

#[test]
fn groups_masks_and_ignored_pairs_are_not_asked() -> Test {
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    let mut ids = Vec::new();
    for i in 0..3 {
        let there = Pose::translation(Vector([0.1 * f64::from(i), 0.0, 0.0]));
        ids.push(world.add(ball.clone(), there)?);
    }
    assert_eq!(world.step().len(), 3);
    world.ignore(ids[2], ids[0])?;
    assert_eq!(world.step().len(), 2);
    // The second is in a group that the first does not ask for.
    world.set_groups(ids[1], 2, u32::MAX)?;
    world.set_groups(ids[0], 1, 1)?;
    let found = world.step();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].bodies, [ids[1], ids[2]]);
    world.remove(ids[2])?;
    assert!(world.step().is_empty());
    assert_eq!(world.remove(ids[2]), Err(QueryError::NoBody { body: 2 }));
    assert_eq!(world.pose(ids[1])?.translation[0], 0.1);
    Ok(())
}

#[test]
fn no_pair_is_dropped() -> Test {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0, 0.0]), 0.0)?);
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    let floor = world.add(floor, Pose::identity())?;
    let wall = world.add(wall, Pose::identity())?;
    let ball = world.add(ball, Pose::translation(Vector([0.4999, 0.4995, 7.0])))?;
    let found = world.step();
    let margin = 0.002;
    let verdicts: Vec<_> =
        found.iter().map(|pair| (pair.bodies, pair.verdict(margin))).collect();
    // Of two bodies without bounds nothing can be said, and that is said.
    assert_eq!(verdicts[0], ([floor, wall], Verdict::Undecided));
    assert_eq!(found[0].bounds(), [f64::NEG_INFINITY, f64::INFINITY]);
    assert_eq!(verdicts[1], ([floor, ball], Verdict::Touching));
    assert_eq!(verdicts[2], ([wall, ball], Verdict::Touching));
    assert!((found[2].contacts()[0].gap + 1e-4).abs() < 1e-6);
    // A budget of nothing decides nothing, and drops nothing.
    let limits = Limits::new(1e-9).with_budget(10);
    let settings = WorldSettings::new(ManifoldSettings::of_size(1.0), limits);
    let mut world = World::new(settings)?;
    let cuboid = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?);
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    world.add(cuboid.clone(), Pose::identity())?;
    let turn = Rotation::from_axis_angle(Vector([1.0, 0.3, 0.0]), 0.6)?;
    let there = Pose::new(turn, Vector([0.75, 0.3, 0.0]));
    world.add(torus.clone(), there)?;
    let found = world.step();
    let [lower, upper] = found[0].bounds();
    let mut workspace = PairWorkspace::new();
    let limits = Limits::new(1e-6).with_budget(1_000_000);
    let truth = separation(&cuboid, Placed::new(&torus, there), &limits, &mut workspace)?;
    assert!(lower <= truth.upper && truth.lower <= upper, "{truth:?}");
    assert!(overlap(&cuboid, Placed::new(&torus, there), &limits, &mut workspace).is_ok());
    Ok(())
}

/// Whatever the budget: what is touching is proven near, what is left out is proven apart, and
/// the bounds of every pair hold its separation.
#[test]
fn verdicts_are_what_bounds_prove() -> Test {
    let mut counts = [0; 3];
    for budget in [10, 300, 1000, 200_000] {
        let limits = Limits::new(1e-3).with_budget(budget);
        let settings = WorldSettings::new(ManifoldSettings::of_size(1.0), limits);
        let margin = settings.manifold.margin;
        let mut world = World::new(settings)?;
        let bodies = (0..24).map(in_space).collect::<Result<Vec<_>, _>>()?;
        let ids = bodies.iter().map(|(shape, pose)| world.add(shape.clone(), *pose));
        let ids = ids.collect::<Result<Vec<_>, _>>()?;
        assert!(world.bodies().eq(ids.iter().copied()));
        let found: Vec<_> = world.step().into_iter().cloned().collect();
        let mut workspace = PairWorkspace::new();
        let fine = Limits::new(1e-5).with_budget(400_000);
        for k in 0..bodies.len() {
            for i in 0..k {
                let [a, b] = [i, k].map(|i| Placed::new(&bodies[i].0, bodies[i].1));
                let truth = separation(a, b, &fine, &mut workspace)?;
                let lower = world.lower_bound(ids[k], ids[i])?;
                assert!(lower <= truth.upper, "{i}, {k}: {lower} {truth:?}");
                let said = found.iter().find(|pair| pair.bodies == [ids[i], ids[k]]);
                match said.map(|said| (said.verdict(margin), said.bounds())) {
                    None => {
                        assert!(lower > margin, "{i}, {k} is left out: {lower}");
                        counts[0] += 1;
                    }
                    Some((Verdict::Touching, [_, upper])) => {
                        assert!(upper <= margin && truth.lower <= upper, "{i}, {k}: {truth:?}");
                        counts[1] += 1;
                    }
                    Some((verdict, [lower, upper])) => {
                        assert_eq!(verdict, Verdict::Undecided);
                        assert!(lower <= margin && margin < upper, "{i}, {k}: {lower} {upper}");
                        counts[2] += 1;
                    }
                }
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 10), "{counts:?}");
    Ok(())
}

/// Two balls a gap apart that lies within the tolerance of the margin.
#[test]
fn a_separation_near_the_margin_is_decided() -> Test {
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let settings = WorldSettings::of_size(1.0);
    let margin = settings.manifold.margin;
    for (gap, expected) in [
        (0.75 * margin, Verdict::Touching),
        (0.95 * margin, Verdict::Touching),
        (1.05 * margin, Verdict::Apart),
        (1.25 * margin, Verdict::Apart),
        // Bounds of a separation hold rounding, and so this margin.
        (margin, Verdict::Undecided),
    ] {
        let mut world = World::new(settings)?;
        let one = world.add(ball.clone(), Pose::identity())?;
        let other =
            world.add(ball.clone(), Pose::translation(Vector([1.0 + gap, 0.0, 0.0])))?;
        let found = world.step();
        let verdict = found.first().map_or(Verdict::Apart, |pair| pair.verdict(margin));
        assert_eq!(verdict, expected, "{gap}: {found:?}");
        assert!(world.lower_bound(one, other)? <= gap);
    }
    Ok(())
}

#[test]
fn poses_are_moved_all_or_none() -> Test {
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let mut world = World::new(WorldSettings::of_size(1.0))?;
    let one = world.add(ball.clone(), Pose::identity())?;
    let other = world.add(ball.clone(), Pose::identity())?;
    let fine = Pose::translation(Vector([3.0, 0.0, 0.0]));
    let wrong = Pose::translation(Vector([f64::NAN, 0.0, 0.0]));
    assert_eq!(
        world.set_poses(&[(one, fine), (other, wrong)]),
        Err(QueryError::Pose { index: 1 })
    );
    assert_eq!(world.pose(one)?, Pose::identity());
    assert_eq!(world.add(ball, wrong), Err(QueryError::Pose { index: 2 }));
    world.set_poses(&[(one, fine)])?;
    assert!(world.step().is_empty());
    Ok(())
}

/// Bodies in a heap that tremble: a step of a world costs no more than one that knows nothing, and
/// little where they hardly move. Where they move far, it costs what was tried in vain, ever less often.
#[test]
fn a_step_costs_at_most_what_it_costs_anew() -> Test {
    for (motion, most) in [(0.0, 0.3), (1e-6, 0.3), (1e-5, 0.3), (1e-4, 1.0), (1e-2, 1.02)] {
        let (mut world, ids, bodies) = made(24, in_space)?;
        let [mut followed, mut anew] = [0, 0];
        let cost = |world: &mut World<3>| -> u32 {
            let found = world.step();
            let manifolds = found.iter().filter_map(|pair| pair.manifold.as_ref());
            manifolds.map(|manifold| manifold.separation.evaluations).sum()
        };
        for step in 0..60_usize {
            let mut fresh = World::new(WorldSettings::of_size(1.0))?;
            for (i, (id, (shape, pose))) in ids.iter().zip(&bodies).enumerate() {
                // To and fro, each body on a way of its own.
                let way = Vector(place(i + 7)) - Vector::constant(0.5);
                let moved = way * (motion * (step % 4) as f64);
                let pose = Pose::new(pose.rotation, pose.translation + moved);
                world.set_poses(&[(*id, pose)])?;
                fresh.add(shape.clone(), pose)?;
            }
            let (one, other) = (cost(&mut world), cost(&mut fresh));
            if step > 0 {
                (followed, anew) = (followed + one, anew + other);
            }
        }
        let share = f64::from(followed) / f64::from(anew);
        assert!(share <= most, "a motion of {motion} m costs {share} of a search anew");
    }
    Ok(())
}
