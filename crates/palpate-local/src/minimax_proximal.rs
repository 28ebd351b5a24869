// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Steps that lower the larger of two fields, by both their gradients.

use palpate_field::Point;
use palpate_query::minimax_step;
use palpate_query::{DistanceBound, Placed, QueryError};

use crate::{Descent, check_start};

/// What steps are multiplied by after one that leads down, and after one that does not.
const GROW: f64 = 1.5;
const SHRINK: f64 = 0.25;

/// Goes where the larger of both tangent planes, plus a parabola, is least: along the
/// gradient of the farther body, and between both where they are equally far.
///
/// One gradient at a time, as in the memoir's loop, leads to and fro across the ridge on
/// which both values are equal, and on that ridge the minimum lies. Ends inside both
/// bodies at their widest overlap, not at the first point in both.
///
/// An upper bound, without a proof: it finds the overlap next to its start, or none. As
/// [`AlternatingProjection`](crate::AlternatingProjection)'s example, of two dents in
/// which balls lie it finds the one it starts in:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_local::MinimaxProximal;
/// use palpate_query::{Limits, PairWorkspace, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = |x: f64, y: f64| Shape::from_kernel(Ball::new(0.5)?).translated(Vector([x, y]));
/// let below = Shape::union([ball(-2.0, 0.0)?, ball(2.0, 0.0)?])?;
/// let above = Shape::union([ball(-2.0, 1.1)?, ball(2.0, 0.9)?])?;
/// let found = MinimaxProximal::default().descend(&below, &above, Vector([-1.8, 0.4]), 1e-9)?;
/// assert!((found.value - 0.05).abs() < 1e-8);
/// let limits = Limits::new(1e-4);
/// let proven = separation(&below, &above, &limits, &mut PairWorkspace::new())?;
/// assert!((proven.upper + 0.1).abs() < 1e-4);
/// let short = MinimaxProximal { steps: 1, ..MinimaxProximal::default() };
/// assert_eq!(short.descend(&below, &above, Vector([-1.8, 0.4]), 1e-9)?.steps, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MinimaxProximal {
    /// Steps at most; 40.
    pub steps: u32,
}

impl Default for MinimaxProximal {
    fn default() -> Self {
        Self { steps: 40 }
    }
}

impl MinimaxProximal {
    /// The search for the least of `max(g_a, g_b)` from `start` [m], until steps are
    /// smaller than `tolerance` [m].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, a pose is not finite, or the
    /// tolerance is negative.
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
        let mut here = slopes(start);
        let mut descent = Descent::from_start(start, here[0].0.max(here[1].0), 4);
        let mut size = descent.value.abs().max(tolerance);
        while descent.steps < self.steps && size >= tolerance && size > 0.0 {
            descent.steps += 1;
            let [(a, slope_a), (b, slope_b)] = here;
            let next = descent.best - minimax_step([a, b], [slope_a, slope_b], size);
            let there = slopes(next);
            descent.evaluations += 4;
            let value = there[0].0.max(there[1].0);
            if value < descent.value {
                descent.visit(next, value);
                here = there;
                size *= GROW;
            } else {
                size *= SHRINK;
            }
        }
        Ok(descent)
    }
}
