// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels of space.

mod approximation;
mod cone;
mod cylinder;
mod octahedron;
mod prism;
mod pyramid;
mod torus;

pub use approximation::{
    ConeApproximation, CubeApproximation, CylinderApproximation, PyramidApproximation,
};
pub use cone::{CappedCone, Cone};
pub use cylinder::{Cylinder, InfiniteCylinder, RoundedCylinder};
pub use octahedron::Octahedron;
pub use prism::{HexagonalPrism, TriangularPrism};
pub use pyramid::Pyramid;
pub use torus::Torus;
