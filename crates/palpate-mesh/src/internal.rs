// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What other crates of palpate use. It is no part of the interface and may change at any time.

pub use crate::ball::{centre_weights, circumscribed_ball, smallest_ball};
pub use crate::tree::{BallTree, FAN, Level};
