// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Prisms along the y axis on regular polygons.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::Mark;
use crate::kernel::planar::RegularPolygon;
use crate::kernel::{Kernel, answered_by_inner, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 18.0;

/// A regular polygon in x and z, extruded along y: the orthant of the polygon's
/// distance and `|y| − h/2`.
#[derive(Clone, Debug)]
struct Prism {
    polygon: RegularPolygon,
    half_height: f64,
}

impl Prism {
    fn new(sides: u32, radius: f64, height: f64) -> Result<Self, ShapeError> {
        let half_height = 0.5 * positive("height", height, Unit::Metre)?;
        Ok(Self { polygon: RegularPolygon::new(sides, radius)?, half_height })
    }

    fn size(&self) -> f64 {
        self.polygon.radius() + self.half_height
    }
}

impl Kernel<3> for Prism {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        S::orthant([
            self.polygon.distance(Vector([p.0[0], p.0[2]])),
            p.0[1].abs() - S::constant(self.half_height),
        ])
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.size())
    }

    fn promise(&self) -> Promise<3> {
        let profile = self.polygon.promise();
        let width = self.polygon.radius();
        let radius = width.hypot(self.half_height) * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds::centred(Vector([width, self.half_height, width]), radius);
        Promise {
            symmetric: [profile.symmetric[0], true, profile.symmetric[1]],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, self.size())
        }
    }
}

/// A prism along y on a regular hexagon in x and z, two corners on the z axis.
/// Exact.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::HexagonalPrism};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let nut = Shape::from_kernel(HexagonalPrism::new(2.0, 3.0)?);
/// assert!((nut.distance(Vector([0.0, 0.0, 5.0])) - 3.0).abs() < 1e-14);
/// assert_eq!(nut.distance(Vector([0.5, -2.5, 0.0])), 1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct HexagonalPrism(Prism);

impl HexagonalPrism {
    /// A prism on a hexagon with corners at `radius`, of full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(radius: f64, height: f64) -> Result<Self, ShapeError> {
        Ok(Self(Prism::new(6, radius, height)?))
    }
}

answered_by_inner!(HexagonalPrism.0, Prism, 3);

primitive! {
    HexagonalPrism, hexagonal_prism, 3,
    about: "A prism along y on a regular hexagon.",
    origin: "centred; axis along y, two corners on z",
    parameters: {
        radius: Length = "from the axis to a corner of the hexagon"
            => |kernel| kernel.0.polygon.radius(),
        height: Length = "the full height" => |kernel| 2.0 * kernel.0.half_height,
    },
    marks: |kernel| {
        let (radius, height) = (kernel.radius(), kernel.height());
        // From the axis to a side.
        let flat = 0.5 * 3.0_f64.sqrt() * radius;
        vec![
            Mark::from_origin("radius", Vector([0.0, 0.0, radius])),
            Mark::height(height, flat, flat),
        ]
    },
    example: (0.6, 0.5),
}

/// A prism along y on a regular triangle in x and z, one corner towards +z.
/// Exact.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::TriangularPrism};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let roof = Shape::from_kernel(TriangularPrism::new(3.0_f64.sqrt(), 4.0)?);
/// assert!((roof.distance(Vector([0.0, 0.0, 3.0])) - 2.0).abs() < 1e-14); // corner
/// assert!((roof.distance(Vector([0.0, 0.0, -3.0])) - 2.5).abs() < 1e-14); // face
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct TriangularPrism {
    prism: Prism,
    side: f64,
}

impl TriangularPrism {
    /// A prism on a triangle of the given `side`, of full `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive.
    pub fn new(side: f64, height: f64) -> Result<Self, ShapeError> {
        let side = positive("side", side, Unit::Metre)?;
        Ok(Self { prism: Prism::new(3, side / 3.0_f64.sqrt(), height)?, side })
    }
}

answered_by_inner!(TriangularPrism.prism, Prism, 3);

primitive! {
    TriangularPrism, triangular_prism, 3,
    about: "A prism along y on a regular triangle.",
    origin: "at the centre of its triangle, at half its height; axis along y, a corner towards +z",
    parameters: {
        side: Length = "the edge of the triangle",
        height: Length = "the full height" => |kernel| 2.0 * kernel.prism.half_height,
    },
    marks: |kernel| {
        let (side, height) = (kernel.side(), kernel.height());
        let back = -side / 12.0_f64.sqrt();
        vec![
            Mark::length_between("side", Vector([-0.5 * side, 0.0, back]), Vector([0.5 * side, 0.0, back]))
                .beside(-Vector::unit(2)),
            Mark::height(height, side / 3.0, side / 3.0),
        ]
    },
    example: (1.0, 0.6),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, corners, edges, even_odd};

    impl Evidence<3> for HexagonalPrism {
        const SAMPLE: &'static str = r#"{ "radius": 0.05, "height": 0.06 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Hexagonal Prism", "`radius` to a corner, `height`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            prism(6.0, self.radius(), self.height())
        }
    }

    impl Evidence<3> for TriangularPrism {
        const SAMPLE: &'static str = r#"{ "side": 0.08, "height": 0.06 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Triangular Prism", "`side`, `height`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            prism(3.0, self.side() / 3.0_f64.sqrt(), self.height())
        }
    }

    fn prism(sides: f64, radius: f64, height: f64) -> Definition<3> {
        let half = 0.5 * height;
        let ring = corners(sides, &[radius]);
        let mut boundary: Vec<_> = edges(&ring).into_iter().map(|e| e.raised(half)).collect();
        for y in [-half, half] {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                let [a, b, o] = [*a, *b, Vector([0.0, 0.0])].map(|q| Vector([q[0], y, q[1]]));
                boundary.push(Patch::triangle([o, a, b]));
            }
        }
        let rings = [ring];
        Definition::new(boundary, move |p| {
            p[1].abs() < half && even_odd(&rings, Vector([p[0], p[2]]))
        })
    }
}
