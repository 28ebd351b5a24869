// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Steps by models: an affine function with remainders bounds the field over a part of a ray.
//!
//! A cell holds the next part of the ray with its cone, with one parameter along the ray and two
//! across. Where the model is positive over the whole cell, the ray passes it, and the next cell
//! is longer. Else it advances to where the model's lower bound, which is linear along the ray,
//! comes to zero: Newton's method with a proof. Near a surface whole steps follow the slope that
//! the field has there, however steep it is elsewhere, and along a surface they follow its curve.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Shape, Vector};

use super::Lane;
use crate::beam::Beam;

/// The first step, as a share of the ray.
const FIRST: f64 = 0.25;

/// How much longer the step after a whole one is, and how much shorter after none.
const GROWTH: f64 = 2.5;
const SHRINKAGE: f64 = 0.3;

/// A cell this many times as long as its cone is wide is not made shorter: the surface is in the
/// cone. A ray that passes as long a cell alone has left the surface.
const SLENDER: f64 = 8.0;

/// The rounding of the middle of a cell and of its sides, in units of their sizes.
const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// Memory for the models of a block of rays.
#[derive(Debug)]
pub(super) struct Models {
    cells: Block<Model, 3, BLOCK>,
    models: Column<Model, BLOCK>,
}

/// The length of the first step of a beam [m].
pub(super) fn first_step(beam: &Beam) -> f64 {
    FIRST * (beam.far - beam.near)
}

impl Models {
    pub(super) fn new() -> Self {
        Self { cells: Block::zero(), models: Column::zero() }
    }

    /// Advances rays by what models of the field prove.
    pub(super) fn advance(&mut self, shape: &Shape<3>, beams: &[Beam], lanes: &mut [Lane]) {
        if lanes.is_empty() {
            return;
        }
        self.cells.fill(lanes.len(), |i| lanes[i].cell(&beams[lanes[i].beam]));
        shape.block_distances(&self.cells, lanes.len(), &mut self.models);
        for (i, lane) in lanes.iter_mut().enumerate() {
            lane.advance_by_model(&beams[lane.beam], &self.models.get(i));
        }
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

    fn advance_by_model(&mut self, beam: &Beam, model: &Model) {
        let (end, cone) = (self.end(beam), beam.radius(self.end(beam)));
        let length = end - self.distance;
        if model.minimum() > 0.0 {
            self.distance = end;
            if self.is_thin && length > SLENDER * cone {
                self.is_beside |= self.is_near;
                self.is_thin = false;
            }
            self.step = GROWTH * length;
            return;
        }
        let share = passed(model);
        if share < 0.5 && length < SLENDER * self.cone(beam) {
            (self.is_near, self.is_thin) = (true, true);
        }
        self.distance += share * length;
        self.step = SHRINKAGE * length;
    }
}

/// The share of a cell from its beginning over which a model is positive.
fn passed(model: &Model) -> f64 {
    let [along, across, other] = model.gradient;
    // Room for the roundings of this sum, as `Model::minimum` has it.
    let inflated = 1.0 + 8.0 * f64::EPSILON;
    let below = (across.abs() + other.abs() + model.lower) * inflated;
    let least = model.value - below - 4.0 * f64::EPSILON * model.value.abs();
    // At u along the cell, from −1 to 1, the field is at least `least + along u`.
    if least - along > 0.0 && along < 0.0 {
        let share = 0.5 * (1.0 - least / along);
        (share * (1.0 - 1e-9)).min(1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_field_is_passed_up_to_its_zero() {
        let falling = Model { value: 1.0, gradient: [-4.0, 0.0, 0.0], lower: 0.0, upper: 0.0 };
        // From 5 to −3 over the cell: zero after 5/8 of it.
        assert!((passed(&falling) - 0.625).abs() < 1e-8 && passed(&falling) < 0.625);
        let rising = Model { gradient: [4.0, 0.0, 0.0], ..falling };
        assert_eq!(passed(&rising), 0.0);
        // Half as far if it may be 2.5 less anywhere.
        let loose = Model { lower: 2.5, ..falling };
        assert!((passed(&loose) - 0.3125).abs() < 1e-8);
    }
}
