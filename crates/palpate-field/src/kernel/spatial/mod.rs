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
