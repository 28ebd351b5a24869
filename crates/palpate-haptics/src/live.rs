// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What another thread can read of a running servo.

use crate::contact_point::Touch;
use crate::event::Reaction;
use crate::tool::HeldTool;
use palpate_device::{Buttons, GripperState};
use palpate_safety::StageTicks;

/// The progress of a running servo, as of a recent tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Ticks done.
    pub ticks: u64,
    /// The time of the servo [s].
    pub time: f64,
    /// The largest force on a contact point in the last tick [N].
    pub force: f64,
    /// The largest depth a contact point is pressed to [m].
    pub depth: f64,
    /// The number of contact points in contact.
    pub contacts: u64,
    /// Evaluations of the shape in the last tick.
    pub evaluations: u64,
    /// The duration of the last tick [ns].
    pub cost_ns: u64,
}

/// The state of a servo after one tick: all parts are of the same tick.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Snapshot {
    /// Counts and largest values.
    pub progress: Progress,
    /// Every contact point.
    pub touches: Vec<Touch>,
    /// The tool; `None` if the servo renders contact points.
    pub tool: Option<HeldTool>,
    /// `true` while all written forces are held at zero: by an emergency stop, or because the bodies
    /// that were sent last were accepted for another servo.
    pub is_stopped: bool,
    /// Whether the hand is [lifted](crate::Servo::lift) off the bodies.
    pub is_lifted: bool,
    /// In how many ticks each stage of the safety chains has acted since the start.
    pub safety: StageTicks,
    /// The buttons of the device that are held down.
    pub buttons: Buttons,
    /// The gripper of the device; `None` for a device without one.
    pub gripper: Option<GripperState>,
    /// The force on the fingers in the gripper [N].
    pub gripper_force: f64,
    /// Force and torque on each body.
    pub reactions: Vec<Reaction>,
    /// Events so far for which the queue had no room.
    pub events_lost: u64,
}
