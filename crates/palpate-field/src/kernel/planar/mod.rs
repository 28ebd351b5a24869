// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels of the plane.

mod arc;
mod cool_s;
pub(super) mod line;
mod polygon;
mod regular;
mod ring;

pub use arc::Arc;
pub use cool_s::CoolS;
pub use polygon::Polygon;
pub use regular::{RegularPolygon, RegularStar};
pub use ring::Ring;
