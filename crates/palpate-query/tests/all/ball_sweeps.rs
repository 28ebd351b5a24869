// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Balls that move along lines: never late, and early by the tolerance at most.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::kernel::{Ball, Cuboid, HalfSpace};
use palpate_field::{Point, Shape, Vector};
use palpate_query::{BallWorkspace, Limits, QueryError, Ray, Stop, cast_ball, contact_ball};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Places of the ball on its way that are looked at, and points in it.
const PLACES: u32 = 60;
const POINTS: u32 = 40;

fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let (mut ran, mut spent, mut touched) = (0, 0, 0);
    let mut workspace = BallWorkspace::new();
    cases::on_trees(count, 4, |u, _, shape| {
        let size = draw::size(shape);
        let radius = size * draw::within(u, 1e-3, 0.3)?;
        let length = size * [0.1, 1.0, 4.0][u.choose_index(3)?];
        let (origin, direction) = (draw::point(u, shape)?, draw::direction(u)?);
        let Ok(ray) = Ray::new(origin, direction, length) else { return Ok(Ok(())) };
        let limits = Limits::new(1e-4 * size);
        let answer = cast_ball(shape, &ray, radius, &limits, &mut workspace).unwrap();
        let wrong =
            |what: String| Ok(Err(format!("{what}: {answer:?} of {ray:?}, {radius} m")));
        for place in 0..PLACES {
            let centre = ray.at(answer.lower * f64::from(place) / f64::from(PLACES));
            for _ in 0..POINTS {
                let way: Vector<f64, D> = draw::direction(u)?;
                let p: Point<D> = centre + way * (radius * draw::within(u, 0.0, 1.0)?);
                let value = shape.distance(p);
                if answer.lower > 0.0 && value < -shape.promise().rounding.within(p.norm()) {
                    return wrong(format!("{value} m in the ball about {centre:?}"));
                }
            }
        }
        if let Some(contact) = answer.best {
            touched += 1;
            let centre = ray.at(answer.upper);
            let near = limits.with_tolerance(0.1 * limits.tolerance);
            let gap = contact_ball(shape, centre, radius, &near, &mut workspace).unwrap();
            if gap.lower > limits.tolerance || contact.gap > 2.0 * limits.tolerance {
                return wrong(format!("a gap of {} m where it touches", gap.lower));
            }
            if answer.stop == Stop::Converged && answer.upper - answer.lower > limits.tolerance
            {
                return wrong("not converged".into());
            }
        } else if answer.stop == Stop::SignKnown && answer.lower < length {
            return wrong("free, but not to the end".into());
        }
        ran += 1;
        spent += u64::from(answer.stop.is_early());
        Ok(Ok(()))
    });
    assert!(spent * 50 <= ran, "{spent} of {ran} balls spent their budget");
    assert!(touched * 10 > ran, "{touched} of {ran} balls touched");
}

#[test]
fn balls_in_space_are_never_late() {
    on_trees::<3>(400);
}

#[test]
fn balls_in_the_plane_are_never_late() {
    on_trees::<2>(400);
}

/// A ball meets a plane, a ball and the corner of a box where their equations say.
#[test]
fn balls_touch_where_equations_say() {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0).unwrap());
    let ball = Shape::from_kernel(Ball::new(1.0).unwrap());
    let block = Shape::from_kernel(Cuboid::new(Vector([2.0, 2.0, 2.0])).unwrap());
    let mut workspace = BallWorkspace::new();
    let limits = Limits::new(1e-9);
    let mut touch = |shape: &Shape<3>, from: [f64; 3], way: [f64; 3], radius: f64| {
        let ray = Ray::new(from, way, 10.0).unwrap();
        cast_ball(shape, &ray, radius, &limits, &mut workspace).unwrap()
    };
    // Down at 30° to the floor: (2 − 0.5) / sin 30°.
    let slope = [3.0_f64.sqrt() / 2.0, -0.5, 0.0];
    // At a distance of 1.2 m past the centre of a ball, radii of 1.5 m together: 5 − 0.9.
    // Past an edge of the box, 0.3 m off its side, with a radius of 0.5 m: 4 − 0.4.
    for (shape, from, way, radius, truth) in [
        (&floor, [0.0, 2.0, 0.0], slope, 0.5, 3.0),
        (&ball, [-5.0, 1.2, 0.0], [1.0, 0.0, 0.0], 0.5, 4.1),
        (&block, [-5.0, 1.3, 0.0], [1.0, 0.0, 0.0], 0.5, 3.6),
    ] {
        let answer = touch(shape, from, way, radius);
        let near = answer.upper - truth;
        // At a slope the gap falls more slowly than the ball moves.
        assert!(answer.lower <= truth && near.abs() <= 4e-9, "{answer:?}, {truth}");
        assert_eq!(answer.stop, Stop::Converged);
    }
    // It grazes the ball, and misses it by a micrometre.
    let past = touch(&ball, [-5.0, 1.500_001, 0.0], [1.0, 0.0, 0.0], 0.5);
    assert_eq!((past.best, past.stop, past.lower), (None, Stop::SignKnown, 10.0));
    // It begins in contact.
    let inside = touch(&ball, [0.5, 0.0, 0.0], [1.0, 0.0, 0.0], 0.1);
    assert_eq!((inside.lower, inside.upper), (0.0, 0.0));
}

/// 1000 directions at a plate of 0.1 mm, which a step of 10 m/s at 1 kHz is a hundred times as long
/// as.
#[test]
fn a_thin_plate_is_not_missed() {
    let plate = Shape::from_kernel(Cuboid::new(Vector([1.0, 1e-4, 1.0])).unwrap());
    let mut workspace = BallWorkspace::new();
    let limits = Limits::new(1e-6);
    cases::check(1000, |u| {
        let way: Vector<f64, 3> = draw::direction(u)?;
        let radius = draw::within(u, 1e-4, 0.01)?;
        let Ok(ray) = Ray::new(way * -0.3, way, 0.6) else { return Ok(Ok(())) };
        let answer = cast_ball(&plate, &ray, radius, &limits, &mut workspace).unwrap();
        // The centre of the plate is on its way.
        let is_right =
            answer.best.is_some() && answer.upper <= 0.3 && answer.stop == Stop::Converged;
        Ok(if is_right { Ok(()) } else { Err(format!("{answer:?} of {ray:?}, {radius} m")) })
    });
}

#[test]
fn lengths_that_are_none_are_refused() {
    let ball = Shape::from_kernel(Ball::new(1.0).unwrap());
    let ray = Ray::new([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 5.0).unwrap();
    let mut workspace = BallWorkspace::new();
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = cast_ball(&ball, &ray, wrong, &Limits::new(1e-6), &mut workspace);
        assert!(matches!(refused, Err(QueryError::Length { .. })), "{refused:?}");
        let limits = Limits::new(wrong);
        assert!(cast_ball(&ball, &ray, 0.1, &limits, &mut workspace).is_err());
    }
}
