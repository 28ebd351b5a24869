// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When moving bodies touch first.

mod ball;
mod element;
mod first_touch;
mod motion;
mod moving;
mod pair;
mod path;
mod settings;

pub use ball::cast_ball;
pub use element::{ElementSweep, sweep_element};
pub use first_touch::{FirstTouch, Start};
pub use motion::Motion;
pub use moving::Moving;
pub use pair::sweep;
pub use settings::SweepSettings;
