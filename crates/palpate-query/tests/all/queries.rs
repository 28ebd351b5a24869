// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The door to all questions: the same answers as the functions with workspaces, batches
//! that any number of threads answers alike, and what is refused.

use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};

use palpate_field::kernel::{Ball, Cuboid, HalfSpace, Torus};
use palpate_field::{Pose, Rotation, Screw, Shape, Vector};
use palpate_mesh::TriangleMesh;
use palpate_query::{
    BallWorkspace, Certified, Element, ElementContacts, Limits, Manifold, MeshContacts,
    MeshHits, MeshWorkspace, Moving, Nearest, PairWorkspace, Penetration, Proof, Query,
    QueryError, Ray, Stop, Tolerance, cast_ray, contact_ball, mesh_contacts, minimum,
    separation, touches,
};

type Test = Result<(), Box<dyn Error>>;

fn plate() -> Result<Shape<3>, Box<dyn Error>> {
    Ok(Shape::from_kernel(Cuboid::new(Vector([1.0, 0.8, 0.06]))?))
}

fn ring() -> Result<Shape<3>, Box<dyn Error>> {
    Ok(Shape::from_kernel(Torus::new(0.3, 0.1)?))
}

/// Poses at which the ring is over the plate, in it, beside it, and far away.
fn poses() -> Result<Vec<Pose<3>>, Box<dyn Error>> {
    (0..50)
        .map(|i| {
            let share = f64::from(i) / 50.0;
            let turn = Rotation::from_axis_angle(Vector([1.0, share, -0.3]), 6.0 * share)?;
            Ok(Pose::new(turn, Vector([0.7 * share, -0.4 * share, 0.45 - share])))
        })
        .collect()
}

#[test]
fn a_query_answers_as_the_functions_do_with_a_share_of_the_smaller_body() -> Test {
    let (plate, ring) = (plate()?, ring()?.translated(Vector([0.1, 0.0, 0.3]))?);
    let mut query = Query::new();
    let size = |shape: &Shape<3>| {
        let bounds = shape.promise().bounds.map(|bounds| bounds.aabb.half_extents().norm());
        2.0 * bounds.unwrap_or(0.0)
    };
    let limits = Limits::new(1e-4 * size(&ring).min(size(&plate)));
    let plain = separation(&plate, &ring, &limits, &mut PairWorkspace::new())?;
    assert_eq!(query.separation(&plate, &ring)?, plain);
    let closest = query.closest_points(&plate, &ring)?;
    assert_eq!(closest, plain.map(|nearest| nearest.contact(&plate, &ring)));
    let centre = Vector([0.1, 0.2, 0.5]);
    let of_ball = Limits::new(1e-4 * 0.02);
    let plain = contact_ball(&ring, centre, 0.01, &of_ball, &mut BallWorkspace::new())?;
    assert_eq!(query.contact_ball(&ring, centre, 0.01)?, plain);
    let ray = Ray::new(Vector([0.4, 0.0, 2.0]), Vector([0.0, 0.0, -1.0]), 0.5)?;
    assert_eq!(query.cast_ray(&ring, &ray)?, cast_ray(&ring, &ray, &Limits::new(5e-5))?);
    let corners = [[0.0, 0.0, 0.3], [0.6, 0.0, 0.3], [0.0, 0.6, 0.3]].map(Vector);
    let mesh = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2]])?;
    let limits = Limits::new(1e-4 * 0.72_f64.sqrt());
    let mut workspace = MeshWorkspace::new();
    let plain = mesh_contacts(&ring, &mesh, 0.0, &limits, &mut workspace)?;
    assert!(!plain.contacts.is_empty());
    assert_eq!(query.mesh_contacts(&ring, &mesh)?, *plain);
    Ok(())
}

