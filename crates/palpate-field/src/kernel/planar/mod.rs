// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels of the plane.

mod arc;
mod circle_wave;
mod cool_s;
mod egg;
mod heart;
mod hyperbola;
mod line;
mod parabola;
mod parabola_circle;
mod parabola_foot;
mod polygon;
mod quadratic_bezier;
mod regular;
mod ring;
mod rounded_cross;

pub use arc::Arc;
pub use circle_wave::CircleWave;
pub use cool_s::CoolS;
pub use egg::Egg;
pub use heart::Heart;
pub use hyperbola::Hyperbola;
pub use parabola::{Parabola, ParabolaSegment};
pub use parabola_circle::{BobblyCross, QuadraticCircle};
pub use polygon::Polygon;
pub use quadratic_bezier::QuadraticBezier;
pub use regular::{RegularPolygon, RegularStar};
pub use ring::Ring;
pub use rounded_cross::RoundedCross;
