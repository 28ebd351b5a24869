// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays on random trees: nothing is skipped, and what is hit is there.

use palpate_field::field::{DifferentiateBlock, EvaluateBlock, Field};
use palpate_field::kernel::{Ball, Cuboid, HalfSpace};
use palpate_field::{SHORT, Shape, ShapeError, Vector};
use palpate_query::{Limits, QueryError, Ray, Stop, ray};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::{Solid, Tree};

/// Samples along a ray.
const SAMPLES: u32 = 400;

fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
    dyn Field<D>: EvaluateBlock<f64, D, SHORT> + DifferentiateBlock<f64, D, SHORT>,
{
    let (mut seed, mut spent) = (0, 0);
    cases::check(count, |u| {
        seed += 1;
        let tree: Tree<D> = draw::tree(u, 1 + (seed % 4))?;
        let Ok(shape) = tree.shape() else { return Ok(Ok(())) };
        let size = draw::size(&shape);
        let length = size * [0.1, 1.0, 4.0][u.choose_index(3)?];
        let (origin, direction) = (draw::point(u, &shape)?, draw::direction(u)?);
        let Ok(asked) = Ray::new(origin, direction, length) else { return Ok(Ok(())) };
        let limits = Limits { tolerance: 1e-4 * size, ..Limits::default() };
        let answer = ray(&shape, &asked, &limits);
        let wrong =
            |what: String| Ok(Err(format!("{what}: {answer:?} of {asked:?}\n  {tree:?}")));
        let before = if answer.lower > 0.0 { SAMPLES } else { 0 };
        for i in 0..before {
            let t = answer.lower * f64::from(i) / f64::from(SAMPLES);
            let p = asked.at(t);
            let value = shape.distance(p);
            if value < -shape.promise().rounding.within(p.norm()) {
                return wrong(format!("{value} m at {t} m"));
            }
        }
        if let Some(hit) = answer.best {
            let value = shape.distance(asked.at(answer.upper));
            if value > limits.tolerance || hit.point != asked.at(answer.upper) {
                return wrong(format!("{value} m where it hits"));
            }
            if answer.stop == Stop::Converged && answer.upper - answer.lower > limits.tolerance
            {
                return wrong("not converged".into());
            }
        } else if answer.stop == Stop::SignKnown && answer.lower < length {
            return wrong("free, but not to the end".into());
        }
        spent += u64::from(answer.stop == Stop::BudgetSpent);
        Ok(Ok(()))
    });
    assert!(spent * 100 <= count, "{spent} of {count} rays spent their budget");
}

#[test]
fn rays_in_space_skip_nothing() {
    on_trees::<3>(1500);
}

#[test]
fn rays_in_the_plane_skip_nothing() {
    on_trees::<2>(1500);
}

#[test]
fn a_ray_along_a_floor_is_free_in_few_steps() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let limits = Limits { tolerance: 1e-7, ..Limits::default() };
    let along =
        Ray::new(Vector([0.0, 1e-5]), Vector([2.0, 0.0]), 100.0).unwrap_or_else(|error| {
            panic!("{error}");
        });
    let answer = ray(&floor, &along, &limits);
    assert_eq!((answer.best, answer.stop), (None, Stop::SignKnown));
    // By plain steps there would be ten million.
    assert!(answer.evaluations < 10_000, "{answer:?}");
    Ok(())
}

#[test]
fn a_thin_plate_is_not_skipped() -> Result<(), ShapeError> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([1.0, 1e-7, 1.0]))?);
    let down = Ray::new(Vector([0.1, 1e6, 0.2]), Vector([0.0, -1.0, 0.0]), 1e15);
    let Ok(down) = down else { panic!("a ray") };
    let limits = Limits { tolerance: 1e-8, ..Limits::default() };
    let answer = ray(&plate, &down, &limits);
    assert!(answer.best.is_some() && (answer.upper - (1e6 - 5e-8)).abs() < 1e-8, "{answer:?}");
    Ok(())
}

#[test]
fn a_ray_that_starts_inside_hits_at_once() -> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let Ok(inside) = Ray::new(Vector([0.5, 0.0]), Vector([0.0, 1.0]), 3.0) else { panic!() };
    let answer = ray(&ball, &inside, &Limits::default());
    assert_eq!((answer.lower, answer.upper), (0.0, 0.0));
    assert_eq!(answer.best.and_then(|hit| hit.normal), Some(Vector([1.0, 0.0])));
    Ok(())
}

#[test]
fn rays_that_are_none_are_refused() {
    let at = Vector([0.0, 0.0]);
    assert_eq!(Ray::new(at, at, 1.0), Err(QueryError::NoDirection));
    let negative = Ray::new(at, Vector([1.0, 0.0]), -1.0);
    assert_eq!(negative, Err(QueryError::Length { value: -1.0 }));
    assert!(Ray::new(Vector([f64::NAN, 0.0]), Vector([1.0, 0.0]), 1.0).is_err());
    let tiny = Ray::new(at, Vector([1e-300, 0.0]), 1.0);
    assert_eq!(tiny, Ray::new(at, Vector([2.0, 0.0]), 1.0));
}
