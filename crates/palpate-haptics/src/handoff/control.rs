// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The end of a hand-off for an ordinary thread.

use std::fmt;
use std::sync::Arc;

use palpate_field::Pose;

use super::exchange::{Flag, Reader, Sender};
use super::{Edits, Flags};
use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::{Bodies, is_usable};
use crate::error::HapticsError;
use crate::event::Event;
use crate::live::Snapshot;
use crate::protection::Protection;
use crate::tool::Coupling;
use palpate_safety::Accepted;
use palpate_safety::not_negative;

/// Changes what a running servo renders, and sees what it does. From [`handoff`](crate::handoff)
/// or a [`ServoThread`](crate::ServoThread).
///
/// Edits that the servo has not seen yet are joined: it finds all of them before its next tick,
/// or none. What it no longer renders is dropped here, by the next call.
pub struct Control<const D: usize> {
    pub(super) sender: Sender<Edits<D>>,
    pub(super) reader: Reader<Snapshot<D>>,
    pub(super) events: rtrb::Consumer<Event>,
    pub(super) flags: Arc<Flags>,
    /// Bodies of the newest scene.
    pub(super) bodies: usize,
    pub(super) most_bodies: usize,
    /// The protection of a [`Servo`](crate::Servo) and its rate [Hz]; `None` of an unprotected
    /// one.
    pub(super) protection: Option<(Protection<D>, f64)>,
    /// The coupling that was requested of its tool; `None` for contact points.
    pub(super) requested_coupling: Option<Coupling>,
}

impl<const D: usize> Control<D> {
    /// Renders `bodies` from the next tick on, instead of all before. Poses set before were
    /// those of the old ones.
    ///
    /// A [`Servo`](crate::Servo) gets them as its device can render them, and a tool's coupling
    /// with them; what became of them is returned, as by
    /// [`Servo::accepted`](crate::Servo::accepted). An
    /// [`UnprotectedServo`](crate::UnprotectedServo) gets them as they are, and the list is
    /// empty.
    ///
    /// # Errors
    ///
    /// [`HapticsError::TooManyBodies`] if there are more than the hand-off has room for; as
    /// [`Servo::accept`](crate::Servo::accept).
    pub fn replace_bodies(
        &mut self,
        bodies: impl TryInto<Bodies<D>, Error: Into<HapticsError>>,
    ) -> Result<Vec<Accepted>, HapticsError> {
        let bodies = bodies.try_into().map_err(Into::into)?;
        let count = bodies.bodies().len();
        if count > self.most_bodies {
            return Err(HapticsError::TooManyBodies { bodies: count, most: self.most_bodies });
        }
        let bodies = match &self.protection {
            Some((protection, rate)) => {
                protection.accepted_bodies(bodies, self.requested_coupling, *rate)?
            }
            None => AcceptedBodies::unchanged(bodies),
        };
        let accepted = bodies.accepted.clone();
        self.bodies = count;
        self.edit(|edits| {
            edits.poses.clear();
            edits.bodies = Some(bodies);
        });
        Ok(accepted)
    }

    /// Moves bodies, all of them before the same tick. Of several poses for a body before a
    /// tick, the last counts.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoSuchBody`] or [`HapticsError::Pose`]; nothing moves then.
    pub fn set_poses(&mut self, poses: &[(usize, Pose<D>)]) -> Result<(), HapticsError> {
        for (body, pose) in poses {
            if *body >= self.bodies {
                return Err(HapticsError::NoSuchBody { body: *body, bodies: self.bodies });
            }
            if !is_usable(pose) {
                return Err(HapticsError::Pose);
            }
        }
        let bodies = self.bodies;
        self.edit(|edits| {
            edits.poses.resize(bodies, None);
            for (body, pose) in poses {
                edits.poses[*body] = Some(*pose);
            }
        });
        Ok(())
    }

    /// Lowers the largest force on a contact point to `max_force` [N]; never raises it.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is negative or not finite.
    pub fn limit_force(&mut self, max_force: f64) -> Result<(), HapticsError> {
        let max_force = not_negative("max_force", max_force, "N")?;
        self.edit(|edits| edits.max_force = edits.max_force.min(max_force));
        Ok(())
    }

    /// Lowers the largest torque on a tool's device to `max_torque` [N·m]; never raises it.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is negative or not finite.
    pub fn limit_torque(&mut self, max_torque: f64) -> Result<(), HapticsError> {
        let max_torque = not_negative("max_torque", max_torque, "N·m")?;
        self.edit(|edits| edits.max_torque = edits.max_torque.min(max_torque));
        Ok(())
    }

    /// Drops what the servo no longer renders; every edit does so too.
    pub fn collect(&mut self) {
        self.sender.collect(|edits| {
            edits.bodies = None;
            edits.poses.clear();
            edits.max_force = f64::INFINITY;
            edits.max_torque = f64::INFINITY;
        });
    }

    /// The emergency stop, for any thread.
    #[must_use]
    pub fn stop_switch(&self) -> StopSwitch {
        StopSwitch { flags: self.flags.clone() }
    }

    /// The servo after its last tick; `None` if there was none.
    #[must_use]
    pub fn latest(&mut self) -> Option<&Snapshot<D>> {
        self.reader.latest()
    }

    /// The next event, in their order; `None` if there is none yet. Events that found no room
    /// are [counted](Snapshot::events_lost).
    #[must_use]
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop().ok()
    }

    /// Asks the loop to end before its next tick, with zero force.
    pub fn end(&self) {
        self.flags.end.set(true);
    }

    /// Whether the loop has ended.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.flags.ended.is_set()
    }

    fn edit(&mut self, edit: impl FnOnce(&mut Edits<D>)) {
        self.collect();
        self.sender.edit(edit);
    }
}

impl<const D: usize> fmt::Debug for Control<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("bodies", &self.bodies)
            .field("most_bodies", &self.most_bodies)
            .finish_non_exhaustive()
    }
}

/// Stops all forces of a running servo, and lets them rise again; for any thread.
#[derive(Clone, Debug)]
pub struct StopSwitch {
    flags: Arc<Flags>,
}

impl StopSwitch {
    /// From the next tick on the forces written are zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&self) {
        self.flags.stop.set(true);
    }

    /// Forces are written again; they rise from nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release(&self) {
        self.flags.stop.set(false);
    }
}
