// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The end of a hand-off for an ordinary thread.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use palpate_field::Pose;

use super::stop_switch::StopSwitch;
use super::{Edits, Flags};
use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::{Bodies, is_usable};
use crate::error::HapticsError;
use crate::event::Event;
use crate::guide::Guide;
use crate::live::Snapshot;
use crate::protection::Protection;
use crate::tool::Coupling;
use palpate_device::{EditSender, LatestReader, NumberError};
use palpate_safety::Accepted;

/// The end of a hand-off for an ordinary thread: edits what a running servo renders, and reads
/// its state. Made by [`handoff`](crate::handoff) or a [`ServoThread`](crate::servo_loop::ServoThread).
///
/// Edits that the servo has not received yet are merged: before its next tick the servo
/// receives all of them or none. Replaced bodies are dropped on this thread, by the next call.
pub struct Control {
    pub(super) sender: EditSender<Edits>,
    pub(super) reader: LatestReader<Snapshot>,
    pub(super) events: rtrb::Consumer<Event>,
    pub(super) flags: Arc<Flags>,
    pub(super) stop: StopSwitch,
    /// The number of bodies in the newest scene.
    pub(super) bodies: usize,
    pub(super) most_bodies: usize,
    /// The number of contact points.
    pub(super) points: usize,
    /// The protection of a [`Servo`](crate::Servo) and its rate [Hz]; `None` for an
    /// [unprotected](crate::Unprotected) servo.
    pub(super) protection: Option<(Arc<Protection>, f64)>,
    /// The requested virtual coupling of the tool; `None` for contact points.
    pub(super) requested_coupling: Option<Coupling>,
}

impl Control {
    /// Replaces all bodies from the next tick on. Poses that were set before belong to the old
    /// bodies and are dropped. For what a hand feels that touches them see
    /// [`Servo::replace_bodies`](crate::Servo::replace_bodies).
    ///
    /// For a [`Servo`](crate::Servo), the bodies and the tool's coupling are scaled to what its
    /// device can render; the result is returned as in
    /// [`Servo::accepted`](crate::Servo::accepted). For an
    /// [unprotected](crate::Unprotected) servo the bodies stay unchanged and the list is
    /// empty.
    ///
    /// # Errors
    ///
    /// [`HapticsError::TooManyBodies`] if there are more than the hand-off has room for; as
    /// [`Servo::accept`](crate::Servo::accept).
    pub fn replace_bodies(
        &mut self,
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
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

    /// Moves bodies, all of them before the same tick. If a body gets several poses before a
    /// tick, the last one holds.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoSuchBody`] or [`HapticsError::Pose`]; then no body moves.
    #[inline(never)]
    pub fn set_poses(&mut self, poses: &[(usize, Pose<3>)]) -> Result<(), HapticsError> {
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
    /// [`HapticsError::Number`] if the limit is negative or not finite.
    pub fn limit_force(&mut self, max_force: f64) -> Result<(), HapticsError> {
        let max_force = NumberError::check_not_negative("max_force", max_force, "N")?;
        self.edit(|edits| edits.max_force = edits.max_force.min(max_force));
        Ok(())
    }

    /// Lowers the largest torque on a tool's device to `max_torque` [N·m]; never raises it.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the limit is negative or not finite.
    pub fn limit_torque(&mut self, max_torque: f64) -> Result<(), HapticsError> {
        let max_torque = NumberError::check_not_negative("max_torque", max_torque, "N·m")?;
        self.edit(|edits| edits.max_torque = edits.max_torque.min(max_torque));
        Ok(())
    }

    /// Sets the force wanted on the fingers in the gripper [N], which holds until the next one;
    /// positive opens the jaws. The device's gripper limits it, and without one nothing is written.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the force is not finite.
    pub fn set_gripper_force(&mut self, force: f64) -> Result<(), HapticsError> {
        if !force.is_finite() {
            return Err(NumberError::new("gripper_force", "finite", force, "N").into());
        }
        self.edit(|edits| edits.gripper_force = Some(force));
        Ok(())
    }

    /// Lifts the hand off the bodies, or sets it down; see [`Servo::lift`](crate::Servo::lift).
    pub fn lift(&mut self, is_lifted: bool) {
        self.edit(|edits| edits.is_lifted = Some(is_lifted));
    }

    /// Replaces the guides of every contact point from the next tick on. For a
    /// [`Servo`](crate::Servo), they are as soft as its device requires; the result is returned as in
    /// [`Servo::accepted_guides`](crate::Servo::accepted_guides). For an
    /// [unprotected](crate::Unprotected) servo they stay unchanged and the list is empty.
    ///
    /// # Errors
    ///
    /// As [`Protection::accept_guides`].
    #[inline(never)]
    pub fn replace_guides(&mut self, guides: &[Guide]) -> Result<Vec<Accepted>, HapticsError> {
        let (guides, accepted) = match &self.protection {
            Some((protection, rate)) => protection.accept_guides(guides, *rate)?,
            None => (guides.to_vec(), Vec::new()),
        };
        let points = self.points;
        self.edit(|edits| edits.guides = Some(vec![guides; points]));
        Ok(accepted)
    }

    /// Drops replaced bodies that the servo has returned; every edit does so too.
    pub fn collect(&mut self) {
        self.sender.collect(|edits| {
            edits.bodies = None;
            edits.poses.clear();
            edits.max_force = f64::INFINITY;
            edits.max_torque = f64::INFINITY;
            edits.gripper_force = None;
            edits.is_lifted = None;
            edits.guides = None;
        });
    }

    /// The emergency stop, for any thread.
    #[must_use]
    pub fn stop_switch(&self) -> StopSwitch {
        self.stop.clone()
    }

    /// The state of the servo after its last tick; `None` before the first tick.
    #[must_use]
    #[inline(never)]
    pub fn latest(&mut self) -> Option<&Snapshot> {
        self.reader.latest()
    }

    /// The next event, in order; `None` if the queue is empty. Events that found the queue full
    /// are [counted](Snapshot::events_lost).
    #[must_use]
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop().ok()
    }

    /// Asks the loop to end before its next tick, with zero force.
    pub fn end(&self) {
        self.flags.end.store(true, Ordering::Release);
    }

    /// Whether the loop has ended.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.flags.ended.load(Ordering::Acquire)
    }

    fn edit(&mut self, edit: impl FnOnce(&mut Edits)) {
        self.collect();
        self.sender.edit(edit);
    }
}

impl fmt::Debug for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("bodies", &self.bodies)
            .field("most_bodies", &self.most_bodies)
            .finish_non_exhaustive()
    }
}
