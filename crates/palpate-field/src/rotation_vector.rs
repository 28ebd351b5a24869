// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rotation vectors: along the axis, with the angle as length [rad]; in the plane along z.

use crate::pose::Rotation;
use crate::vector::Vector;

/// Below this angle [rad], sin θ / θ is one to the last bit.
const TINY: f64 = 1e-9;

impl<const D: usize> Rotation<D> {
    /// This rotation, followed by that of the rotation vector `by`, which lies along the axis with
    /// the angle as length [rad]; in the plane along z.
    ///
    /// The result is orthonormal to rounding, so that any number of rotations may be chained. A
    /// vector that is not finite turns nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::Rotation;
    ///
    /// let half = Rotation::<2>::identity().turned([0.0, 0.0, 0.5]);
    /// assert!((half.turned([0.0, 0.0, 0.25]).angle() - 0.75).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn turned(&self, by: impl Into<Vector<f64, 3>>) -> Self {
        let turned = of_vector(by.into()) * *self;
        Self::from_matrix(*turned.matrix()).unwrap_or(*self)
    }

    /// The rotation vector from this rotation to another, at most π long [rad]: the inverse of
    /// [`turned`](Self::turned).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::{Rotation, Vector};
    ///
    /// let (start, by) = (Rotation::<3>::identity(), Vector([0.25, -0.5, 1.0]));
    /// assert!((start.turn_to(&start.turned(by)) - by).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn turn_to(&self, to: &Self) -> Vector<f64, 3> {
        vector_of(*to * self.inverse())
    }
}

/// The rotation by a vector: `R = I + (sin θ / θ) W + (2 sin²(θ/2) / θ²) W²` with `W v = w × v`
/// and `θ = ‖w‖` (Rodrigues 1840).
fn of_vector<const D: usize>(w: Vector<f64, 3>) -> Rotation<D> {
    let angle = w.norm();
    let (first, second) = if angle > TINY {
        let half = libm::sin(0.5 * angle);
        (libm::sin(angle) / angle, 2.0 * half * half / (angle * angle))
    } else {
        (1.0, 0.5)
    };
    let column = |axis: usize| {
        let e = Vector::<f64, 3>::unit(axis);
        let turned = w.cross(e);
        e + turned * first + w.cross(turned) * second
    };
    let (x, y, z) = (column(0), column(1), column(2));
    let rows: [[f64; D]; D] = std::array::from_fn(|i| {
        let row = [x, y, z].map(|column| column.0.get(i).copied().unwrap_or(0.0));
        std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
    });
    Rotation::from_matrix(rows).unwrap_or_else(|_| Rotation::identity())
}

/// The rotation vector, at most π long: `2 atan2(‖q‖, w) q / ‖q‖` for the quaternion `(q, w)`.
fn vector_of<const D: usize>(rotation: Rotation<D>) -> Vector<f64, 3> {
    let rows = std::array::from_fn(|i| {
        let unit = Vector::<f64, 3>::unit(i).0;
        std::array::from_fn(|k| {
            let inside = rotation.matrix().get(i).and_then(|row| row.get(k));
            inside.or(unit.get(k)).copied().unwrap_or(0.0)
        })
    });
    let Ok(rotation) = Rotation::<3>::from_matrix(rows) else { return Vector::ZERO };
    let [x, y, z, w] = rotation.quaternion();
    let axis = Vector([x, y, z]);
    let sine = axis.norm();
    if sine > 0.0 { axis * (2.0 * libm::atan2(sine, w) / sine) } else { Vector::ZERO }
}