#[test]
fn an_absolute_tolerance_is_kept_and_a_budget_ends_a_search() -> Test {
    let (plate, ring) = (plate()?, ring()?.translated(Vector([0.1, 0.2, 0.3]))?);
    let mut precise = Query::new().with_tolerance(Tolerance::Absolute(1e-9));
    let answer = precise.separation(&plate, &ring)?;
    assert!(answer.stop == Stop::Converged && answer.upper - answer.lower <= 1e-9);
    let mut hasty = Query::new().with_budget(1);
    let rough = hasty.separation(&plate, &ring)?;
    assert_eq!(rough.stop, Stop::BudgetSpent);
    assert!(rough.lower <= answer.upper && answer.lower <= rough.upper);
    Ok(())
}

#[test]
fn answers_may_go_to_other_threads() {
    fn is_owned<T: Clone + Send + Sync + 'static>() {}
    is_owned::<Certified<Nearest<3>>>();
    is_owned::<(Manifold<3>, Penetration<3>, Proof<3>)>();
    is_owned::<(MeshHits, MeshContacts<3>, ElementContacts<3>)>();
}

#[test]
fn a_batch_has_the_same_bits_on_any_number_of_threads() -> Test {
    let (plate, ring, poses) = (plate()?, ring()?, poses()?);
    let query = Query::new();
    let bits = |answers: &[Option<Certified<Nearest<3>>>]| -> Vec<_> {
        let of = |answer: &Certified<Nearest<3>>| {
            (answer.lower.to_bits(), answer.upper.to_bits(), answer.evaluations)
        };
        answers.iter().map(|answer| answer.as_ref().map(of)).collect()
    };
    let mut alone = Query::new();
    let one_by_one: Vec<_> = poses
        .iter()
        .map(|pose| {
            let there = palpate_query::Placed::new(&ring, *pose);
            alone.separation(&plate, there).ok()
        })
        .collect();
    assert!(one_by_one.iter().flatten().any(|answer| answer.is_hit() == Some(true)));
    assert!(one_by_one.iter().flatten().any(|answer| answer.is_hit() == Some(false)));
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let mut answers = vec![None; poses.len()];
        let asked =
            pool.install(|| query.separations([&plate, &ring], &poses, &mut answers, || true))?;
        assert!(asked);
        assert_eq!(bits(&answers), bits(&one_by_one), "{threads} threads");
        assert!(query.overlaps([&plate, &ring], &poses, &mut answers, || true)?);
        for (sign, distance) in answers.iter().flatten().zip(one_by_one.iter().flatten()) {
            assert_eq!(sign.is_hit(), distance.is_hit());
        }
    }
    Ok(())
}

#[test]
fn a_batch_that_is_stopped_leaves_places_empty() -> Test {
    let (plate, ring, poses) = (plate()?, ring()?, poses()?);
    let begun = AtomicUsize::new(0);
    let mut answers = vec![None; poses.len()];
    let goes_on = || begun.fetch_add(1, Ordering::Relaxed) < 20;
    assert!(!Query::new().separations([&plate, &ring], &poses, &mut answers, goes_on)?);
    assert_eq!(answers.iter().flatten().count(), 20);
    Ok(())
}

#[test]
fn a_batch_refuses_what_a_question_refuses_and_says_which_pose() -> Test {
    let (plate, ring, mut poses) = (plate()?, ring()?, poses()?);
    let query = Query::new();
    let mut answers = vec![None; 3];
    assert_eq!(
        query.separations([&plate, &ring], &poses, &mut answers, || true),
        Err(QueryError::Places { questions: 50, places: 3 })
    );
    poses[17].translation[1] = f64::NAN;
    let mut answers = vec![None; poses.len()];
    let asked = query.separations([&plate, &ring], &poses, &mut answers, || true);
    assert_eq!(asked, Err(QueryError::Pose { index: 17 }));
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    let asked = query.separations([&floor, &floor], &[], &mut [], || true);
    assert_eq!(asked, Err(QueryError::Unbounded));
    Ok(())
}

