// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much of the key light a place sees.
//!
//! A soft light is a disc. Where the cone from the place to the disc is proven free, the place is
//! lit. Elsewhere rays are cast to 64 places of the disc, spread as seeds of a sunflower (Vogel
//! 1979), each with its proof, and the free ones are counted. Where the 16 rays to the rim are all
//! blocked, or all free, the others are taken for the same. The places of a pixel at an edge share
//! the 64 rays. A hard light is the middle of the disc.

use std::f64::consts::TAU;
use std::ops::Range;

use palpate_field::{BLOCK, Point, Vector};

use crate::beam::Beam;
use crate::settings::Shadows;
use crate::studio::Studio;
use crate::trace::{End, Goal, Met, Tracer};

/// The radius of the soft light's disc at a distance of one: of 6° in all.
const DISC: f64 = 0.052;

/// Rays to the disc, and how many of them are cast first: those to its rim.
const RAYS: usize = 64;
const FIRST: usize = 16;

/// How far from a surface its shadow rays begin, in gaps: nearer, they would meet the surface
/// that they leave.
const LIFT: f64 = 4.0;

/// A place on a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) point: Point<3>,
    /// The unit normal.
    pub(crate) normal: Vector<f64, 3>,
    pub(crate) part: Part,
}

/// A place's part of what all places of a pixel look at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// The number of the place, from 0.
    pub(crate) number: usize,
    /// How many there are.
    pub(crate) of: usize,
}

impl Part {
    /// That of a ray of a block, of which each pixel has `samples` squared.
    pub(crate) fn of_ray(ray: usize, samples: u32) -> Self {
        let of = (samples * samples) as usize;
        Self { number: ray % of, of }
    }

    fn has(self, ray: usize) -> bool {
        ray % self.of == self.number
    }
}

/// Looks from places to the key light.
#[derive(Debug)]
pub(crate) struct Shadow<'a> {
    studio: &'a Studio,
    pub(crate) tracer: Tracer<'a>,
    /// Where the disc of the light is cut by rays, from its middle.
    disc: Vec<Vector<f64, 3>>,
    beams: Vec<Beam>,
    /// The place that each beam begins at.
    origins: Vec<usize>,
    met: Vec<Met>,
    /// The free rays to the disc from each place.
    free: [usize; BLOCK],
}

impl<'a> Shadow<'a> {
    pub(crate) fn new(studio: &'a Studio) -> Self {
        Self {
            studio,
            tracer: studio.tracer(),
            disc: disc(studio.key),
            beams: Vec::with_capacity(BLOCK),
            origins: Vec::with_capacity(BLOCK),
            met: Vec::with_capacity(BLOCK),
            free: [0; BLOCK],
        }
    }

    /// Puts the visible share of the key light from each place, of at most [`BLOCK`], into
    /// `shares`.
    pub(crate) fn of_key(&mut self, places: &[Place], shares: &mut Vec<f64>) {
        shares.clear();
        let (goal, spread) = match self.studio.settings.shadows {
            Shadows::None => return shares.resize(places.len(), 1.0),
            Shadows::Hard => (Goal::Any, 0.0),
            Shadows::Soft => (Goal::Cone, DISC),
        };
        self.beams.clear();
        for place in places {
            let beam = Beam { spread, ..self.lifted(place, self.studio.key) };
            // A place that faces away from the whole light needs no ray.
            let faces = place.normal.dot(self.studio.key) > -spread;
            let far = if faces { f64::INFINITY } else { f64::NEG_INFINITY };
            self.beams.push(self.studio.cut(&Beam { far, ..beam }));
        }
        self.tracer.aim(&self.beams);
        self.tracer.trace(goal, &self.beams, &mut self.met);
        let mut open = Vec::new();
        for (i, (place, met)) in places.iter().zip(&self.met).enumerate() {
            let share = self.certain(place, met);
            shares.push(share.unwrap_or(0.0));
            if share.is_none() {
                open.push(i);
            }
        }
        self.look(places, &open);
        for place in open {
            let part = places[place].part;
            let rays = (0..RAYS).filter(|ray| part.has(*ray)).count();
            shares[place] = self.free[place] as f64 / rays.max(1) as f64;
        }
    }

