// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Concave bodies that fall on each other in a bin: no tip stays hooked in a flank.

use std::f64::consts::TAU;

use palpate_field::kernel::{CoolS, RegularStar};
use palpate_field::{Shape, ShapeError};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;

use crate::integrator::{Body, Solver};

/// Steps in a second, and seconds of a drop.
const RATE: f64 = 240.0;
const SECONDS: f64 = 3.0;

/// Penetration that a drop may leave beyond the slop [m].
const LEFT: f64 = 2e-4;

fn bin() -> Result<Shape<2>, ShapeError> {
    Shape::union([
        Shape::half_space([0.0, 1.0], 0.0)?,
        Shape::half_space([1.0, 0.0], -0.2)?,
        Shape::half_space([-1.0, 0.0], -0.2)?,
    ])
}

fn falls_free(
    shape: &Shape<2>,
    u: &mut arbitrary::Unstructured<'_>,
) -> arbitrary::Result<Result<(), String>> {
    let mut at = |low, high| draw::within(u, low, high);
    let (x, other) = (at(-0.05, 0.05)?, at(-0.05, 0.05)?);
    let turns = [at(0.0, TAU)?, at(0.0, TAU)?];
    let Ok(bin) = bin() else { return Ok(Err("no bin".into())) };
    let bodies = vec![
        Body::fixed(bin),
        Body::moving(shape.clone(), [x, 0.2], turns[0]),
        Body::moving(shape.clone(), [other, 0.55], turns[1]),
    ];
    let mut solver = Solver::new(bodies, RATE);
    for _ in 0..(RATE * SECONDS) as u32 {
        solver.step();
    }
    let (deepest, bodies) = solver.deepest();
    let slop = solver.slop(bodies);
    let speed = solver.bodies.iter().map(|body| body.velocity.norm()).fold(0.0, f64::max);
    Ok(if deepest < -slop - LEFT {
        let [one, other] = bodies;
        Err(format!(
            "bodies {one} and {other} overlap by {deepest} m at {speed} m/s after a fall"
        ))
    } else {
        Ok(())
    })
}

#[test]
fn stars_that_fall_on_stars_stay_free_of_them() {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06).expect("a star"));
    cases::check(500, |u| falls_free(&star, u));
}

#[test]
fn cool_s_that_fall_on_cool_s_stay_free_of_them() {
    let cool = Shape::from_kernel(CoolS::new(0.3).expect("a Cool S"));
    cases::check(500, |u| falls_free(&cool, u));
}
