// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels of the plane.

mod arc;
mod cool_s;
mod cross;
mod cut_disk;
mod horseshoe;
pub(super) mod line;
mod outline;
mod polygon;
mod quadrilateral;
mod rectangle;
mod regular;
mod ring;
mod sector;
mod stairs;
mod tunnel;
mod vesica;

pub use arc::Arc;
pub use cool_s::CoolS;
pub use cross::{Cross, RoundedX};
pub use cut_disk::{CutDisk, Moon};
pub use horseshoe::Horseshoe;
pub use polygon::Polygon;
pub use quadrilateral::{IsoscelesTrapezoid, IsoscelesTriangle, Parallelogram, Rhombus};
pub use rectangle::{ChamferedRectangle, OrientedRectangle, RoundedRectangle};
pub use regular::{RegularPolygon, RegularStar};
pub use ring::Ring;
pub use sector::{Pie, RingSector};
pub use stairs::Stairs;
pub use tunnel::{Tunnel, UnevenCapsule};
pub use vesica::{OrientedVesica, Vesica};
