// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The torus.

use super::cylinder::from_axis;
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// All points within `radius` of a circle about the y axis. Exact.
///
/// `f = ‖(√(x² + z²) − R, y)‖ − r`.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Torus};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ring = Shape::from_kernel(Torus::new(5.0, 1.0)?);
/// assert_eq!(ring.distance(Vector([0.0, 0.0, 0.0])), 4.0); // in the hole
/// assert_eq!(ring.distance(Vector([3.0, 12.0, 4.0])), 11.0); // above
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Torus {
    ring_radius: f64,
    radius: f64,
}

impl Torus {
    /// A torus around a circle of `ring_radius`, its tube of `radius` [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, or the tube's is the larger: then it would
    /// meet itself at the axis.
    pub fn new(ring_radius: f64, radius: f64) -> Result<Self, ShapeError> {
        positive("ring_radius", ring_radius, Unit::Metre)?;
        positive("radius", radius, Unit::Metre)?;
        if radius > ring_radius {
            let rule = format!("at most the radius of the ring, {ring_radius} m");
            return Err(ShapeError::number("radius", rule, radius, Unit::Metre));
        }
        Ok(Self { ring_radius, radius })
    }
}

impl Kernel<3> for Torus {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        S::norm([from_axis(p) - S::constant(self.ring_radius), p.0[1]])
            - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<3> {
        let reach = self.ring_radius + self.radius;
        let bounds = Bounds::centred(Vector([reach, self.radius, reach]), reach);
        Promise::exact(Some(bounds), 8.0, reach).symmetric()
    }
}

primitive! {
    Torus, "torus", 3,
    about: "All points within a radius of a circle about the y axis.",
    model: ClosedForm,
    parameters: {
        ring_radius: Length = "the radius of the circle",
        radius: Length = "the radius of the tube",
    },
    example: (0.6, 0.2),
}
