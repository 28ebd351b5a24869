// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When moving bodies touch first.

mod axes;
mod boxes;
mod elements;
mod first_touch;
mod motion;
mod pair;

pub use elements::{ElementSweep, cast_ball, sweep_element, sweep_mesh};
pub use first_touch::{FirstTouch, Start};
pub use first_touch::{FreeBox, SweepProof, SweepSettings, sweep_proof};
#[cfg(feature = "world")]
pub(crate) use motion::corners;
pub use motion::{Motion, Moving};
pub(crate) use pair::swept;
pub use pair::{SweepWorkspace, sweep};
