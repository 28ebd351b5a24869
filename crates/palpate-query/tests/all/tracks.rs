// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move: what is kept of the last proof, and derivatives.

use palpate_field::kernel::{Ball, Cuboid, Cylinder, RegularStar, Torus};
use palpate_field::operator::Profile;
use palpate_field::{Aabb, Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{
    Limits, ManifoldSettings, PairWorkspace, Placed, Track, proof, rates, separation,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::{Solid, Tree};

type Pair<const D: usize> = (&'static str, Shape<D>, Shape<D>);

fn in_space() -> Result<Vec<Pair<3>>, ShapeError> {
    let cuboid = Shape::from_kernel(Cuboid::new(Vector([0.6, 0.4, 0.8]))?);
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let post = Shape::from_kernel(Cylinder::new(0.1, 0.9)?);
    let drilled = cuboid.clone().difference([post.clone()])?;
    let blend = Shape::smooth_union([drilled.clone(), torus.clone()], Profile::Cubic, 0.02)?;
    let stretched = torus.clone().stretched([1.0, 2.0, 0.5])?;
    Ok(vec![
        ("cuboid, torus", cuboid.clone(), torus),
        ("blend, drilled cuboid", blend.clone(), drilled),
        ("stretched torus, post", stretched, post),
        ("blend, twisted cuboid", blend, cuboid.twisted(1.0)?),
    ])
}

fn in_the_plane() -> Result<Vec<Pair<2>>, ShapeError> {
    let cuboid = Shape::from_kernel(Cuboid::new(Vector([0.6, 0.4]))?);
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    let bitten = cuboid.clone().difference([ball.clone().translated(Vector([0.3, 0.2]))?])?;
    let blend = Shape::smooth_union([ball, cuboid.clone()], Profile::Quadratic, 0.02)?;
    Ok(vec![("bitten cuboid, blend", bitten, blend.clone()), ("blend, cuboid", blend, cuboid)])
}

/// Follows each pair along a way with a jump in it, and asks anew beside it.
fn agree<const D: usize>(pairs: &[Pair<D>], motion: impl Fn(f64) -> Pose<D>) {
    let limits = Limits::new(1e-3);
    let mut workspace = PairWorkspace::new();
    for (name, a, b) in pairs {
        let mut track = Track::new(a.clone(), b.clone());
        let (mut warm_asked, mut cold_asked) = (0, 0);
        for step in 0..200 {
            let jump = if step < 100 { 0.0 } else { 0.4 };
            let poses = [motion(-0.3), motion(2e-4 * f64::from(step) + jump)];
            let warm = track.separation(poses, &limits, &mut workspace).expect("bounded");
            let [a, b] = [Placed::new(a, poses[0]), Placed::new(b, poses[1])];
            let cold = separation(a, b, &limits, &mut workspace).expect("bounded");
            assert!(
                warm.lower <= cold.upper && cold.lower <= warm.upper,
                "{name}, step {step}: {warm:?} and {cold:?} exclude each other"
            );
            assert!(warm.upper - warm.lower <= limits.tolerance, "{name}: {warm:?}");
            warm_asked += warm.evaluations;
            cold_asked += cold.evaluations;
        }
        assert!(
            5 * warm_asked < 3 * cold_asked,
            "{name}: {warm_asked} of {cold_asked} evaluations"
        );
    }
}

#[test]
fn what_is_kept_stays_true_and_saves_evaluations() -> Result<(), ShapeError> {
    let axis = Rotation::from_axis_angle(Vector([0.3, 1.0, -0.4]), 1.0)?;
    agree(&in_space()?, |t| {
        let turn = Rotation::from_axis_angle(Vector([1.0, 0.2, 0.4]), 0.5 * t);
        Pose::new(turn.expect("an axis") * axis, Vector([0.9 + t, 0.1 * t, 0.3]))
    });
    agree(&in_the_plane()?, |t| {
        let turn = Rotation::from_angle(0.5 * t).expect("an angle");
        Pose::new(turn, Vector([0.5 + t, 0.4]))
    });
    Ok(())
}

/// Derivatives of separations that are smooth at these poses, against differences.
fn differ<const D: usize>(
    pairs: &[Pair<D>],
    start: Pose<D>,
    moves: &[(Pose<D>, usize, usize)],
) {
    const STEP: f64 = 1e-4;
    let limits = Limits::new(1e-9).with_budget(1_000_000);
    let mut workspace = PairWorkspace::new();
    for (name, a, b) in pairs {
        let mut at = |poses: [Pose<D>; 2]| {
            let [a, b] = [Placed::new(a, poses[0]), Placed::new(b, poses[1])];
            separation(a, b, &limits, &mut workspace).expect("bounded")
        };
        let here = at([Pose::identity(), start]);
        let rates = rates(a, Placed::new(b, start), &here.best).expect("bounded");
        assert!(rates.residual < 5e-3, "{name}: {rates:?}");
        for (small, body, index) in moves {
            let mut ends = [[Pose::identity(), start]; 2];
            ends[0][*body] = *small * ends[0][*body];
            ends[1][*body] = small.inverse() * ends[1][*body];
            let [after, before] = ends.map(|poses| at(poses).upper);
            let difference = (after - before) / (2.0 * STEP);
            let derivative = rates.derivative(*body, Vector::ZERO);
            let said = match index.checked_sub(D) {
                None => derivative.translation[*index],
                Some(axis) => derivative.rotation[axis],
            };
            assert!(
                (said - difference).abs() < 2e-3,
                "{name}: body {body}, {index}: {said} is said, {difference} found"
            );
        }
    }
}

#[test]
fn derivatives_are_the_limits_of_differences() -> Result<(), ShapeError> {
    let pairs = in_space()?;
    let turn = Rotation::from_axis_angle(Vector([0.3, 1.0, -0.4]), 0.7)?;
    let mut moves = Vec::new();
    for body in 0..2 {
        for axis in 0..3 {
            let step = Vector::unit(axis);
            moves.push((Pose::translation(step * 1e-4), body, axis));
            let turn = Rotation::from_axis_angle(step, 1e-4)?;
            moves.push((Pose::rotation(turn), body, 3 + axis));
        }
    }
    differ(&pairs, Pose::new(turn, Vector([0.9, 0.45, 0.35])), &moves);
    let mut moves = Vec::new();
    for body in 0..2 {
        for axis in 0..2 {
            moves.push((Pose::translation(Vector::unit(axis) * 1e-4), body, axis));
        }
        moves.push((Pose::rotation(Rotation::from_angle(1e-4)?), body, 4));
    }
    let turn = Rotation::from_angle(0.3)?;
    differ(&in_the_plane()?, Pose::new(turn, Vector([0.7, 0.5])), &moves);
    Ok(())
}

/// Where one body alone is the larger field, the other's gradient is not part of the mean.
/// It once was, and cancelled that of the first: a ball deep in another seemed to care
/// where the other is.
#[test]
fn a_ball_deep_in_another_is_as_deep_wherever_it_is() -> Result<(), ShapeError> {
    let (large, small) =
        (Shape::from_kernel(Ball::new(1.0)?), Shape::from_kernel(Ball::new(0.2)?));
    let there = Placed::new(&small, Pose::translation(Vector([0.3, 0.1, 0.2])));
    let limits = Limits::new(1e-6).with_budget(200_000);
    let mut workspace = PairWorkspace::new();
    let nearest = separation(&large, there, &limits, &mut workspace).expect("bounded").best;
    let rates = rates(&large, there, &nearest).expect("bounded");
    assert!(rates.of.iter().all(|rate| rate.norm() < 1e-3), "{rates:?}");
    assert!(rates.residual < 1e-3, "{rates:?}");
    Ok(())
}

/// Poses far from the world's origin are known to their last bits alone, and the bounds
/// say so.
#[test]
fn far_from_the_origin_bounds_hold_the_roundings_of_poses() -> Result<(), ShapeError> {
    let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
    let limits = Limits::new(0.0).with_budget(2000);
    let mut workspace = PairWorkspace::new();
    let turn = Rotation::from_axis_angle(Vector([0.3, 1.0, -0.4]), 0.7)?;
    let far = Vector([1e6, -2e6, 3e6]);
    // A power of two, so that the distance of the centres is exact.
    let poses = [far, far + Vector([2.0, 0.0, 0.0])].map(|centre| Pose::new(turn, centre));
    let [a, b] = poses.map(|pose| Placed::new(&ball, pose));
    let answer = separation(a, b, &limits, &mut workspace).expect("bounded");
    assert!(answer.lower <= 1.0 && 1.0 <= answer.upper, "{answer:?}");
    Ok(())
}

#[test]
fn poses_and_built_motions_give_the_same_answers() -> Result<(), ShapeError> {
    let limits = Limits::new(1e-6).with_budget(1_000_000);
    let mut workspace = PairWorkspace::new();
    let turn = Rotation::from_axis_angle(Vector([0.3, 1.0, -0.4]), 0.7)?;
    let away = Vector([0.6, 0.35, 0.3]);
    for (name, a, b) in in_space()? {
        let built = b.clone().rotated(turn)?.translated(away)?;
        let built = separation(&a, &built, &limits, &mut workspace).expect("bounded");
        let posed = Placed::new(&b, Pose::new(turn, away));
        let posed = separation(&a, posed, &limits, &mut workspace).expect("bounded");
        assert!(built.lower <= posed.upper, "{name}: {built:?}, {posed:?}");
        // A box around a rotated box is larger: what is steeper than one is told less.
        let is_steep = a.promise().lipschitz.max(b.promise().lipschitz) > 1.0;
        assert!(is_steep || posed.lower <= built.upper, "{name}: {built:?}, {posed:?}");
    }
    Ok(())
}

/// The boxes of a proof fill the box around them, and each says what is true.
#[test]
fn a_proof_has_no_gaps_and_no_untruths() -> Result<(), ShapeError> {
    let limits = Limits::new(1e-3);
    let mut workspace = PairWorkspace::new();
    let there = Pose::translation(Vector([0.62, 0.4]));
    for (name, a, b) in in_the_plane()? {
        let placed = Placed::new(&b, there);
        let found = proof(&a, placed, &limits, &mut workspace).expect("bounded");
        let whole = found.boxes.iter().map(|part| part.aabb).reduce(|a, b| a.union(&b));
        let area = |aabb: Aabb<2>| {
            let half = aabb.half_extents();
            4.0 * half[0] * half[1]
        };
        let parts: f64 = found.boxes.iter().map(|part| area(part.aabb)).sum();
        let whole = whole.map_or(0.0, area);
        assert!((parts - whole).abs() < 1e-12 * whole, "{name}: {parts} of {whole}");
        for part in &found.boxes {
            let p = part.aabb.centre();
            let value = 2.0 * a.distance(p).max(b.distance(p - there.translation));
            assert!(part.lower <= value, "{name}: {part:?}, {value}");
            assert!(part.lower >= found.answer.lower, "{name}: {part:?}");
        }
    }
    Ok(())
}

/// Random trees in random motion, with jumps and ways back, asked for separations and
/// contacts in turn: what a track says holds the truth that a search without memory
/// encloses, and contacts keep their laws.
fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let (mut warm, mut cold) = (PairWorkspace::new(), PairWorkspace::new());
    cases::numbered(count, |seed, u| {
        let trees: [Tree<D>; 2] = [draw::tree(u, 1 + seed % 3)?, draw::tree(u, 1 + seed % 2)?];
        let [Ok(a), Ok(b)] = trees.map(|tree| tree.shape()) else { return Ok(Ok(())) };
        if a.promise().bounds.or(b.promise().bounds).is_none() {
            return Ok(Ok(()));
        }
        let size = draw::size(&a).min(draw::size(&b));
        let limits = Limits::new(0.02 * size).with_budget(5_000);
        let settings = ManifoldSettings {
            margin: 0.02 * size,
            spacing: 0.15 * size,
            most: 16,
            solver_slop: None,
        };
        let mut track = Track::new(a.clone(), b.clone());
        let start = [Pose::identity(), draw::pose(u)?];
        let mut poses = start;
        for step in 0..8 {
            match u.int_in_range(0..=5_u8)? {
                0 => poses = start,
                1 => poses[step % 2] = draw::pose(u)?,
                _ => {
                    let far = size * 10.0_f64.powf(draw::within(u, -6.0, -0.5)?);
                    poses[step % 2].translation += draw::direction::<D>(u)? * far;
                }
            }
            let said = if u.arbitrary()? {
                let found = track.manifold(poses, &settings, &limits, &mut warm);
                let found = found.expect("one is bounded");
                let is_contact = found.separation.lower <= settings.margin;
                if found.contacts.is_empty() == is_contact {
                    return Ok(Err(format!("{found:?}: {a:?} {b:?}")));
                }
                for contact in &found.contacts {
                    let between = (contact.point_b - contact.point_a).dot(contact.normal);
                    let is_unit = (contact.normal.norm() - 1.0).abs() < 1e-9;
                    if !(is_unit
                        && (between - contact.gap).abs() <= 1e-9 * (1.0 + between.abs()))
                    {
                        return Ok(Err(format!("{contact:?}: {a:?} {b:?}")));
                    }
                }
                found.separation
            } else {
                track.separation(poses, &limits, &mut warm).expect("one is bounded")
            };
            let [a, b] = [Placed::new(&a, poses[0]), Placed::new(&b, poses[1])];
            let truth = separation(a, b, &limits, &mut cold).expect("one is bounded");
            let agree = said.lower <= truth.upper && truth.lower <= said.upper;
            if !agree || said.lower > said.upper {
                return Ok(Err(format!("step {step}: {said:?}, {truth:?}: {a:?} {b:?}")));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn tracks_of_random_trees_say_what_searches_say() {
    on_trees::<2>(150);
    on_trees::<3>(60);
}

/// A star that comes to lie with a tip deep in the flank of another, on five ways. Once, the normal with which
/// the tip came gave a contact of 0.7 mm where the bodies overlap by 10.8 mm.
#[test]
fn history_hides_no_depth() {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06).unwrap());
    let end = Vector([-0.173_068_803_094_357_85, -0.020_700_423_262_753_453]);
    let settings =
        ManifoldSettings { margin: 2e-3, most: 8, ..ManifoldSettings::of_size(0.2282) };
    let limits = Limits::new(1e-3).with_budget(20_000);
    let ways =
        [[-0.983, -0.183], [-0.777, 0.629], [0.0, -1.0], [0.0, 1.0], [0.0, 0.0]].map(Vector);
    for way in ways {
        let mut track = Track::new(star.clone(), star.clone());
        let mut workspace = PairWorkspace::new();
        let mut deep = 0;
        for step in 0..=200 {
            let apart = 0.04 * (1.0 - f64::from(step) / 200.0);
            let turned = if way == Vector::ZERO { 10.0 * apart } else { 0.0 };
            let turn = Rotation::from_angle(-0.1340 + turned).unwrap();
            let poses = [Pose::identity(), Pose::new(turn, end + way * apart)];
            let found = track.manifold(poses, &settings, &limits, &mut workspace).unwrap();
            let gaps = found.contacts.iter().map(|contact| contact.gap);
            let deepest = gaps.fold(f64::INFINITY, f64::min);
            let upper = found.separation.upper;
            assert!(
                found.contacts.is_empty() || deepest <= upper + 1e-3,
                "{way:?} {step}: {deepest} {upper}"
            );
            deep += u32::from(upper < -5e-3);
        }
        assert!(deep > 10, "{way:?}: {deep}");
    }
}
