// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The octahedron.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Kernel, face_if_on_it, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 12.0;

/// The regular octahedron `|x| + |y| + |z| ≤ r`, corners on the axes. Exact.
///
/// # Derivation
///
/// Fold `p` into the positive octant, where the one face is `x + y + z = r`. The
/// foot on its plane is `p − m/3` in each coordinate, with `m = x + y + z − r`.
/// If no coordinate of the foot is negative, the distance is `m/√3`, on either
/// side. Else `p` is outside, and the nearest point is on the edge between the
/// two axes with the larger coordinates.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Octahedron};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let dice = Shape::from_kernel(Octahedron::new(2.0)?);
/// assert_eq!(dice.distance(Vector([0.0, -5.0, 0.0])), 3.0); // past a corner
/// assert!((dice.distance(Vector([0.0; 3])) + 2.0 / 3.0_f64.sqrt()).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Octahedron {
    radius: f64,
}

impl Octahedron {
    /// An octahedron with corners at `radius` from the centre [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn new(radius: f64) -> Result<Self, ShapeError> {
        Ok(Self { radius: positive("radius", radius, Unit::Metre)? })
    }
}

impl Kernel<3> for Octahedron {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let zero = S::constant(0.0);
        let radius = S::constant(self.radius);
        let [x, y, z] = p.abs().0;
        let beyond = x + y + z - radius;
        // The coordinates in order: a ≥ b ≥ c. At ties `min` and `max` keep their first
        // argument, so each coordinate is taken once and the gradient is right.
        let (larger, smaller) = (x.max(y), y.min(x));
        let (a, c) = (larger.max(z), smaller.min(z));
        let b = z.min(larger).max(smaller);
        let foot = c - beyond.scale(1.0 / 3.0);
        let along = (b - a + radius).scale(0.5).clamp(0.0, self.radius);
        let edge = S::norm([a - radius + along, b - along, c]);
        let face = beyond.scale(1.0 / 3.0_f64.sqrt());
        let outside = face_if_on_it(edge, face, self.radius);
        S::select_less(foot, zero, outside, face)
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<3> {
        let bounds = Bounds::centred(Vector::constant(self.radius), self.radius);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.radius).symmetric()
    }
}

primitive! {
    Octahedron, octahedron, 3,
    about: "A regular octahedron with corners on the axes.",
    origin: "centred; corners on the axes",
    parameters: { radius: Length = "from the centre to a corner" },
    marks: |kernel| vec![Mark::from_origin("radius", at(kernel.radius(), 0.0))],
    example: (0.8),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, hull};

    impl Evidence<3> for Octahedron {
        const SAMPLE: &'static str = r#"{ "radius": 0.05 }"#;
        const GUIDE: &'static [Row] = &[
            Row::new("Octahedron", "`radius` to a corner", "exact, convex"),
            Row::new("Octahedron, cheap", "the same", "exact, convex"),
        ];

        fn definition(&self) -> Definition<3> {
            octahedron(self.radius())
        }
    }

    fn octahedron(r: f64) -> Definition<3> {
        let mut triangles = Vec::new();
        for x in [-r, r] {
            for y in [-r, r] {
                for z in [-r, r] {
                    triangles.push([
                        Vector([x, 0.0, 0.0]),
                        Vector([0.0, y, 0.0]),
                        Vector([0.0, 0.0, z]),
                    ]);
                }
            }
        }
        hull(triangles, Vector::ZERO)
    }
}
