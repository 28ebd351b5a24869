// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much of the key light, and how much of the sky, a place sees.
//!
//! # The key light
//!
//! A soft light is a disc. Where the cone from the place to the disc is proven free, the place is
//! lit; elsewhere rays to 64 places of the disc, spread as seeds of a sunflower (Vogel 1979), are
//! cast, each with its proof, and the free ones counted; 16 of them are enough where these agree. A hard light is the middle of the disc.
//!
//! # The sky
//!
//! At the height h over a place without anything near, the field is h. The openness is one minus
//! the mean of `1 − f/h` over heights from near to far (Evans 2006, "Fast Approximations for
//! Global Illumination on Dynamic Scenes"). It is an estimate: bodies that are near count wherever
//! they are, and where a field is less than the distance, the place is drawn darker.

use std::f64::consts::TAU;
use std::ops::Range;

use palpate_field::{BLOCK, Block, Column, Point, Vector};

use crate::beam::Beam;
use crate::settings::Shadows;
use crate::studio::Studio;
use crate::trace::{End, Met, Tracer};

/// The radius of the soft light's disc at a distance of one: of 6° in all.
const DISC: f64 = 0.052;

/// Rays to the disc, and how many of them are cast first.
const RAYS: usize = BLOCK;
const FIRST: usize = RAYS / STRIDE;

/// Every fourth place of the disc is among the first, so that they are spread over all of it.
const STRIDE: usize = 4;

/// How far from a surface its shadow rays begin, in gaps: nearer, they would meet the surface
/// that they leave.
const LIFT: f64 = 4.0;

/// Heights at which the sky is looked at, as shares of the reach.
const HEIGHTS: [f64; 5] = [0.05, 0.12, 0.27, 0.55, 1.0];

/// How dark a place is that sees nothing of the sky.
const DARKEST: f64 = 0.12;

/// A place on a surface, with its normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) point: Point<3>,
    pub(crate) normal: Vector<f64, 3>,
}

/// Looks from places to the lights.
#[derive(Debug)]
pub(crate) struct Shadow<'a> {
    studio: &'a Studio,
    pub(crate) tracer: Tracer<'a>,
    /// Where the disc of the light is cut by rays, from its middle.
    disc: Vec<Vector<f64, 3>>,
    beams: Vec<Beam>,
    met: Vec<Met>,
    met_of_disc: Vec<Met>,
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
}

impl<'a> Shadow<'a> {
    pub(crate) fn new(studio: &'a Studio) -> Self {
        Self {
            studio,
            tracer: studio.tracer(),
            disc: disc(studio.key),
            beams: Vec::with_capacity(BLOCK),
            met: Vec::with_capacity(BLOCK),
            met_of_disc: Vec::with_capacity(BLOCK),
            block: Block::zero(),
            values: Column::zero(),
        }
    }

    /// Puts the visible share of the key light from each place, of at most [`BLOCK`], into
    /// `shares`.
    pub(crate) fn of_key(&mut self, places: &[Place], shares: &mut Vec<f64>) {
        shares.clear();
        let Studio { key, settings, .. } = *self.studio;
        if settings.shadows == Shadows::None {
            shares.resize(places.len(), 1.0);
            return;
        }
        let spread = if settings.shadows == Shadows::Soft { DISC } else { 0.0 };
        self.beams.clear();
        for place in places {
            let beam = self.studio.cut(&Beam { spread, ..self.lifted(place, key) });
            // A place that faces away from the whole light needs no ray.
            let faces = place.normal.dot(key) > -spread;
            let far = if faces { beam.far } else { f64::NEG_INFINITY };
            self.beams.push(Beam { far, ..beam });
        }
        let mut met = std::mem::take(&mut self.met);
        self.tracer.trace(&self.beams, &mut met);
        for (place, met) in places.iter().zip(&met) {
            shares.push(match self.certain(place, met) {
                Some(share) => share,
                None => self.of_disc(place),
            });
        }
        self.met = met;
    }

    /// The visible share of the light, as far as the ray to its middle tells it.
    fn certain(&self, place: &Place, met: &Met) -> Option<f64> {
        let Studio { key, settings, .. } = *self.studio;
        if settings.shadows == Shadows::Hard {
            let is_lit = met.end == End::Free && place.normal.dot(key) > 0.0;
            return Some(if is_lit { 1.0 } else { 0.0 });
        }
        let height = place.normal.dot(key);
        if height <= -DISC {
            return Some(0.0);
        }
        (met.end == End::Free && !met.is_beside && height >= DISC).then_some(1.0)
    }

    /// The visible share of the disc of the light. Where the first rays agree, they tell it.
    fn of_disc(&mut self, place: &Place) -> f64 {
        let first = self.free(place, 0..FIRST);
        if first == 0 || first == FIRST {
            return first as f64 / FIRST as f64;
        }
        (first + self.free(place, FIRST..RAYS)) as f64 / RAYS as f64
    }

    /// How many of these rays to the disc are free.
    fn free(&mut self, place: &Place, rays: Range<usize>) -> usize {
        self.beams.clear();
        for aside in &self.disc[rays] {
            let way = self.studio.key + *aside;
            let direction = way * (1.0 / way.norm());
            if place.normal.dot(direction) > 0.0 {
                self.beams.push(self.studio.cut(&self.lifted(place, direction)));
            }
        }
        self.tracer.trace(&self.beams, &mut self.met_of_disc);
        self.met_of_disc.iter().filter(|met| met.end == End::Free).count()
    }

    /// A ray from just over a place.
    fn lifted(&self, place: &Place, direction: Vector<f64, 3>) -> Beam {
        let lift = LIFT * self.studio.surfaces.gap;
        Beam::ray(place.point + place.normal * lift, direction)
    }

    /// Puts the openness of each place, of at most [`BLOCK`], to the sky into `shares`.
    pub(crate) fn of_sky(&mut self, places: &[Place], shares: &mut Vec<f64>) {
        shares.clear();
        shares.resize(places.len(), 1.0);
        let Studio { reach, ref surfaces, ref settings, .. } = *self.studio;
        for height in HEIGHTS.map(|share| share * reach) {
            self.block.fill(places.len(), |i| places[i].point + places[i].normal * height);
            surfaces.whole.block_distances(&self.block, places.len(), &mut self.values);
            for (i, share) in shares.iter_mut().enumerate() {
                let over_ground = settings
                    .ground
                    .map_or(f64::INFINITY, |ground| self.block.get(i)[1] - ground);
                let free = (self.values.get(i).min(over_ground) / height).clamp(0.0, 1.0);
                *share -= (1.0 - DARKEST) * (1.0 - free) / HEIGHTS.len() as f64;
            }
        }
    }
}

/// Places of the disc around the direction `key`, from its middle.
fn disc(key: Vector<f64, 3>) -> Vec<Vector<f64, 3>> {
    let aside = if key[0].abs() < 0.5 { Vector::unit(0) } else { Vector::unit(1) };
    let right = key.cross(aside).normalized().unwrap_or(aside);
    let up = key.cross(right);
    let golden = TAU * 0.381_966_011_250_105;
    let place = |i: usize| {
        let radius = DISC * ((i as f64 + 0.5) / RAYS as f64).sqrt();
        let angle = golden * i as f64;
        right * (radius * libm::cos(angle)) + up * (radius * libm::sin(angle))
    };
    let is_first = |i: &usize| i % STRIDE == STRIDE / 2;
    let first = (0..RAYS).filter(is_first);
    first.chain((0..RAYS).filter(|i| !is_first(i))).map(place).collect()
}
