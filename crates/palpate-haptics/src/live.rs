// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What another thread may see of a running servo.

use crate::contact_point::Touch;
use crate::event::Reaction;
use crate::tool::HeldTool;

/// A running servo, some ticks ago.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Ticks done.
    pub ticks: u64,
    /// The time of the servo [s].
    pub time: f64,
    /// The largest force on a contact point in the last tick [N].
    pub force: f64,
    /// The largest depth a contact point is pressed to [m].
    pub depth: f64,
    /// How many points are in contact.
    pub contacts: u64,
    /// Evaluations of the shape in the last tick.
    pub evaluations: u64,
    /// What the last tick cost [ns].
    pub cost_ns: u64,
}

/// A servo after a tick, all of it after the same one.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<const D: usize> {
    /// How far it is.
    pub progress: Progress,
    /// Every contact point.
    pub touches: Vec<Touch<D>>,
    /// The tool with a shape; none of contact points.
    pub tool: Option<HeldTool<D>>,
    /// What was done to each body.
    pub reactions: Vec<Reaction<D>>,
    /// Events so far for which the queue had no room.
    pub events_lost: u64,
}
