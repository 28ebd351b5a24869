// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A shape from a closure: a wavy floor, joined with a ball.
//!
//! The closure computes with duals, so its gradient needs no differences. All that
//! is known of it is its steepness, and the promise says so.

use palpate::field::Promise;
use palpate::field::scalar::Scalar;
use palpate::prelude::*;

fn main() -> Result<(), Error> {
    // y = 5 mm · sin(40 x): at most √(1 + 0.2²) steep, rounded up.
    let promise = Promise::lipschitz(None, 1.02);
    let floor =
        Shape::from_fn(promise, |Vector([x, y, _])| y - x.scale(40.0).sin().scale(0.005));
    let ball = Shape::ball(0.02)?.translated([0.0, 0.04, 0.0])?;
    let world = floor | ball;
    for height in [0.01, 0.03, 0.08] {
        let p = Vector([0.0, height, 0.0]);
        let (distance, gradient) = world.distance_gradient(p);
        println!(
            "{height} m up: value {distance:.4} m, gradient {:.3?}, free for {:.4} m",
            gradient.0,
            world.safe_radius(p)
        );
    }
    Ok(())
}
