// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is recorded of a servo, and replayed.

use std::sync::Arc;

use palpate::servo_loop::TraceRow;

use super::room::{AnyRoom, of_either};
use super::trace::{self, Replay};
use crate::wire::Told;

/// The most rows that are recorded: 20 s of ten points at 1 kHz.
pub(super) const MOST_ROWS: usize = 200_000;

/// Frames from one message on the number of rows to the next: a quarter of a second.
const FRAMES: u32 = 15;

/// What is replayed, of either dimension.
#[derive(Debug)]
pub(crate) enum AnyReplay {
    Planar(Arc<Replay<2>>),
    Spatial(Arc<Replay<3>>),
}

/// Rows as text, made where there is time for it.
pub(crate) type Trace = Box<dyn FnOnce() -> Vec<u8> + Send>;

/// What is recorded, in either dimension.
#[derive(Debug)]
enum AnyRows {
    Planar(Vec<TraceRow<2>>),
    Spatial(Vec<TraceRow<3>>),
}

/// What was recorded last, or taken from a file. It outlives the servo that it is of.
#[derive(Debug)]
pub(super) struct Recording {
    rows: AnyRows,
    is_on: bool,
    /// What was read, to be replayed instead of the rows.
    read: Option<AnyReplay>,
    /// The rows as they are replayed, once they were.
    made: Option<AnyReplay>,
    /// What the pages were told last: whether it is on, the rows; and how many frames ago.
    told: (bool, usize, u32),
}

impl Default for Recording {
    fn default() -> Self {
        Self {
            rows: AnyRows::Planar(Vec::new()),
            is_on: false,
            read: None,
            made: None,
            told: (false, 0, 0),
        }
    }
}

impl Recording {
    pub(super) fn is_on(&self) -> bool {
        self.is_on
    }

    /// Starts or ends the recording. Both discard what was read from a file before.
    pub(super) fn switch(&mut self, is_on: bool, room: &AnyRoom) {
        if is_on && !self.is_on {
            self.made = None;
            self.rows = match room {
                AnyRoom::Planar(_) => AnyRows::Planar(Vec::new()),
                AnyRoom::Spatial(_) => AnyRows::Spatial(Vec::new()),
            };
        }
        if is_on || self.is_on {
            self.read = None;
        }
        self.is_on = is_on;
    }

    /// Ends the recording; its number of rows if it was on.
    pub(super) fn end(&mut self) -> Option<usize> {
        std::mem::take(&mut self.is_on).then_some(self.len())
    }

    /// Takes what is replayed instead of what was recorded.
    pub(super) fn take(&mut self, replay: AnyReplay) {
        self.read = Some(replay);
    }

    /// Leads the hand of a room along what was taken or recorded last; a recording ends.
    pub(super) fn replay(&mut self, room: &mut AnyRoom) -> Result<(), String> {
        if self.read.is_none() && self.len() == 0 {
            return Err(trace::NOTHING.to_owned());
        }
        // Rows that are still recorded are made anew.
        if self.is_on || self.read.is_none() && self.made.is_none() {
            self.made = Some(match &self.rows {
                AnyRows::Planar(rows) => AnyReplay::Planar(Arc::new(trace::replay(rows)?)),
                AnyRows::Spatial(rows) => AnyReplay::Spatial(Arc::new(trace::replay(rows)?)),
            });
        }
        match (room, self.read.as_ref().or(self.made.as_ref())) {
            (AnyRoom::Planar(room), Some(AnyReplay::Planar(replay))) => {
                room.replay(Some(Arc::clone(replay)))
            }
            (AnyRoom::Spatial(room), Some(AnyReplay::Spatial(replay))) => {
                room.replay(Some(Arc::clone(replay)))
            }
            _ => Err("the trace is of a scene of another dimension".to_owned()),
        }?;
        self.is_on = false;
        Ok(())
    }

    /// Takes the ticks since the last step; whether the recording became full by them.
    pub(super) fn go_on(&mut self, room: &mut AnyRoom) -> bool {
        let is_on = self.is_on;
        match (room, &mut self.rows) {
            (AnyRoom::Planar(room), AnyRows::Planar(rows)) if is_on => room.go_on(keep(rows)),
            (AnyRoom::Spatial(room), AnyRows::Spatial(rows)) if is_on => room.go_on(keep(rows)),
            (room, _) => of_either!(AnyRoom, room, room => room.go_on(|_| {})),
        }
        self.is_on &= self.len() < MOST_ROWS;
        is_on && !self.is_on
    }

    fn len(&self) -> usize {
        of_either!(AnyRows, &self.rows, rows => rows.len())
    }

    /// The rows as a file, if there are any.
    pub(super) fn trace(&self) -> Option<Trace> {
        if self.len() == 0 {
            return None;
        }
        Some(of_either!(AnyRows, &self.rows, rows => {
            let rows = rows.clone();
            Box::new(move || trace::written(&rows))
        }))
    }

    /// What the pages are told: a few times a second while it is on, and when it ends.
    pub(super) fn message(&mut self, is_frame: bool) -> Option<Told<'static>> {
        let (was_on, rows, frames) = &mut self.told;
        *frames = frames.saturating_add(u32::from(is_frame));
        let now = of_either!(AnyRows, &self.rows, rows => rows.len());
        if (*was_on, *rows) == (self.is_on, now) || self.is_on && *was_on && *frames < FRAMES {
            return None;
        }
        self.told = (self.is_on, now, 0);
        Some(Told::Recording { is_on: self.is_on, rows: now, most: MOST_ROWS })
    }
}

/// Keeps a row, if there is room for it.
fn keep<const D: usize>(rows: &mut Vec<TraceRow<D>>) -> impl FnMut(&TraceRow<D>) {
    |row| {
        if rows.len() < MOST_ROWS {
            rows.push(*row);
        }
    }
}
