// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When moving bodies touch first.

mod ball;
mod moving;
mod pair;

pub use ball::cast_ball;
pub use moving::Moving;
pub use pair::{FirstTouch, Start, SweepSettings, sweep};
