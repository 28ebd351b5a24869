// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of fields along rays.
//!
//! Steps by models: an affine function with remainders bounds the field over a part of a ray.
//!
//! A cell holds the next part of the ray with its cone, with one parameter along the ray and two
//! across. Where the model is positive over the whole cell, the ray passes it, and the next cell
//! is longer. Else it advances to where the model's lower bound, which is linear along the ray,
//! comes to zero: Newton's method with a proof. Near a surface whole steps follow the slope that
//! the field has there, however steep it is elsewhere, and along a surface they follow its curve.
//!
//! Steps by balls: a value of the field proves a ball free of surfaces, and a ray advances through
//! it (Hart 1996, as [`cast_ray`](palpate_query::cast_ray) does).
//!
//! As long as the ball is wider than the ray's cone, the step is so short that the ball holds the
//! cone too.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Shape, Vector};
use palpate_query::free_radius;

use super::pieces::{Cells, Pieces};
use super::{Lane, Look};
use crate::beam::Beam;

/// The first step, as a share of the ray.
const FIRST: f64 = 0.25;

/// How much longer the step after a whole one is, and how much shorter after another; it stays
/// below the last length that was too long, which may be tried again after a few steps.
const GROWTH: f64 = 2.5;
const SHRINKAGE: f64 = 0.35;
const BELOW: f64 = 0.8;
const RELIEF: f64 = 1.2;

/// A cell shorter than its cone is wide is not made shorter: the surface is in the cone. A ray
/// that passes a cell so many times as long alone has left the surface. If it has not, as along a
/// wall, twice as many times the next time: few cells are spent on trying again.
pub(super) const SLENDER: f64 = 8.0;

/// The rounding of the middle of a cell and of its sides, in units of their sizes.
const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// The length of the first step of a beam [m].
pub(super) fn first_step(beam: &Beam) -> f64 {
    FIRST * (beam.far - beam.near)
}

/// Advances rays by what models of the pieces prove.
pub(super) fn advance(pieces: &Pieces, beams: &[Beam], lanes: &mut [Lane], cells: &mut Cells) {
    let all: Vec<usize> = (0..lanes.len()).collect();
    for (lane, cell) in lanes.iter().zip(&mut cells.cells) {
        *cell = lane.cell(&beams[lane.beam]);
    }
    let mut shares = [0.0; BLOCK];
    pieces.free(cells, &all, &mut shares);
    for (lane, share) in lanes.iter_mut().zip(shares) {
        lane.advance_by_model(&beams[lane.beam], share);
    }
}

impl Lane {
    /// The end of the next cell, from the origin of the beam [m].
    fn end(&self, beam: &Beam) -> f64 {
        (self.distance + self.step).min(beam.far)
    }

    /// The radius of the cone in the next cell [m].
    fn cone(&self, beam: &Beam) -> f64 {
        if self.is_thin { 0.0 } else { beam.radius(self.end(beam)) }
    }

    /// The coordinates of the next cell.
    fn cell(&self, beam: &Beam) -> Vector<Model, 3> {
        let (half, cone) = (0.5 * (self.end(beam) - self.distance), self.cone(beam));
        let centre = beam.at(self.distance + half);
        let [across, other] = beam.across();
        Vector(std::array::from_fn(|k| {
            let gradient = [half * beam.direction[k], cone * across[k], cone * other[k]];
            let remainder = ROUNDINGS * (centre.norm() + half + cone);
            Model { value: centre[k], gradient, lower: remainder, upper: remainder }
        }))
    }

    /// Advances, where a share of the next cell from its beginning is free.
    fn advance_by_model(&mut self, beam: &Beam, share: f64) {
        let (end, cone) = (self.end(beam), beam.radius(self.end(beam)));
        let length = end - self.distance;
        if share >= 1.0 {
            self.distance = end;
            if self.is_thin && length > self.slender * cone {
                self.is_beside |= self.is_near;
                self.is_thin = false;
                self.slender *= 2.0;
            }
            self.step = (GROWTH * length).min(BELOW * self.too_long);
            self.too_long *= RELIEF;
            self.look = Look::Needless;
            return;
        }
        if share < 0.5 && length < self.cone(beam) {
            (self.is_near, self.is_thin) = (true, true);
        }
        // Where no step is proven, the surface may be as near as the ray.
        if share > 0.0 || self.look == Look::Needless {
            self.look = Look::Due;
        }
        self.distance += share * length;
        (self.step, self.too_long) = (SHRINKAGE * length, length);
    }
}

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
