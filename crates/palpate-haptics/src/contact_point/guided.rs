// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The force of the guides on a contact point.

use palpate_field::{Point, Vector};

use super::ContactPoint;
use crate::guide::Guide;

impl ContactPoint {
    /// The force of the guides [N]; zero if a number is not finite.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn guided(
        &mut self,
        position: Point<3>,
        velocity: Vector<f64, 3>,
        rise_step: f64,
    ) -> Vector<f64, 3> {
        if self.guides.is_empty() || !(position.is_finite() && velocity.is_finite()) {
            return Vector::ZERO;
        }
        let guides = self.guides.iter_mut();
        let all = guides.fold(Vector::ZERO, |sum, guide| sum + guide.force(position, velocity));
        let part = self.guided;
        self.guided = (part + rise_step).min(1.0);
        all * part
    }

    /// Lets go of the guides, as a hand that is lifted does.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn let_go(&mut self) {
        self.guides.iter_mut().for_each(Guide::let_go);
        self.guided = 0.0;
    }
}
