// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Light, shadows and sky.
//!
//! The lights of a picture, and what a surface sends back of them.
//!
//! One key light, far away, from above and the viewer's left; a fill from the whole sky, less from
//! below; a faint light at the camera. A surface is matt (Lambert) with a weak gloss (Blinn 1977).
//! Light is added as light, and written as sRGB without any other curve.
//!
//! How much of the key light a place sees.
//!
//! A soft light is a disc. Where the cone from the place to the disc is proven free, the place is
//! lit. Elsewhere rays are cast to 64 places of the disc, spread as seeds of a sunflower (Vogel
//! 1979), each with its proof, and the free ones are counted. Where the 16 rays to the rim are all
//! blocked, or all free, the others are taken for the same. The places of a pixel at an edge share
//! the 64 rays. A hard light is the middle of the disc.
//!
//! How much of the sky a place sees: ambient occlusion.
//!
//! At the height h over a place without anything near, the field is h. The openness is one minus
//! the mean of `1 − f/h` over heights from near to far (Evans 2006, "Fast Approximations for
//! Global Illumination on Dynamic Scenes"), scaled so that a place without any sky keeps the share
//! [`LEAST`]. It is an estimate: bodies that are near count wherever they are, and where a field
//! is less than the distance, the place is drawn darker.

use std::f64::consts::TAU;
use std::ops::Range;

use palpate_field::{BLOCK, Block, Column, Point, Vector};

use crate::beam::Beam;
use crate::camera::Sight;
use crate::image::Light;
use crate::render::Shadows;
use crate::subject::Studio;
use crate::trace::{End, Goal, Met, Tracer};

/// The amounts of light that a white surface sends back: of the key light where it faces that, of
/// the fill where it faces up and nothing is near, of the light at the camera where it faces that.
/// Together they are little more than one, so that few places are brighter than a file holds.
const KEY: f64 = 0.70;
const FILL: f64 = 0.36;
const AT_CAMERA: f64 = 0.10;

/// The fill that a surface facing down gets, as a share of that facing up.
const FROM_BELOW: f64 = 0.45;

/// The gloss: its amount, and how narrow it is.
const GLOSS: f64 = 0.10;
const NARROWNESS: f64 = 36.0;

/// A place that light falls on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    /// The unit normal.
    pub(crate) normal: Vector<f64, 3>,
    /// The unit vector towards the viewer.
    pub(crate) view: Vector<f64, 3>,
    /// The visible share of the key light.
    pub(crate) key: f64,
    /// The open share of the sky.
    pub(crate) open: f64,
}

/// The unit vector towards the key light: from above, in front and left of what the viewer sees,
/// whether from the side or from above.
pub(crate) fn key_direction(sight: &Sight) -> Vector<f64, 3> {
    let (right, back) = (sight.right(), sight.back());
    let y = Vector::unit(1);
    let level = (back - y * back[1]).normalized().unwrap_or(-sight.up());
    // Seen from below, the light is below too.
    let above = if back[1] < -0.5 { -y } else { y };
    let direction = above * 1.0 + level * 0.62 - right * 0.62;
    direction.normalized().unwrap_or(y)
}

impl Lit {
    /// The light that a surface of this colour sends to the viewer.
    pub(crate) fn sent(&self, color: Light, towards_key: Vector<f64, 3>) -> Light {
        let Self { normal, view, key, open } = *self;
        let halfway = (towards_key + view).normalized().unwrap_or(normal);
        let gloss = libm::pow(normal.dot(halfway).max(0.0), NARROWNESS);
        color * self.matt(towards_key) + Light::white(GLOSS * key * gloss * open)
    }

    /// The same as a share of what a white surface sends at most.
    fn matt(&self, towards_key: Vector<f64, 3>) -> f64 {
        let Self { normal, view, key, open } = *self;
        let sky = FROM_BELOW + (1.0 - FROM_BELOW) * 0.5 * (1.0 + normal[1]);
        KEY * key * normal.dot(towards_key).max(0.0)
            + open * (FILL * sky + AT_CAMERA * normal.dot(view).max(0.0))
    }

    /// The share of light on a place, compared with the same place without any body near.
    pub(crate) fn share(&self, towards_key: Vector<f64, 3>) -> f64 {
        let free = Self { key: 1.0, open: 1.0, ..*self };
        self.matt(towards_key) / free.matt(towards_key)
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_without_bodies_near_has_all_its_light() {
        let normal = Vector::unit(1);
        let key = Vector([0.6, 0.8, 0.0]);
        let lit = Lit { normal, view: normal, key: 1.0, open: 1.0 };
        assert_eq!(lit.share(key), 1.0);
        let dark = Lit { key: 0.0, ..lit };
        assert!((dark.share(key) - 0.46 / (0.46 + 0.8 * 0.7)).abs() < 1e-15);
    }

    #[test]
    fn the_key_light_is_above_and_to_the_left() {
        for elevation in [-0.3, 0.0, 0.7, 1.5, std::f64::consts::FRAC_PI_2] {
            let sight = Sight::from_angles(0.4, elevation).unwrap();
            let key = key_direction(&sight);
            assert!(key[1] > 0.5 && key.dot(sight.right()) < -0.4, "{elevation} {key:?}");
            assert!(key.dot(sight.back()) > 0.2, "{elevation} {key:?}");
        }
    }
}

#[cfg(test)]
mod shadow_tests {
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
