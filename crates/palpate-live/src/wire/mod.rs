// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page and the server say to each other: `docs/live-protocol.md`.

mod ask;
mod binary;
mod told;

pub(crate) use ask::{Ask, Change, Envelope, Kind, Question, Unreadable, is_stop};
pub(crate) use binary::{Frame, FramePoint, Grid, GridPlace, picture};
pub(crate) use told::Told;

/// The version of the protocol.
pub const VERSION: u32 = 1;
