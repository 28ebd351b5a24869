// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a body that moves takes a tool that rests on it.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Pose;

use super::Tool;
use super::settle::Lengths;
use super::twist::Twist;
use crate::nearby::Nearby;

/// What it takes to look around before the way, as a part of the budget: a tick that is carried
/// has to come to rest with what is left.
const SHARE: f64 = 0.25;

/// A body that would carry the tool to a place this many times as far from the origin leaves it
/// behind: so far away, rounding would hide what is here.
const FARTHEST: f64 = 1e3;

impl<const D: usize> Tool<D> {
    /// The motion of the body that the tool rests on, at a tool at `start`; none if it did not
    /// move, or moved too far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn carrier(
        &self,
        nearby: &Nearby<'_, D>,
        start: &Pose<D>,
        device: &Pose<D>,
    ) -> Option<Twist<D>> {
        let body = nearby.body(self.carrier?)?;
        let carried = body.carried_pose(start)?;
        let far = |pose: &Pose<D>| pose.translation.norm();
        let here = far(start).max(far(device)).max(nearby.size().unwrap_or(0.0));
        // Written so that NaN is left behind.
        let is_near = far(&carried) <= FARTHEST * (here + self.shell().reach());
        is_near.then(|| Twist::between(start, &carried))
    }

    /// Where the tool is that is carried from `start`: as far as no body is in the way. Bodies are
    /// where they are after the tick, and points that they push are on their way out.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most the evaluations that
    /// the budget has left.
    pub(super) fn carried(
        &mut self,
        nearby: &Nearby<'_, D>,
        (start, carry): (Pose<D>, &Twist<D>),
        lengths: Lengths,
    ) -> Pose<D> {
        let length = carry.way(self.shell.reach());
        let horizon = length + lengths.skin;
        if !self.scan.look(&self.shell, nearby, &start, (carry, horizon, SHARE)) {
            return start;
        }
        let way = (&start, carry);
        let part = self.scan.sweep((&self.shell, nearby), way, lengths.skin, 1.0);
        // Before what stops it, not a skin deep in it: friction holds a tool that is outside.
        let short = if part < 1.0 { lengths.skin / length } else { 0.0 };
        let carried = carry.part((part - short).max(0.0));
        self.scan.moved(&carried);
        carried.moved(&start)
    }
}
