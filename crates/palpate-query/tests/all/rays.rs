// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays on random trees: nothing is skipped, and what is hit is there.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::kernel::{Ball, Cuboid, HalfSpace};
use palpate_field::{Point, Shape, ShapeError, Vector};
use palpate_query::{Limits, QueryError, Ray, Stop, cast_ray};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Samples along a ray.
const SAMPLES: u32 = 400;

fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut spent = 0;
    cases::on_trees(count, 4, |u, _, shape| {
        let size = draw::size(shape);
        let length = size * [0.1, 1.0, 4.0][u.choose_index(3)?];
        let (origin, direction) = (draw::point(u, shape)?, draw::direction(u)?);
        let Ok(asked) = Ray::new(origin, direction, length) else { return Ok(Ok(())) };
        let limits = Limits::new(1e-4 * size);
        let answer = cast_ray(shape, &asked, &limits).unwrap();
        let wrong = |what: String| Ok(Err(format!("{what}: {answer:?} of {asked:?}")));
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
        spent += u64::from(answer.stop.is_early());
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

/// Where a ray first enters a ball of one metre or a box of 1 m by 2 m by 3 m, by their
/// equations; `None` if it never does.
fn first<const D: usize>(is_ball: bool, origin: Point<D>, way: Vector<f64, D>) -> Option<f64> {
    if is_ball {
        let along = -origin.dot(way);
        let beside = origin + way * along;
        let half = (1.0 - beside.dot(beside)).sqrt();
        return (half + along >= 0.0).then(|| (along - half).max(0.0));
    }
    let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
    for k in 0..D {
        let half = 0.5 * (k as f64 + 1.0);
        let ends = [-half, half].map(|side| (side - origin[k]) / way[k]);
        // On an axis that it does not follow, a ray is between the sides or never is.
        if way[k] == 0.0 && origin[k].abs() > half {
            return None;
        } else if way[k] != 0.0 {
            enters = enters.max(ends[0].min(ends[1]));
            leaves = leaves.min(ends[0].max(ends[1]));
        }
    }
    (enters <= leaves).then_some(enters)
}

/// Rays at a ball and a box, in any pose and from a thousandth to a thousand times as
/// large, hit where the equations say.
fn at_closed_forms<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let (mut hits, mut free) = (0, 0);
    cases::check(count, |u| {
        let pose = draw::pose::<D>(u)?;
        let factor = 10.0_f64.powf(draw::within(u, -3.0, 3.0)?);
        let is_ball = u.arbitrary()?;
        let size = Vector(std::array::from_fn(|k| k as f64 + 1.0));
        let (Ok(ball), Ok(block)) = (Ball::new(1.0), Cuboid::new(size)) else {
            return Ok(Err("no shapes".into()));
        };
        let plain = if is_ball { Shape::from_kernel(ball) } else { Shape::from_kernel(block) };
        let Ok(shape) = plain.clone().scaled(factor).and_then(|s| s.placed(&pose)) else {
            return Ok(Ok(()));
        };
        let origin = draw::point(u, &plain)?;
        let towards = draw::point(u, &plain)?;
        let Some(way) = (towards - origin).normalized() else { return Ok(Ok(())) };
        let length = 20.0 * factor;
        let there = pose.transform_point(origin * factor);
        let Ok(asked) = Ray::new(there, pose.transform_vector(way), length) else {
            return Ok(Ok(()));
        };
        let limits = Limits::new(1e-6 * factor);
        let answer = cast_ray(&shape, &asked, &limits).unwrap();
        let truth = first(is_ball, origin, way).map(|t| t * factor).filter(|t| *t <= length);
        let rounding = 1e-12 * (factor * (1.0 + origin.norm()) + pose.translation.norm());
        let is_right = match (truth, answer.stop) {
            (_, stop) if stop.is_early() => false,
            // What passes within the tolerance may be called a hit.
            (None, _) => {
                answer.best.is_none_or(|hit| shape.distance(hit.point) <= limits.tolerance)
            }
            // A graze by less than rounding may be called free.
            (Some(t), _) => {
                let deepest = shape.distance(asked.at(t + 1e-9 * factor));
                let is_hit = answer.upper <= t + 2.0 * limits.tolerance + rounding;
                answer.lower <= t + rounding && is_hit || deepest > -rounding
            }
        };
        hits += u64::from(answer.best.is_some());
        free += u64::from(answer.best.is_none());
        let complaint = || format!("{answer:?} of {asked:?} should be {truth:?}: {shape:?}");
        Ok(if is_right { Ok(()) } else { Err(complaint()) })
    });
    let count = cases::count(count);
    assert!(hits * 5 > count && free * 10 > count, "{hits} hits, {free} free of {count}");
}

#[test]
fn rays_hit_where_equations_say_at_any_scale() {
    at_closed_forms::<3>(4000);
    at_closed_forms::<2>(4000);
}

#[test]
fn limits_that_are_no_lengths_are_refused_and_zero_says_nothing_wrong() -> Result<(), ShapeError>
{
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let Ok(asked) = Ray::new(Vector([-3.0, 0.6]), Vector([1.0, 0.0]), 10.0) else { panic!() };
    for budget in [0, 10, 1000] {
        for tolerance in [f64::NAN, -1.0, f64::INFINITY] {
            let limits = Limits::new(tolerance).with_budget(budget);
            let refused = cast_ray(&ball, &asked, &limits);
            assert!(matches!(refused, Err(QueryError::Length { .. })), "{refused:?}");
        }
        let exact = Limits::new(0.0).with_budget(budget);
        let answer = cast_ray(&ball, &asked, &exact).unwrap();
        assert!(answer.lower <= 2.2 + 1e-12, "{answer:?}");
        assert!(answer.upper >= 2.2 - 1e-12, "{answer:?}");
    }
    Ok(())
}

#[test]
fn a_ray_along_a_floor_is_free_in_few_steps() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let limits = Limits::new(1e-7);
    let along =
        Ray::new(Vector([0.0, 1e-5]), Vector([2.0, 0.0]), 100.0).unwrap_or_else(|error| {
            panic!("{error}");
        });
    let answer = cast_ray(&floor, &along, &limits).unwrap();
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
    let limits = Limits::new(1e-8);
    let answer = cast_ray(&plate, &down, &limits).unwrap();
    assert!(answer.best.is_some() && (answer.upper - (1e6 - 5e-8)).abs() < 1e-8, "{answer:?}");
    Ok(())
}

#[test]
fn a_ray_that_starts_inside_hits_at_once() -> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let Ok(inside) = Ray::new(Vector([0.5, 0.0]), Vector([0.0, 1.0]), 3.0) else { panic!() };
    let answer = cast_ray(&ball, &inside, &Limits::new(1e-4)).unwrap();
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
