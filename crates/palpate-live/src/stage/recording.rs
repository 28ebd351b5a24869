// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is recorded of a servo, and replayed.

use std::sync::Arc;

use palpate::servo_loop::TraceRow;

use super::room::Room;
use super::trace::{self, Replay};
use crate::wire::Told;

/// The most rows that are recorded: 20 s of ten points at 1 kHz.
pub(super) const MOST_ROWS: usize = 200_000;

/// Frames from one message on the number of rows to the next: a quarter of a second.
const FRAMES: u32 = 15;

/// Rows as text, made where there is time for it.
pub(crate) type Trace = Box<dyn FnOnce() -> Vec<u8> + Send>;

/// What was recorded last, or taken from a file. It outlives the servo that it is of.
#[derive(Debug, Default)]
pub(super) struct Recording {
    rows: Vec<TraceRow>,
    /// The dimension of the scene in which the rows were recorded.
    dimension: usize,
    is_on: bool,
    /// What was read, to be replayed instead of the rows.
    read: Option<Arc<Replay>>,
    /// The rows as they are replayed, once they were.
    made: Option<Arc<Replay>>,
    /// What the pages were told last: whether it is on, the rows; and how many frames ago.
    told: (bool, usize, u32),
}

impl Recording {
    pub(super) fn is_on(&self) -> bool {
        self.is_on
    }

    /// Starts or ends the recording. Both discard what was read from a file before.
    pub(super) fn switch(&mut self, is_on: bool, room: &Room) {
        if is_on && !self.is_on {
            self.made = None;
            (self.rows, self.dimension) = (Vec::new(), room.dimension());
        }
        if is_on || self.is_on {
            self.read = None;
        }
        self.is_on = is_on;
    }

    /// Ends the recording; its number of rows if it was on.
    pub(super) fn end(&mut self) -> Option<usize> {
        std::mem::take(&mut self.is_on).then_some(self.rows.len())
    }

    /// Takes what is replayed instead of what was recorded.
    pub(super) fn take(&mut self, replay: Replay) {
        self.read = Some(Arc::new(replay));
    }

    /// Leads the hand of a room along what was taken or recorded last; a recording ends.
    pub(super) fn replay(&mut self, room: &mut Room) -> Result<(), String> {
        if self.read.is_none() && self.rows.is_empty() {
            return Err(trace::NOTHING.to_owned());
        }
        // Rows that are still recorded are made anew.
        if self.is_on || self.read.is_none() && self.made.is_none() {
            self.made = Some(Arc::new(trace::replay(&self.rows, self.dimension)?));
        }
        let replay = self.read.as_ref().or(self.made.as_ref());
        match replay.filter(|replay| replay.dimension == room.dimension()) {
            Some(replay) => room.replay(Some(Arc::clone(replay))),
            None => Err("the trace is of a scene of another dimension".to_owned()),
        }?;
        self.is_on = false;
        Ok(())
    }

    /// Takes the ticks since the last step; whether the recording became full by them.
    pub(super) fn go_on(&mut self, room: &mut Room) -> bool {
        let (is_on, rows) = (self.is_on, &mut self.rows);
        room.go_on(|row| {
            if is_on && rows.len() < MOST_ROWS {
                rows.push(*row);
            }
        });
        self.is_on &= rows.len() < MOST_ROWS;
        is_on && !self.is_on
    }

    /// The rows as a file, if there are any.
    pub(super) fn trace(&self) -> Option<Trace> {
        if self.rows.is_empty() {
            return None;
        }
        let (rows, dimension) = (self.rows.clone(), self.dimension);
        Some(Box::new(move || trace::written(&rows, dimension)))
    }

    /// What the pages are told: a few times a second while it is on, and when it ends.
    pub(super) fn message(&mut self, is_frame: bool) -> Option<Told<'static>> {
        let (was_on, rows, frames) = &mut self.told;
        *frames = frames.saturating_add(u32::from(is_frame));
        let now = self.rows.len();
        if (*was_on, *rows) == (self.is_on, now) || self.is_on && *was_on && *frames < FRAMES {
            return None;
        }
        self.told = (self.is_on, now, 0);
        Some(Told::Recording { is_on: self.is_on, rows: now, most: MOST_ROWS })
    }
}
