// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page and the server say to each other: `docs/live-protocol.md`.

mod answered;
mod ask;
mod binary;
mod told;

pub(crate) use answered::{
    Answered, Bounce, Enclosing, FallEnd, Fell, Local, Swept, Timed, ToQuestion,
};
pub(crate) use ask::{Ask, Change, Envelope, Kind, Question, Unreadable, is_stop};
pub(crate) use binary::{Frame, FramePoint, Grid, GridPlace, picture};
pub(crate) use told::{
    About, BodyTold, BuiltTold, By, DeviceTold, DocumentTold, First, OperatorTold, Part,
    Problem, SceneTold, StageTold, Told, Way, written,
};

/// The version of the protocol.
pub const VERSION: u32 = 2;
