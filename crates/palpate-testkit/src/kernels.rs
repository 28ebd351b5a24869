// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Finds the type of a kernel by its name in the catalogue.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::{self, Argument, NamedKernel};
use palpate_field::{Shape, ShapeError};

/// A function of a kernel whose type is only known by name.
pub trait Visit<const D: usize> {
    /// The result.
    type Output;

    /// Called with the kernel.
    fn visit<K: NamedKernel<D>>(self, kernel: K) -> Self::Output;
}

/// The catalogue of the plane or of space.
pub trait Dimension<const D: usize> {
    /// The catalogue.
    const CATALOGUE: &'static [Entry<D>];

    /// Calls `visit` with the kernel `name` of `arguments`.
    ///
    /// # Errors
    ///
    /// If the arguments break a rule.
    ///
    /// # Panics
    ///
    /// If there is no such kernel here: add it to the list in this module.
    fn with_kernel<V: Visit<D>>(
        name: &str,
        arguments: &[Argument],
        visit: V,
    ) -> Result<V::Output, ShapeError>;
}

/// The one implementor of [`Dimension`], for 2 and 3.
#[derive(Clone, Copy, Debug)]
pub struct Space;

macro_rules! dimension {
    ($dimension:literal: $($kernel:ty),* $(,)?) => {
        impl Dimension<$dimension> for Space {
            const CATALOGUE: &'static [Entry<$dimension>] = Entry::<$dimension>::ALL;

            fn with_kernel<V: Visit<$dimension>>(
                name: &str,
                arguments: &[Argument],
                visit: V,
            ) -> Result<V::Output, ShapeError> {
                $(
                    if name == <$kernel as NamedKernel<$dimension>>::NAME {
                        let kernel =
                            <$kernel as NamedKernel<$dimension>>::from_arguments(arguments)?;
                        return Ok(visit.visit(kernel));
                    }
                )*
                panic!("the testkit does not know the kernel {name}");
            }
        }
    };
}

dimension! { 2:
    kernel::Ball, kernel::Cuboid<2>, kernel::RoundedCuboid<2>, kernel::Capsule,
    kernel::Segment<2>, kernel::HalfSpace<2>, kernel::Simplex<2>, kernel::Ellipsoid<2>,
    kernel::Ring, kernel::Arc, kernel::RegularPolygon, kernel::RegularStar,
    kernel::Polygon, kernel::CoolS,
    kernel::RoundedRectangle, kernel::ChamferedRectangle, kernel::OrientedRectangle, kernel::Rhombus, kernel::IsoscelesTrapezoid, kernel::Parallelogram, kernel::IsoscelesTriangle, kernel::Stairs, kernel::Cross, kernel::RoundedX, kernel::Tunnel, kernel::UnevenCapsule, kernel::Pie, kernel::CutDisk, kernel::RingSector, kernel::Horseshoe, kernel::Vesica, kernel::OrientedVesica, kernel::Moon,
    kernel::Egg, kernel::Heart, kernel::RoundedCross, kernel::BobblyCross,
    kernel::Parabola, kernel::ParabolaSegment, kernel::QuadraticBezier,
    kernel::QuadraticCircle, kernel::Hyperbola, kernel::CircleWave,
    kernel::PowerBall, kernel::PowerCuboid<2>,
}

dimension! { 3:
    kernel::Ball, kernel::Cuboid<3>, kernel::RoundedCuboid<3>, kernel::Capsule,
    kernel::Segment<3>, kernel::HalfSpace<3>, kernel::Simplex<3>, kernel::Ellipsoid<3>,
    kernel::Cylinder, kernel::RoundedCylinder, kernel::InfiniteCylinder,
    kernel::CappedCone, kernel::Cone, kernel::Pyramid, kernel::Torus,
    kernel::HexagonalPrism, kernel::TriangularPrism, kernel::Octahedron,
    kernel::CuboidFrame, kernel::CappedTorus, kernel::Link, kernel::InfiniteCone, kernel::CylinderBetween, kernel::CappedConeBetween, kernel::SolidAngle, kernel::CutBall, kernel::CutHollowSphere, kernel::DeathStar, kernel::RoundCone, kernel::RoundConeBetween, kernel::VesicaSegment, kernel::RhombusPrism, kernel::Sheet<3>, kernel::Sheet<4>,
    kernel::CubeApproximation, kernel::CylinderApproximation,
    kernel::ConeApproximation, kernel::PyramidApproximation,
    kernel::PowerBall, kernel::PowerCuboid<3>, kernel::PowerTorus, kernel::ScrewThread,
}

/// A [`Visit`] that makes a shape of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct IntoShape;

impl<const D: usize> Visit<D> for IntoShape {
    type Output = Shape<D>;

    fn visit<K: NamedKernel<D>>(self, kernel: K) -> Shape<D> {
        Shape::from_kernel(kernel)
    }
}
