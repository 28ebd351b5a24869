// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When moving bodies touch first.

mod advancement;
mod ball;
mod boxes;
mod element;
mod elements;
mod first_touch;
mod mesh;
mod motion;
mod moving;
mod pair;
mod part;
mod path;
mod proof;
mod settings;
mod stay;

pub use ball::cast_ball;
pub use element::sweep_element;
pub use elements::ElementSweep;
pub use first_touch::{FirstTouch, Start};
pub use mesh::sweep_mesh;
pub use motion::Motion;
pub use moving::Moving;
#[cfg(feature = "world")]
pub(crate) use moving::corners;
pub(crate) use pair::swept;
pub use pair::{SweepWorkspace, sweep};
pub use proof::{FreeBox, SweepProof, sweep_proof};
pub use settings::SweepSettings;
