// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much of the sky a place sees: ambient occlusion.
//!
//! At the height h over a place without anything near, the field is h. The openness is one minus
//! the mean of `1 − f/h` over heights from near to far (Evans 2006, "Fast Approximations for
//! Global Illumination on Dynamic Scenes"), scaled so that a place without any sky keeps the share
//! [`LEAST`]. It is an estimate: bodies that are near count wherever they are, and where a field
//! is less than the distance, the place is drawn darker.

use palpate_field::{BLOCK, Block, Column, Point};

use crate::shadow::Place;
use crate::studio::Studio;

/// Heights at which the field is looked at, as shares of the reach.
const HEIGHTS: [f64; 5] = [0.05, 0.12, 0.27, 0.55, 1.0];

/// How much of the sky a place sees at least: light comes from bodies too.
const LEAST: f64 = 0.12;

/// Looks from places to the sky.
#[derive(Debug)]
pub(crate) struct Sky<'a> {
    studio: &'a Studio,
    points: Vec<Point<3>>,
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
}

impl<'a> Sky<'a> {
    pub(crate) fn new(studio: &'a Studio) -> Self {
        let points = Vec::with_capacity(BLOCK);
        Self { studio, points, block: Block::zero(), values: Column::zero() }
    }

    /// Puts the openness of each place, of at most [`BLOCK`], into `shares`.
    pub(crate) fn open(&mut self, places: &[Place], shares: &mut Vec<f64>) {
        let Self { studio, points, block, values } = self;
        points.clear();
        points.extend(places.iter().map(|place| place.point));
        // A place is lifted by at most the reach: other parts are farther than that from it.
        let near = studio.surfaces.around(points, 2.0 * studio.reach);
        shares.clear();
        shares.resize(places.len(), 1.0);
        for height in HEIGHTS.map(|share| share * studio.reach) {
            block.fill(places.len(), |i| places[i].point + places[i].normal * height);
            if let Some(near) = &near {
                near.block_distances(block, places.len(), values);
            }
            for (i, share) in shares.iter_mut().enumerate() {
                let of_bodies = if near.is_some() { values.get(i) } else { f64::INFINITY };
                let of_ground = studio.settings.ground.map(|ground| block.get(i)[1] - ground);
                let field = of_bodies.min(of_ground.unwrap_or(f64::INFINITY));
                let blocked = 1.0 - (field / height).clamp(0.0, 1.0);
                *share -= (1.0 - LEAST) * blocked / HEIGHTS.len() as f64;
            }
        }
    }
}
