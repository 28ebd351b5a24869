// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A formula of one's own: gradients, answers for arrays of points, and bounds over boxes follow
//! from it.

use palpate::field::scalar::Scalar;
use palpate::field::{Kernel, Promise};
use palpate::prelude::*;

/// A wall of a gyroid: `|sin x cos y + sin y cos z + sin z cos x| / (√12 · frequency) −
/// thickness/2`, where x, y and z are the coordinates times the frequency [1/m].
#[derive(Clone, Debug)]
struct Gyroid {
    frequency: f64,
    thickness: f64,
}

impl Kernel<3> for Gyroid {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.0.map(|x| x.scale(self.frequency));
        let sum = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        // Each derivative of the sum is at most 2, so its slope at most √12.
        sum.abs().scale(1.0 / (self.frequency * 12.0_f64.sqrt()))
            - S::constant(0.5 * self.thickness)
    }

    fn promise(&self) -> Promise<3> {
        Promise::lipschitz(None, 1.0)
    }
}

fn main() -> Result<(), Error> {
    let gyroid = Shape::from_kernel(Gyroid { frequency: 60.0, thickness: 0.002 });
    let block = &Shape::cuboid([0.2; 3])? & &gyroid;
    let (distance, gradient) = block.distance_gradient([0.02, 0.03, 0.01]);
    println!("{distance} m, gradient {gradient:?}");
    println!("it says what it is: {block}");
    let ball = Shape::ball(0.03)?.translated([0.0, 0.129, 0.0])?;
    let touch = Query::new().with_budget(20_000).separation(&block, &ball)?;
    println!("a ball is between {} and {} m away: {}", touch.lower, touch.upper, touch.stop);
    Ok(())
}