    /// The visible share of the light, as far as the ray to its middle tells it.
    fn certain(&self, place: &Place, met: &Met) -> Option<f64> {
        let height = place.normal.dot(self.studio.key);
        if self.studio.settings.shadows == Shadows::Hard {
            return Some(if met.end == End::Free && height > 0.0 { 1.0 } else { 0.0 });
        }
        if height <= -DISC {
            return Some(0.0);
        }
        (met.end == End::Free && !met.is_beside && height >= DISC).then_some(1.0)
    }

    /// Counts the free rays to the disc from the `open` ones of the places.
    fn look(&mut self, places: &[Place], open: &[usize]) {
        self.free = [0; BLOCK];
        self.cast(places, open, 0..FIRST);
        for place in open.iter().filter(|place| places[**place].part.of == 1) {
            if self.free[*place] == FIRST {
                self.free[*place] = RAYS;
            }
        }
        let is_open = |place: &usize| {
            let free = self.free[*place];
            (free > 0 && free < RAYS) || places[*place].part.of > 1
        };
        let open: Vec<usize> = open.iter().copied().filter(is_open).collect();
        self.cast(places, &open, FIRST..RAYS);
    }

    /// Counts those of these rays that are a place's part, and free.
    fn cast(&mut self, places: &[Place], open: &[usize], rays: Range<usize>) {
        self.beams.clear();
        self.origins.clear();
        for origin in open {
            let place = &places[*origin];
            for ray in rays.clone().filter(|ray| place.part.has(*ray)) {
                let way = self.studio.key + self.disc[ray];
                let direction = way * (1.0 / way.norm());
                if place.normal.dot(direction) > 0.0 {
                    self.beams.push(self.studio.cut(&self.lifted(place, direction)));
                    self.origins.push(*origin);
                }
                if self.beams.len() == BLOCK {
                    self.count();
                }
            }
        }
        self.count();
    }

    /// Counts the free ones of the beams, and forgets them.
    fn count(&mut self) {
        self.tracer.aim(&self.beams);
        self.tracer.trace(Goal::Any, &self.beams, &mut self.met);
        for (origin, met) in self.origins.iter().zip(&self.met) {
            self.free[*origin] += usize::from(met.end == End::Free);
        }
        self.beams.clear();
        self.origins.clear();
    }

    /// A ray from just over a place.
    fn lifted(&self, place: &Place, direction: Vector<f64, 3>) -> Beam {
        let lift = LIFT * self.studio.surfaces.gap;
        Beam::ray(place.point + place.normal * lift, direction)
    }
}

/// Places of the disc around the direction `key`, from its middle; the outer ones first.
fn disc(key: Vector<f64, 3>) -> Vec<Vector<f64, 3>> {
    let [right, up] = Beam::ray(Vector::ZERO, key).across();
    let golden = TAU * 0.381_966_011_250_105;
    let place = |i: usize| {
        let radius = DISC * ((i as f64 + 0.5) / RAYS as f64).sqrt();
        let angle = golden * i as f64;
        right * (radius * libm::cos(angle)) + up * (radius * libm::sin(angle))
    };
    (0..RAYS).rev().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_spread_over_the_disc_and_begin_at_its_rim() {
        let key = Vector([0.6, 0.8, 0.0]);
        let disc = disc(key);
        assert!(disc[..FIRST].iter().all(|place| place.norm() > 0.86 * DISC));
        assert!(disc.iter().all(|place| place.norm() < DISC && place.dot(key).abs() < 1e-15));
        let middle = disc.iter().fold(Vector::ZERO, |sum, place| sum + *place) * (1.0 / 64.0);
        assert!(middle.norm() < 0.01 * DISC, "{middle:?}");
        // Each place of a pixel at an edge has its part of all of them.
        for of in [1, 4, 9, 16, 64] {
            let parts = (0..of).map(|number| Part { number, of });
            let rays = parts.map(|part| (0..RAYS).filter(|ray| part.has(*ray)).count());
            let rays: Vec<usize> = rays.collect();
            assert_eq!(rays.iter().sum::<usize>(), RAYS);
            assert!(rays.iter().all(|count| *count == RAYS / of || *count == RAYS / of + 1));
        }
    }
}