#[test]
fn a_batch_of_rays_is_answered_as_each_ray() -> Test {
    let ring = ring()?;
    let rays: Vec<_> = (0..50)
        .map(|i| {
            let x = 0.02 * f64::from(i) - 0.5;
            Ray::new(Vector([x, 2.0, 0.1]), Vector([0.1, -1.0, 0.0]), 5.0)
        })
        .collect::<Result<_, _>>()?;
    let mut query = Query::new();
    let one_by_one: Vec<_> =
        rays.iter().map(|ray| query.cast_ray(&ring, ray)).collect::<Result<_, _>>()?;
    assert!(one_by_one.iter().any(|found| found.best.is_some()));
    assert!(one_by_one.iter().any(|found| found.stop == Stop::SignKnown));
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let mut answers = vec![None; rays.len()];
        assert!(pool.install(|| query.cast_rays(&ring, &rays, &mut answers, || true))?);
        assert!(answers.iter().flatten().eq(&one_by_one), "{threads} threads");
    }
    let mut answers = vec![None; rays.len()];
    assert!(!query.cast_rays(&ring, &rays, &mut answers, || false)?);
    assert_eq!(answers.iter().flatten().count(), 0);
    let short = query.cast_rays(&ring, &rays, &mut answers[..2], || true);
    assert_eq!(short, Err(QueryError::Places { questions: 50, places: 2 }));
    let loose = Query::new().with_tolerance(Tolerance::Absolute(-1.0));
    assert!(loose.cast_rays(&ring, &rays, &mut answers, || true).is_err());
    Ok(())
}

/// Sweeps once took no notice of the budget of a query.
#[test]
fn a_sweep_keeps_to_the_budget_of_its_query() -> Test {
    let (plate, ring) = (plate()?, ring()?);
    let way = |y: f64| Pose::translation(Vector([0.0, y, 0.0]));
    let moving = Moving::new(&ring, Screw::new(way(3.0), way(0.0), 0)?);
    let whole = Query::new().cast_shape(&plate, moving)?;
    assert_eq!((whole.touches(), whole.stop), (Some(true), Stop::Converged));
    let few = Query::new().with_budget(3).cast_shape(&plate, moving)?;
    assert_eq!(few.stop, Stop::BudgetSpent);
    assert!(few.lower < whole.lower && whole.upper <= few.upper, "{few:?}, {whole:?}");
    Ok(())
}

#[test]
fn every_question_refuses_a_tolerance_that_is_none() -> Test {
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let element = Element::new([Vector([2.0, 0.0, 0.0]), Vector([0.0, 2.0, 0.0])])?;
    let ray = Ray::new(Vector([3.0, 0.0, 0.0]), Vector([-1.0, 0.0, 0.0]), 9.0)?;
    for tolerance in [f64::NAN, -1e-9, f64::INFINITY] {
        let mut query = Query::new().with_tolerance(Tolerance::Absolute(tolerance));
        let errors = [
            query.separation(&ball, &ball).err(),
            query.manifold(&ball, &ball).err(),
            query.penetration(&ball, &ball).err(),
            query.proof(&ball, &ball).err(),
            query.contact_ball(&ball, Vector([2.0, 0.0, 0.0]), 0.1).err(),
            query.touches_ball(&ball, Vector([2.0, 0.0, 0.0]), 0.1).err(),
            query.minimum(&ball, &element).err(),
            query.touches(&ball, &element).err(),
            query.contacts(&ball, &element).err(),
            query.cast_ray(&ball, &ray).err(),
        ];
        for (i, error) in errors.into_iter().enumerate() {
            assert!(matches!(error, Some(QueryError::Length { .. })), "{i}: {error:?}");
        }
    }
    let limits = Limits::new(f64::NAN);
    let mut workspace = palpate_query::ElementWorkspace::new();
    assert!(minimum(&ball, &element, &limits, &mut workspace).is_err());
    assert!(touches(&ball, &element, &limits, &mut workspace).is_err());
    Ok(())
}
