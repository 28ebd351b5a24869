// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page and the server say to each other: `docs/live-protocol.md`.

mod ask;
mod binary;

pub(crate) use ask::{Ask, Change, Question};
pub(crate) use binary::{Frame, FramePoint, Grid, GridPlace, picture};

/// The version of the protocol.
pub const VERSION: u32 = 1;
