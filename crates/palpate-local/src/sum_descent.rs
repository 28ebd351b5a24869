// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `MuJoCo`'s descent for two fields, of `engine_collision_sdf.c`.

use palpate_field::{Point, Vector};
use palpate_query::{DistanceBound, Placed, QueryError};

use crate::{Descent, check_start};

/// Both values at a point, with their gradients.
type Slopes<const D: usize> = [(f64, Vector<f64, D>); 2];

/// The share of the promised descent that a step must keep (Armijo 1966).
const KEPT: f64 = 0.1;

/// Goes down the gradient of `A + B + |max(A, B)|` of the values A, B of both fields, with steps that
/// are halved until they lead down by a tenth of what the gradient promises.
///
/// Where the bodies overlap, the sum is `min(A, B)`: how deep the surface of one body lies in the other,
/// whose least value is on the surface of the overlap and not where both are deepest. So a last
/// step leads down the larger of both values. The answer, as published, is that value at the last point,
/// which need not be the lowest on the way.
///
/// Factors of a gradient, whose length is up to 3, begin at 1 m and end at 0.1 mm: whatever the size of the
/// bodies, the first steps that are tried are metres long, and places are known to a tenth of a millimetre.
///
/// `MuJoCo` starts 40 descents at the points of [`halton_starts`](crate::halton_starts) and keeps those
/// that end in both bodies.
///
/// An upper bound, without a proof, as [`MinimaxProximal`](crate::MinimaxProximal):
///
/// ```
/// use palpate_field::{Pose, Shape, Vector};
/// use palpate_local::{SumDescent, halton_starts};
/// use palpate_query::Placed;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::ball(0.5)?;
/// let there = Placed::new(&ball, Pose::translation([0.9, 0.0, 0.0]));
/// let descents = halton_starts(&ball, there, 40)
///     .into_iter()
///     .map(|start| SumDescent::default().descend(&ball, there, start, 0.0));
/// let values = descents.map(|found| found.map(|found| found.value));
/// let least = values.collect::<Result<Vec<_>, _>>()?.into_iter().fold(f64::INFINITY, f64::min);
/// // A point in both, but not the deepest: in the middle both are 0.05 m deep.
/// assert!(least < 0.0 && least > -0.049);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumDescent {
    /// Steps at most; 10, as `MuJoCo`'s `sdf_iterations`.
    pub steps: u32,
    /// The first factor of a gradient that is tried; 1.
    pub largest: f64,
    /// Factors are halved until they are at most this; 1e-4.
    pub smallest: f64,
}

impl Default for SumDescent {
    fn default() -> Self {
        Self { steps: 10, largest: 1.0, smallest: 1e-4 }
    }
}

impl<const D: usize> Descent<D> {
    /// Goes on to a point, which is the answer so far.
    fn take(&mut self, p: Point<D>, value: f64, evaluations: u32) {
        self.path.push(p);
        (self.best, self.value) = (p, value);
        self.evaluations += evaluations;
        self.steps += 1;
    }
}

impl SumDescent {
    /// How many starts `MuJoCo` tries, its `sdf_initpoints`.
    pub const STARTS: u32 = 40;

    /// The descent from `start` [m], until a step is shorter than `tolerance` [m] or leads up.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, a pose is not finite, or the tolerance is
    /// negative.
    pub fn descend<'a, const D: usize>(
        &self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        start: Point<D>,
        tolerance: f64,
    ) -> Result<Descent<D>, QueryError> {
        check_start(start, tolerance)?;
        let bodies = DistanceBound::of_both(a, b)?;
        let slopes = |p: Point<D>| bodies.map(|body| body.distance_gradient(p));
        let larger = |[(a, _), (b, _)]: [(f64, _); 2]| a.max(b);
        let sum = |[(a, _), (b, _)]: [(f64, _); 2]| a + b + a.max(b).abs();
        let mut p = start;
        let mut here = slopes(p);
        let mut descent = Descent::from_start(start, larger(here), 4);
        // Halved until it leads down; at last it may lead up.
        let step = |p: Point<D>,
                    gradient: Vector<f64, D>,
                    promised: &dyn Fn(Slopes<D>, f64) -> bool| {
            let (mut factor, mut evaluations) = (self.largest, 0);
            loop {
                let next = p - gradient * factor;
                let there = slopes(next);
                evaluations += 4;
                if promised(there, factor) || factor <= self.smallest {
                    return (next, there, factor, evaluations);
                }
                factor *= 0.5;
            }
        };
        while descent.steps < self.steps {
            let [(a, slope_a), (b, slope_b)] = here;
            let (greater, its_slope) = if a > b { (a, slope_a) } else { (b, slope_b) };
            let gradient = slope_a + slope_b + its_slope * greater.signum();
            let squared = gradient.dot(gradient);
            let before = sum(here);
            let leads_down =
                |there, factor: f64| sum(there) - before <= -KEPT * factor * squared;
            let (next, there, factor, evaluations) = step(p, gradient, &leads_down);
            (p, here) = (next, there);
            descent.take(p, larger(here), evaluations);
            if sum(here) >= before || factor * squared.sqrt() <= tolerance {
                break;
            }
        }
        let before = larger(here);
        let [(a, slope_a), (b, slope_b)] = here;
        let gradient = if a > b { slope_a } else { slope_b };
        let squared = gradient.dot(gradient);
        let leads_down =
            |there, factor: f64| larger(there) - before <= -KEPT * factor * squared;
        let (next, there, _, evaluations) = step(p, gradient, &leads_down);
        descent.take(next, larger(there), evaluations);
        Ok(descent)
    }
}
