// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The force that a contact point gives to the hand, of the force that its bodies want.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use super::{ContactPoint, Setting, Touch};
use crate::nearby::Nearby;
use palpate_device::{PointState, limited, shortening};
use palpate_safety::{Arrival, Change, PortState};

/// The force in free space, of guides and magnets.
#[derive(Clone, Copy)]
pub(crate) struct FreeForce {
    /// The force [N].
    pub(crate) force: Vector<f64, 3>,
    /// Whether the proxy was placed anew: then all forces rise from zero.
    pub(crate) placed: bool,
    /// What happened beside the motion of the hand.
    pub(crate) change: Change,
}

impl ContactPoint {
    /// Takes note that the bodies `before` are replaced by those of `after` before the next tick;
    /// `wanted` is their last force [N]. The new ones carry the proxy out where they cover it, for a
    /// point by `most_of_point` [m] at most.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn replace_bodies(
        &mut self,
        [before, after]: [&Nearby<'_>; 2],
        wanted: Vector<f64, 3>,
        most_of_point: f64,
    ) {
        self.proxy.carry_out(before, after, most_of_point);
        self.of_others = wanted.norm();
    }

    /// Lets the force rise from zero; with a port, the safety chain does this.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn rise_anew(&mut self) {
        self.rise = 0.0;
    }

    /// Sets the rendered force of `touch` from its wanted force and the force in free space.
    /// Returns the force to write [N], in device coordinates. If `placed`, the force rises from
    /// zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(always)]
    pub(crate) fn give(
        &mut self,
        setting: &Setting,
        at_device: PointState,
        touch: &mut Touch,
        free: FreeForce,
    ) -> Vector<f64, 3> {
        let FreeForce { force: free, placed, change } = free;
        let Setting { options, map, rise_step, arrival, .. } = setting;
        let has_start = placed || self.of_others < f64::INFINITY;
        let start = if has_start {
            self.start([placed, change == Change::Carried], touch.wanted)
        } else {
            1.0
        };
        if let Some(port) = &mut self.port {
            let wanted = map.force_to_device(touch.wanted);
            let PointState { position, velocity } = at_device;
            let free_force = map.force_to_device(free);
            let Arrival { late, elapsed, is_ready } = *arrival;
            let change = if is_ready { change } else { Change::Begins };
            let stiffness = self.stiffness * map.scale();
            let state = PortState {
                position,
                velocity,
                free_force,
                late,
                elapsed,
                start,
                change,
                stiffness,
            };
            let force = port.write(wanted, options.max_force, &state);
            touch.force = map.force_to_world(force);
            force
        } else {
            let rise = self.rise(start, touch.contact, *rise_step);
            if change == Change::Carried {
                self.approach.begin();
            }
            let wanted = self.approach.step(touch.wanted).unwrap_or(touch.wanted);
            touch.force = limited(wanted + free, options.max_force) * rise;
            map.force_to_device(touch.force)
        }
    }

    /// The part of the force at which the rise begins: zero after a placement; after bodies
    /// were replaced, the part that equals the force of the old bodies, unless they carried the
    /// proxy out.
    #[cold]
    #[inline(never)]
    fn start(&mut self, [placed, carried]: [bool; 2], wanted: Vector<f64, 3>) -> f64 {
        let others = std::mem::replace(&mut self.of_others, f64::INFINITY);
        match (placed, carried) {
            (true, _) => 0.0,
            (false, true) => 1.0,
            (false, false) => shortening(wanted.norm(), others),
        }
    }

    /// The rendered part of the force, which rises from `start`.
    fn rise(&mut self, start: f64, contact: bool, step: f64) -> f64 {
        self.rise = match (start < 1.0, contact) {
            (true, _) => self.rise * start,
            (false, true) => (self.rise + step).min(1.0),
            (false, false) => 1.0,
        };
        self.rise
    }
}
