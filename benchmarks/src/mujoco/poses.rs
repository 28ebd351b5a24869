// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses of two bodies that overlap by a known depth.

use std::error::Error;

use palpate::field::{Point, Pose, Shape, Vector};
use palpate::query::{
    Certified, Limits, Nearest, PairWorkspace, Placed, QueryError, separation,
};
use rayon::prelude::*;

use crate::collide::{Space, Turn};
use crate::random::Random;

/// How well a depth is known, as a share of it: the bounds of the separation are within it.
pub(super) const KNOWN: f64 = 0.01;

/// How close to a depth bodies are put, as a share of it, and how far apart the bounds may be:
/// with the half of the latter, less than [`KNOWN`].
const PLACED: f64 = 0.005;

/// The tolerance of a separation that halves an interval, as a share of the interval: larger ones
/// are asked for twice more often, smaller ones take longer.
const COARSE: f64 = 0.02;

/// Evaluations for one separation. A pose whose depth takes more to know is replaced.
const BUDGET: u32 = 500_000;

/// Turns and ways that are tried for a pose, some of which lead through a hole.
const TRIES: u32 = 100;

/// Two bodies in a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// Of the second body; the first is at the origin.
    pub(super) pose: Pose<3>,
    /// A point in both bodies, where both are deepest.
    pub(super) witness: Point<3>,
    /// The middle of the bounds of the depth [m].
    pub(super) depth: f64,
    /// Poses before this one whose depth did not get known within the budget.
    pub(super) replaced: u32,
}

/// So many poses of a depth [m], the same in every run.
pub(super) fn placed(
    bodies: [&Shape<3>; 2],
    depth: f64,
    count: usize,
) -> Result<Vec<Known>, Box<dyn Error>> {
    let poses = (0..count).into_par_iter().map(|i| {
        // Any seeds that differ in many digits.
        let seed = (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        place(bodies, depth, &mut Random::new(seed)).map_err(|error| error.to_string())
    });
    Ok(poses.collect::<Result<_, _>>()?)
}

fn place(
    [a, b]: [&Shape<3>; 2],
    depth: f64,
    random: &mut Random,
) -> Result<Known, Box<dyn Error>> {
    let mut workspace = PairWorkspace::new();
    let reach = [a, b].map(|shape| shape.promise().bounds.map(|b| b.radius_about_origin()));
    let [Some(reach_a), Some(reach_b)] = reach else {
        return Err("a body is unbounded".into());
    };
    let mut replaced = 0;
    for _ in 0..TRIES {
        let turn = Space::any(random)?;
        let way: Vector<f64, 3> = Vector(random.point([0.0; 3], 1.0));
        let way = way * (1.0 / way.norm());
        let at = |apart: f64| Pose::new(turn, way * apart);
        let ask = |apart: f64, tolerance| {
            let limits = Limits::new(tolerance).with_budget(BUDGET);
            separation(a, Placed::new(b, at(apart)), &limits, &mut workspace)
        };
        match bisect(ask, reach_a + reach_b, depth)? {
            Some((apart, answer)) if is_known(&answer, depth) => {
                let (witness, depth) = (answer.best.point, -middle(&answer));
                return Ok(Known { pose: at(apart), witness, depth, replaced });
            }
            Some(_) => replaced += 1,
            // The way leads through a hole.
            None => {}
        }
    }
    Err(format!("no pose of depth {depth} m in {TRIES} tries").into())
}

/// `true` if the bounds of a separation are within [`KNOWN`] of a depth.
fn is_known(answer: &Certified<Nearest<3>>, depth: f64) -> bool {
    answer.lower >= -depth * (1.0 + KNOWN) && answer.upper <= -depth * (1.0 - KNOWN)
}

/// The middle of the bounds [m].
fn middle(answer: &Certified<Nearest<3>>) -> f64 {
    0.5 * (answer.lower + answer.upper)
}

/// How far apart two bodies overlap by a depth, between concentric and `far`, and the separation
/// there; `None` if they do not overlap by as much in the middle.
///
/// The interval is divided where its ends' separations say, but near its middle, and the
/// separation is asked for only as precisely as the interval is long.
fn bisect(
    mut ask: impl FnMut(f64, f64) -> Result<Certified<Nearest<3>>, QueryError>,
    mut far: f64,
    depth: f64,
) -> Result<Option<(f64, Certified<Nearest<3>>)>, QueryError> {
    let finest = PLACED * depth;
    // Coarse, unless how much more than `-depth` the separation is may have another sign.
    let mut separation = |apart: f64, coarse: f64| {
        let answer = ask(apart, coarse.max(finest))?;
        let is_decided = (middle(&answer) + depth).abs() > coarse;
        if is_decided || coarse <= finest { Ok(answer) } else { ask(apart, finest) }
    };
    let mut near = 0.0;
    let mut below = middle(&separation(near, COARSE * far)?) + depth;
    let mut above = middle(&separation(far, COARSE * far)?) + depth;
    if below > 0.0 {
        return Ok(None);
    }
    loop {
        let share = (-below / (above - below)).clamp(0.1, 0.9);
        let apart = near + (far - near) * share;
        let answer = separation(apart, COARSE * (far - near))?;
        let here = middle(&answer) + depth;
        // The separation changes by no more than the place.
        if here.abs() < finest || far - near < finest {
            return Ok(Some((apart, answer)));
        }
        if here > 0.0 { (far, above) = (apart, here) } else { (near, below) = (apart, here) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate::field::kernel::Ball;

    /// Two balls of radius 1 overlap by 2 − distance, which is the width of the widest ball in
    /// both.
    #[test]
    fn balls_are_put_at_their_depth() -> Result<(), Box<dyn Error>> {
        let ball = Shape::from_kernel(Ball::new(1.0)?);
        for depth in [0.01, 0.5] {
            let poses = placed([&ball, &ball], depth, 5)?;
            assert_eq!(poses.len(), 5);
            for known in poses {
                let distance = known.pose.transform_point(Vector([0.0; 3])).norm();
                assert!((2.0 - distance - known.depth).abs() < PLACED * depth, "{known:?}");
                assert!((known.depth / depth - 1.0).abs() < KNOWN, "{known:?}");
                let from_a = known.witness.norm();
                let from_b =
                    (known.witness - known.pose.transform_point(Vector([0.0; 3]))).norm();
                let deepest = 1.0 - from_a.max(from_b);
                assert!((2.0 * deepest - depth).abs() < KNOWN * depth, "{known:?}");
            }
        }
        Ok(())
    }

    #[test]
    fn a_depth_that_no_pose_has_is_refused() -> Result<(), Box<dyn Error>> {
        let ball = Shape::from_kernel(Ball::new(1.0)?);
        assert!(placed([&ball, &ball], 2.5, 1).is_err());
        Ok(())
    }
}
