// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Carrying: a moving body takes a tool that rests on it along.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Pose;

use super::Tool;
use super::coupling::Twist;
use super::scan::{Path, Surroundings};
use super::settle::Lengths;
use crate::nearby::Nearby;

/// The part of the budget for evaluations before the carried motion; the tool must come to rest
/// with the remainder.
const SHARE: f64 = 0.25;

/// Another body is near if it is within so many reaches of the tool: then it may be the nearest to a
/// point of a tool that touches its carrier.
const NEARNESS: f64 = 4.0;

/// The most ticks in which a tool rides on a body before all of its points are evaluated anew.
const MOST_RIDDEN: u32 = 1024;

/// A body does not carry the tool to a place this many times as far from the origin as it is
/// now: so far away, rounding would hide the bodies.
const FARTHEST: f64 = 1e3;

impl Tool {
    /// The motion that the body under the tool gives to a tool at `start`; `None` if the body
    /// did not move, or moved too far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn carrier(
        &self,
        nearby: &Nearby<'_>,
        start: &Pose<3>,
        device: &Pose<3>,
    ) -> Option<Twist> {
        let body = nearby.body(self.carrier?)?;
        let carried = body.carried_pose(start)?;
        let far = |pose: &Pose<3>| pose.translation.norm();
        let here = far(start).max(far(device)).max(nearby.size().unwrap_or(0.0));
        // Written so that NaN is not carried.
        let is_near = far(&carried) <= FARTHEST * (here + self.shell().reach());
        is_near.then(|| Twist::between(start, &carried))
    }

    /// Whether a tool at `start`, which would move like `motion`, rides on the body under it: nothing
    /// else is near. Its evaluations then stay what they are in the body.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn rides(
        &mut self,
        nearby: &Nearby<'_>,
        start: &Pose<3>,
        motion: &Twist,
    ) -> bool {
        let reach = self.shell.reach();
        let Some(carrier) = self.carrier.filter(|_| self.touch.contact) else { return false };
        let moved = nearby.body(carrier).and_then(|body| body.motion());
        let Some(moved) = moved.filter(|_| self.yielding.is_empty()) else { return false };
        let way = (moved.transform_point(start.translation) - start.translation).norm();
        let far = NEARNESS * reach + motion.way(reach) + way;
        let is_alone = nearby
            .all()
            .all(|(index, body)| index == carrier || body.above_way(start.translation) > far);
        self.ridden = if is_alone { self.ridden + 1 } else { 0 };
        // Roundings must not add up.
        let rides = is_alone && way <= reach && !self.ridden.is_multiple_of(MOST_RIDDEN);
        if rides {
            self.scan.ride(&moved);
        }
        rides
    }

    /// The pose of a tool carried from `start`, up to the first body in the way. Bodies have
    /// their poses after the tick; points inside them are being pushed out and do not stop the
    /// motion.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most the evaluations that
    /// the budget has left.
    pub(super) fn carried(
        &mut self,
        nearby: &Nearby<'_>,
        start: Pose<3>,
        carry: &Twist,
        lengths: Lengths,
    ) -> Pose<3> {
        let length = carry.way(self.shell.reach());
        let horizon = length + lengths.skin;
        let surroundings = Surroundings { shell: &self.shell, nearby };
        let path = Path { pose: &start, twist: carry };
        if !self.scan.look(surroundings, path, horizon, SHARE) {
            return start;
        }
        let part = self.scan.sweep(surroundings, path, lengths.skin, 1.0);
        // Stop before the obstacle instead of a skin deep in it, because friction only holds a
        // tool that is outside.
        let short = if part < 1.0 { lengths.skin / length } else { 0.0 };
        let carried = carry.part((part - short).max(0.0));
        self.scan.moved(&carried);
        carried.moved(&start)
    }
}
