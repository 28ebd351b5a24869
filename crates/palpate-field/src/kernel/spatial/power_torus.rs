// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The torus of other norms.

use super::torus::Torus;
use crate::bounds::Bounds;
use crate::error::ShapeError;
use crate::kernel::exponent::{Exponent, in_another_norm};
use crate::kernel::mark::sets;
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// Rounded operations of the formula.
const OPERATIONS: f64 = 10.0;

/// A torus about the y axis, its ring and its tube each a circle of another norm: from
/// a round ring of square wire to a frame with rounded corners. A bound on both sides,
/// exact where both exponents are 2.
///
/// `f = ‖(‖(x, z)‖_A − R, y)‖_B − r`, after Quilez, whose `torus82` has a round ring and
/// eighth powers across the tube, and `torus88` eighth powers in both.
///
/// # Derivation
///
/// Both norms are at most the Euclidean, so their gradients are at most one long. With `(a, b)`
/// the gradient of the outer norm and `g` that of the inner one, in the plane of x and z, the
/// gradient of `f` is `(a·g, b)`, which is no longer than `(a, b)`. So the Lipschitz constant
/// is 1, and values are bounds.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::PowerTorus};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ring = Shape::from_kernel(PowerTorus::new(5.0, 1.0, 2, 8)?);
/// assert_eq!(ring.distance(Vector([0.0, 0.0, 0.0])), 4.0); // in the hole
/// assert_eq!(ring.distance(Vector([3.0, 12.0, 4.0])), 11.0); // above
/// // 7 from the axis, so 2 out of the ring, and 2 up
/// let f = ring.distance(Vector([4.2, 2.0, 5.6]));
/// assert!((f - (2.0_f64.powf(1.125) - 1.0)).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PowerTorus {
    round: Torus,
    ring: Option<Exponent>,
    tube: Option<Exponent>,
}

impl PowerTorus {
    /// A torus around a circle of `ring_radius` [m] in the norm of `ring_exponent`, its
    /// tube of `radius` [m] in that of `tube_exponent`, each of 2, 4, 6 or 8.
    ///
    /// # Errors
    ///
    /// If a radius is not positive, the tube's is the larger, or an exponent is another.
    pub fn new(
        ring_radius: f64,
        radius: f64,
        ring_exponent: u32,
        tube_exponent: u32,
    ) -> Result<Self, ShapeError> {
        Ok(Self {
            round: Torus::new(ring_radius, radius)?,
            ring: Exponent::or_euclidean("ring_exponent", ring_exponent)?,
            tube: Exponent::or_euclidean("tube_exponent", tube_exponent)?,
        })
    }
}

/// The norm in the plane, Euclidean without an exponent.
#[inline(always)]
fn norm<S: Scalar>(exponent: Option<Exponent>, x: [S; 2]) -> S {
    match exponent {
        None => S::norm(x),
        Some(exponent) => exponent.norm(x),
    }
}

impl Kernel<3> for PowerTorus {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.0;
        let from_ring = norm(self.ring, [x, z]) - S::constant(self.round.ring_radius);
        norm(self.tube, [from_ring, y]) - S::constant(self.round.radius)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations {
            operations: OPERATIONS,
            size: self.round.ring_radius + self.round.radius,
        })
    }

    fn promise(&self) -> Promise<3> {
        let (ring, tube) = (self.round.ring_radius, self.round.radius);
        let [along, across] =
            [self.ring, self.tube].map(|exponent| exponent.map_or(1.0, Exponent::reach::<2>));
        let half = Vector([ring + tube, tube, ring + tube]);
        let bounds = Bounds::centred(half, along * (ring + across * tube));
        let exact = Promise::exact(Some(bounds), OPERATIONS, ring + tube).symmetric();
        if self.ring.or(self.tube).is_none() { exact } else { in_another_norm(exact) }
    }
}

primitive! {
    PowerTorus, power_torus, 3,
    about: "A torus about the y axis, its ring and its tube circles in norms of higher powers.",
    origin: "centred; axis along y",
    parameters: {
        ring_radius: Length = "the radius of the ring along the axes"
            => |kernel| kernel.round.ring_radius,
        radius: Length = "the radius of the tube along the axes"
            => |kernel| kernel.round.radius,
        ring_exponent: Count = "the power that the ring's norm adds up, 2, 4, 6 or 8"
            => |kernel| kernel.ring.map_or(2, Exponent::number),
        tube_exponent: Count = "the power that the tube's norm adds up, 2, 4, 6 or 8"
            => |kernel| kernel.tube.map_or(2, Exponent::number),
    },
    marks: |kernel| sets::ring(kernel.ring_radius(), kernel.radius()),
    example: (0.6, 0.25, 4, 8),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::TAU;

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, bound, norm, on_ball, speed};
    use crate::vector::Point;

    impl Evidence<3> for PowerTorus {
        const SAMPLE: &'static str = r#"{ "ring_radius": 0.035, "radius": 0.015, "ring_exponent": 2, "tube_exponent": 8 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Torus82, Torus88",
            "`ring_radius`, `radius`; `ring_exponent` and `tube_exponent` 2 and 8, or both 8",
            "bound; exact if both are 2",
        )];

        fn definition(&self) -> Definition<3> {
            torus(
                self.ring_radius(),
                self.radius(),
                [f64::from(self.ring_exponent()), f64::from(self.tube_exponent())],
            )
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(0.1, 0.25, 8, 8),
                Self::new(0.5, 0.25, 3, 8),
                Self::new(0.5, 0.25, 2, 10),
            ]
        }
    }

    fn torus(ring: f64, r: f64, [about, across]: [f64; 2]) -> Definition<3> {
        // Along the diagonals of the ring, its points move farther than those of the tube.
        let wider = speed::<2>(about).sqrt();
        let along = TAU * (ring + r) * speed::<2>(about);
        let around = TAU * r * speed::<2>(across) * wider;
        let surface = Patch::surface([along, around], move |u, v| {
            let ((sin, cos), (up, out)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
            let [x, z] = on_ball(Vector([cos, sin]), about).0;
            let [out, up] = on_ball(Vector([out, up]), across).0;
            let from_axis = ring + r * out;
            Vector([x * from_axis, r * up, z * from_axis])
        });
        let inside = move |p: Point<3>| {
            let from_ring = norm(Vector([p[0], p[2]]), about) - ring;
            norm(Vector([from_ring, p[1]]), across) < r
        };
        let definition = Definition::new(vec![surface], inside);
        if about.max(across) > 2.0 { bound(definition) } else { definition }
    }
}
