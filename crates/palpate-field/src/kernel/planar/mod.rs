// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels of the plane.

mod arc;
mod bent;
mod circle_wave;
mod cool_s;
mod cross;
mod cut_disk;
mod egg;
mod heart;
mod horseshoe;
mod hyperbola;
pub(super) mod line;
mod outline;
mod parabola;
mod parabola_circle;
pub(crate) mod parabola_foot;
mod polygon;
mod quadratic_bezier;
mod quadrilateral;
mod rectangle;
mod regular;
mod ring;
mod rounded_cross;
mod sector;
mod sides;
mod stairs;
mod tunnel;
mod vesica;

pub use arc::Arc;
pub use circle_wave::CircleWave;
pub use cool_s::CoolS;
pub use cross::{Cross, RoundedX};
pub use cut_disk::{CutDisk, Moon};
pub use egg::Egg;
pub use heart::Heart;
pub use horseshoe::Horseshoe;
pub use hyperbola::Hyperbola;
pub use parabola::{Parabola, ParabolaSegment};
pub use parabola_circle::{BobblyCross, QuadraticCircle};
pub use polygon::Polygon;
pub use quadratic_bezier::QuadraticBezier;
pub use quadrilateral::{IsoscelesTrapezoid, IsoscelesTriangle, Parallelogram, Rhombus};
pub use rectangle::{ChamferedRectangle, OrientedRectangle, RoundedRectangle};
pub use regular::{RegularPolygon, RegularStar};
pub use ring::Ring;
pub use rounded_cross::RoundedCross;
pub use sector::{Pie, RingSector};
pub use stairs::Stairs;
pub use tunnel::{Tunnel, UnevenCapsule};
pub use vesica::{OrientedVesica, Vesica};

/// Calls the macro `$then` with the primitives of the plane, after what is given for it.
macro_rules! primitives {
    ($then:ident, $($before:tt)*) => {
        $then! {
            $($before)*
            Ball,
            Cuboid<2>,
            RoundedCuboid<2>,
            Capsule,
            Segment<2>,
            HalfSpace<2>,
            Simplex<2>,
            Ellipsoid<2>,
            Ring,
            Arc,
            RegularPolygon,
            RegularStar,
            Polygon,
            CoolS,
            RoundedRectangle,
            ChamferedRectangle,
            OrientedRectangle,
            Rhombus,
            IsoscelesTrapezoid,
            Parallelogram,
            IsoscelesTriangle,
            Stairs,
            Cross,
            RoundedX,
            Tunnel,
            UnevenCapsule,
            Pie,
            CutDisk,
            RingSector,
            Horseshoe,
            Vesica,
            OrientedVesica,
            Moon,
            Egg,
            Heart,
            RoundedCross,
            BobblyCross,
            Parabola,
            ParabolaSegment,
            QuadraticBezier,
            QuadraticCircle,
            Hyperbola,
            CircleWave,
            PowerBall,
            PowerCuboid<2>,
        }
    };
}
pub(crate) use primitives;
