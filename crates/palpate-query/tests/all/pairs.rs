// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Separations: closed forms, and bounds against samples on random trees.

#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../../fuzz/pair_answers.rs"]
mod pair_answers;

use palpate_field::kernel::{Ball, Cuboid, Cylinder, HalfSpace, Torus};
use palpate_field::{Rotation, Shape, ShapeError, Vector};
use palpate_query::{Limits, PairWorkspace, Query, QueryError, Stop, overlap, separation};
use palpate_testkit::arbitrary::Turn;
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = PairWorkspace::new();
    let (mut asked, mut spent) = (0, 0);
    cases::numbered(count, |seed, u| {
        let outcome = pair_answers::check::<D>(u, 1 + seed % 3, &mut workspace)?;
        Ok(outcome.map(|stop| {
            asked += u64::from(stop.is_some());
            spent += u64::from(stop.is_some_and(Stop::is_early));
        }))
    });
    let count = cases::count(count);
    assert!(asked * 2 > count, "{asked} of {count} pairs were bounded");
    assert!(spent * 20 <= asked, "{spent} of {asked} searches spent their budget");
}

#[test]
fn separations_in_space_are_enclosed() {
    on_trees::<3>(1000);
}

#[test]
fn separations_in_the_plane_are_enclosed() {
    on_trees::<2>(1500);
}

#[test]
fn balls_are_as_far_apart_as_their_centres_less_their_radii() -> Result<(), ShapeError> {
    let mut workspace = PairWorkspace::new();
    let limits = Limits::new(1e-7);
    let a = Shape::<3>::from_kernel(Ball::new(1.0)?);
    for (apart, truth) in [(3.0, 1.5), (1.500_001, 1e-6), (1.2, -0.3), (0.1, -1.0)] {
        // A ball inside the other is as wide as the overlap gets.
        let b = Shape::from_kernel(Ball::new(0.5)?).translated(Vector([
            apart * 0.48,
            apart * 0.6,
            apart * 0.64,
        ]))?;
        let Ok(answer) = separation(&a, &b, &limits, &mut workspace) else { panic!("bounded") };
        assert_eq!(answer.stop, Stop::Converged, "{answer:?}");
        assert!(answer.lower <= truth + 1e-12 && truth <= answer.upper + 1e-12, "{answer:?}");
        assert!(answer.upper - answer.lower <= 1e-7);
    }
    Ok(())
}

#[test]
fn a_box_on_a_floor_is_as_deep_as_it_is() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let mut workspace = PairWorkspace::new();
    let limits = Limits::new(1e-6);
    for lift in [0.01, -0.01] {
        let crate_ = Shape::from_kernel(Cuboid::new(Vector([0.6, 0.4]))?)
            .translated(Vector([0.3, 0.2 + lift]))?;
        let Ok(answer) = separation(&crate_, &floor, &limits, &mut workspace) else {
            panic!("one is bounded");
        };
        assert!(answer.lower <= lift && lift <= answer.upper, "{answer:?}");
        assert!(answer.upper - answer.lower <= 1e-6, "{answer:?}");
        let Some(normal) = answer.best.normal else { panic!("{answer:?}") };
        assert!((normal - Vector([0.0, -1.0])).norm() < 1e-12, "{answer:?}");
    }
    Ok(())
}

#[test]
fn normals_point_from_the_first_body_to_the_second() -> Result<(), ShapeError> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([0.4, 0.1, 0.4]))?);
    let torus = Shape::from_kernel(Torus::new(0.1, 0.03)?);
    let mut query = Query::new();
    // On its top, then against its side; apart and in each other.
    for (direction, reach) in [(Vector([0.0, 1.0, 0.0]), 0.08), (Vector([1.0, 0.0, 0.0]), 0.33)]
    {
        for gap in [0.01, -0.005] {
            let there = torus.clone().translated(direction * (reach + gap))?;
            for (bodies, sign) in [([&plate, &there], 1.0), ([&there, &plate], -1.0)] {
                let Ok(found) = query.manifold(bodies[0], bodies[1]) else { panic!("bounded") };
                let Ok(nearest) = query.closest_points(bodies[0], bodies[1]) else { panic!() };
                let Some(contact) = nearest.best else { panic!("{nearest:?}") };
                assert!(contact.normal.dot(direction * sign) > 0.999, "{gap} m: {contact:?}");
                assert!((contact.gap - gap).abs() < 1e-3, "{gap} m: {contact:?}");
                // Beside the deepest contact the torus curves away.
                for contact in &found.contacts {
                    assert!(contact.normal.dot(direction * sign) > 0.8, "{gap} m: {contact:?}");
                }
            }
        }
    }
    Ok(())
}

