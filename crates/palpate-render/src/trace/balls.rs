// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Steps by balls: a value of the field proves a ball free of surfaces, and a ray advances through
//! it (Hart 1996, as [`cast_ray`](palpate_query::cast_ray) does).
//!
//! As long as the ball is wider than the ray's cone, the step is so short that the ball holds the
//! cone too.

use palpate_field::Shape;
use palpate_query::free_radius;

use super::Lane;
use crate::beam::Beam;

impl Lane {
    /// Advances by what the positive value of the field where the ray is proves.
    pub(super) fn advance_by_ball(&mut self, shape: &Shape<3>, beam: &Beam, value: f64) {
        let ball = free_radius(shape, beam.at(self.distance), value);
        let cone = beam.radius(self.distance);
        // Written so that NaN counts as near.
        let step = if ball > cone {
            // The ray leaves a surface that was in its cone.
            self.is_beside |= self.is_near && ball > 2.0 * cone;
            beam.step_through(cone, ball)
        } else {
            (self.is_near, self.is_thin) = (true, true);
            ball
        };
        // A ray that rounding or a promise's region holds is left to the models.
        if step > 0.0 {
            self.distance += step;
            self.step = step;
        }
    }
}
