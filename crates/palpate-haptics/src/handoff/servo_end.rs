// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The end of a hand-off for the servo's thread.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use palpate_device::{EditReceiver, LatestWriter};

use super::stop_switch::StopSwitch;
use super::{Edits, Flags};
use crate::event::Event;
use crate::live::{Progress, Snapshot};
use crate::servo::{Kind, Servo};

/// The servo's end of a hand-off: receives edits and publishes the state of the servo. Made by
/// [`handoff`](crate::handoff).
pub struct ServoEnd {
    pub(super) receiver: EditReceiver<Edits>,
    pub(super) writer: LatestWriter<Snapshot>,
    pub(super) events: rtrb::Producer<Event>,
    pub(super) flags: Arc<Flags>,
    pub(super) stop: StopSwitch,
    pub(super) events_lost: u64,
    pub(super) is_stopped: bool,
    /// The bodies sent last were accepted for another servo.
    pub(super) is_foreign: bool,
}

impl ServoEnd {
    /// Applies the edits of the other end to `servo`; call it before each tick.
    ///
    /// Bodies that were accepted for another servo are not taken, nor their poses. The servo stops as
    /// by [`stop`](crate::StopSwitch::stop), until [`release`](crate::StopSwitch::release). An
    /// unprotected servo takes the bodies of any.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn receive(&mut self, servo: &mut Servo<impl Kind>) {
        let servo = servo.renderer_mut();
        let is_stopped = self.stop.is_stopped();
        if is_stopped != self.is_stopped {
            self.is_stopped = is_stopped;
            servo.stop(is_stopped);
        }
        let Some(mut parcel) = self.receiver.take() else { return };
        let edits = &mut parcel.content;
        if let Some(bodies) = &mut edits.bodies {
            self.is_foreign = !servo.adopt(bodies);
            if self.is_foreign {
                self.stop.stop();
                self.is_stopped = true;
                servo.stop(true);
            }
        }
        // Poses are those of the bodies that were sent last.
        let poses = edits.poses.iter().enumerate().filter(|_| !self.is_foreign);
        for (body, pose) in poses {
            if let Some(pose) = pose {
                servo.set_pose(body, *pose);
            }
        }
        servo.limit_force(edits.max_force);
        servo.limit_torque(edits.max_torque);
        if let Some(force) = edits.gripper_force {
            servo.set_gripper_force(force);
        }
        if let Some(is_lifted) = edits.is_lifted {
            servo.lift(is_lifted);
        }
        if let Some(guides) = &mut edits.guides {
            servo.exchange_guides(guides);
        }
        self.receiver.give_back(parcel);
    }

    /// Whether the loop must end: the other end asked for it, or was dropped.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_to_end(&self) -> bool {
        self.flags.end.load(Ordering::Acquire) || self.events.is_abandoned()
    }

    /// Publishes the state of `servo` to the other end; call it after each tick.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn publish(&mut self, servo: &Servo<impl Kind>, progress: &Progress) {
        let servo = servo.renderer();
        for event in servo.events() {
            self.events_lost += u64::from(self.events.push(*event).is_err());
        }
        let events_lost = self.events_lost;
        self.writer.set(|snapshot| {
            snapshot.progress = *progress;
            snapshot.events_lost = events_lost;
            snapshot.tool = servo.held_tool();
            snapshot.is_stopped = servo.is_stopped();
            snapshot.is_lifted = servo.is_lifted();
            snapshot.safety = servo.stage_ticks();
            snapshot.buttons = servo.buttons();
            snapshot.gripper = servo.gripper();
            snapshot.gripper_force = servo.gripper_force();
            refill(&mut snapshot.touches, servo.touches());
            refill(&mut snapshot.reactions, servo.reactions());
        });
    }

    /// Tells the other end that the loop has ended.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn finish(&self) {
        self.flags.ended.store(true, Ordering::Release);
    }
}

impl fmt::Debug for ServoEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ServoEnd")
            .field("events_lost", &self.events_lost)
            .field("is_stopped", &self.is_stopped)
            .finish_non_exhaustive()
    }
}

/// Copies `content` into `list`, up to the capacity of `list`.
fn refill<T: Copy>(list: &mut Vec<T>, content: &[T]) {
    list.clear();
    let room = list.capacity();
    list.extend(content.iter().take(room).copied());
}
