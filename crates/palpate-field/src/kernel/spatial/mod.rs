// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels of space.

mod approximation;
mod ball_parts;
mod between;
mod cone;
mod cylinder;
mod frame;
mod lens;
mod octahedron;
mod power_torus;
mod prism;
mod pyramid;
mod rhombus;
mod round_cone;
mod screw_thread;
mod sheet;
mod torus;

pub use approximation::{
    ConeApproximation, CubeApproximation, CylinderApproximation, PyramidApproximation,
};
pub use ball_parts::{CutBall, CutHollowSphere, DeathStar, SolidAngle};
pub use between::{CappedConeBetween, CylinderBetween};
pub use cone::{CappedCone, Cone, InfiniteCone};
pub use cylinder::{Cylinder, InfiniteCylinder, RoundedCylinder};
pub use frame::CuboidFrame;
pub use lens::VesicaSegment;
pub use octahedron::Octahedron;
pub use power_torus::PowerTorus;
pub use prism::{HexagonalPrism, TriangularPrism};
pub use pyramid::Pyramid;
pub use rhombus::RhombusPrism;
pub use round_cone::{RoundCone, RoundConeBetween};
pub use screw_thread::ScrewThread;
pub use sheet::Sheet;
pub use torus::{CappedTorus, Link, Torus};

/// Calls the macro `$then` with the primitives of space, after what is given for it.
macro_rules! primitives {
    ($then:ident, $($before:tt)*) => {
        $then! {
            $($before)*
            Ball,
            Cuboid<3>,
            RoundedCuboid<3>,
            Capsule,
            Segment<3>,
            HalfSpace<3>,
            Simplex<3>,
            Ellipsoid<3>,
            Cylinder,
            RoundedCylinder,
            InfiniteCylinder,
            CappedCone,
            Cone,
            Pyramid,
            Torus,
            HexagonalPrism,
            TriangularPrism,
            Octahedron,
            CuboidFrame,
            CappedTorus,
            Link,
            InfiniteCone,
            CylinderBetween,
            CappedConeBetween,
            SolidAngle,
            CutBall,
            CutHollowSphere,
            DeathStar,
            RoundCone,
            RoundConeBetween,
            VesicaSegment,
            RhombusPrism,
            Sheet<3>,
            Sheet<4>,
            CubeApproximation,
            CylinderApproximation,
            ConeApproximation,
            PyramidApproximation,
            PowerBall,
            PowerCuboid<3>,
            PowerTorus,
            ScrewThread,
        }
    };
}
pub(crate) use primitives;