#[test]
fn a_thin_plate_that_just_cuts_a_torus_is_found() -> Result<(), ShapeError> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 0.02]))?);
    let mut workspace = PairWorkspace::new();
    // Upright, with its outermost point 1 mm in the plate, and 1 mm off it.
    for (gap, is_apart) in [(-1e-3, false), (1e-3, true)] {
        let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?).translated(Vector([
            0.1,
            -0.05,
            0.5 + 0.01 + gap,
        ]))?;
        let limits = Limits::new(1e-4);
        let Ok(answer) = separation(&plate, &torus, &limits, &mut workspace) else {
            panic!("bounded");
        };
        assert_eq!(answer.is_hit(), Some(!is_apart), "{answer:?}");
        let Ok(sign) = overlap(&plate, &torus, &limits, &mut workspace) else {
            panic!("bounded");
        };
        assert_eq!((sign.is_hit(), sign.stop), (Some(!is_apart), Stop::SignKnown));
        assert!(sign.evaluations <= answer.evaluations);
    }
    Ok(())
}

#[test]
fn turned_and_moved_together_bodies_stay_as_far_apart() -> Result<(), ShapeError> {
    let a = Shape::from_kernel(Cylinder::new(0.3, 1.0)?);
    let b = Shape::from_kernel(Cuboid::new(Vector([0.4, 0.5, 0.6]))?)
        .translated(Vector([0.7, 0.2, -0.1]))?;
    let turn = Rotation::from_quaternion([0.1, 0.3, -0.2, 0.9])?;
    let limits = Limits::new(1e-5);
    let mut workspace = PairWorkspace::new();
    let mut ask = |a: &Shape<3>, b: &Shape<3>| separation(a, b, &limits, &mut workspace);
    let here = ask(&a, &b);
    let move_ = |shape: Shape<3>| shape.rotated(turn)?.translated(Vector([3.0, -2.0, 1.0]));
    let there = ask(&move_(a)?, &move_(b)?);
    let (Ok(here), Ok(there)) = (here, there) else { panic!("bounded") };
    assert!(here.lower <= there.upper && there.lower <= here.upper, "{here:?} {there:?}");
    assert_eq!((here.stop, there.stop), (Stop::Converged, Stop::Converged));
    Ok(())
}

#[test]
fn two_bodies_without_an_end_are_refused() -> Result<(), ShapeError> {
    let a = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let answer = separation(&a, &a, &Limits::new(1e-4), &mut PairWorkspace::new());
    assert_eq!(answer, Err(QueryError::Unbounded));
    Ok(())
}

#[test]
fn coincident_and_concentric_bodies_overlap_by_the_width_of_the_smaller()
-> Result<(), ShapeError> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([0.7, 0.1, 0.5]))?);
    let ball = Shape::from_kernel(Ball::new(0.2)?);
    let large = Shape::from_kernel(Ball::new(0.9)?);
    let mut workspace = PairWorkspace::new();
    let limits = Limits::new(1e-3);
    for (a, b, truth) in [(&plate, &plate, -0.1), (&ball, &ball, -0.4), (&ball, &large, -0.4)] {
        let Ok(answer) = separation(a, b, &limits, &mut workspace) else { panic!("bounded") };
        assert_eq!(answer.stop, Stop::Converged, "{answer:?}");
        assert!(answer.lower <= truth + 1e-12 && truth <= answer.upper + 1e-12, "{answer:?}");
    }
    Ok(())
}

#[test]
fn searches_that_may_not_look_say_little_and_nothing_wrong() -> Result<(), ShapeError> {
    let a = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let b = Shape::from_kernel(Cuboid::new(Vector([0.3, 0.5, 0.2]))?)
        .translated(Vector([0.4, 0.3, 0.1]))?;
    let mut workspace = PairWorkspace::new();
    let ask = |limits: &Limits, workspace: &mut _| {
        let Ok(answer) = separation(&a, &b, limits, workspace) else { panic!("bounded") };
        answer
    };
    let truth = ask(&Limits::new(1e-6).with_budget(1_000_000), &mut workspace);
    for (tolerance, budget) in [(1e-6, 0), (1e-6, 10), (0.0, 1000), (1e15, 1000)] {
        let answer = ask(&Limits::new(tolerance).with_budget(budget), &mut workspace);
        assert!(answer.lower <= truth.upper && truth.lower <= answer.upper, "{answer:?}");
    }
    // A tolerance without end once led a descent to a point that was no number.
    for tolerance in [f64::NAN, -1.0, f64::INFINITY] {
        let limits = Limits::new(tolerance).with_budget(1000);
        assert!(separation(&a, &b, &limits, &mut workspace).is_err(), "{tolerance}");
    }
    Ok(())
}
