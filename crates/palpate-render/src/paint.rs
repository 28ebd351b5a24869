// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From places of a picture to light.

use palpate_field::{BLOCK, Block, Gradients, Point, Vector};

use crate::beam::{Beam, Extent};
use crate::image::{Light, SrgbColor};
use crate::light::{Lit, Part, Place, Shadow, Sky};
use crate::subject::{self, Owners, Studio};
use crate::trace::{End, Goal, Met, Tracer, Work};

/// Where bodies without bounds begin to fade, and are gone, as shares of how far they are drawn.
const FADE: [f64; 2] = [0.25, 0.85];

/// What a place of a picture shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dab {
    pub(crate) light: Light,
    /// `true` if a surface that the ray does not meet may be in the place's cone.
    pub(crate) is_edge: bool,
}

/// What a ray of sight meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Matter {
    LitBody(usize),
    CutFace(usize),
    Ground,
}

/// A place that is seen.
#[derive(Clone, Copy, Debug)]
struct Spot {
    /// The number of its ray.
    ray: usize,
    matter: Matter,
    place: Place,
    /// The unit vector towards the viewer.
    view: Vector<f64, 3>,
    /// The size of a pixel on a body there [m].
    pixel: f64,
}

/// Paints blocks of places, with memory of its own.
#[derive(Debug)]
pub(crate) struct Painter<'a> {
    studio: &'a Studio,
    tracer: Tracer<'a>,
    shadow: Shadow<'a>,
    sky: Sky<'a>,
    owners: Owners,
    beams: Vec<Beam>,
    met: Vec<Met>,
    points: Vec<Point<3>>,
    block: Block<f64, 3, BLOCK>,
    slopes: Gradients<f64, 3, BLOCK>,
    spots: Vec<Spot>,
    places: Vec<Place>,
    keys: Vec<f64>,
    skies: Vec<f64>,
    /// Places along the side of a pixel.
    samples: u32,
}

impl<'a> Painter<'a> {
    /// A painter on the heap; a function of its own, so that no caller's frame has room for one.
    #[inline(never)]
    pub(crate) fn boxed(studio: &'a Studio) -> Box<Self> {
        Box::new(Self::new(studio))
    }

    fn new(studio: &'a Studio) -> Self {
        Self {
            studio,
            tracer: studio.tracer(),
            shadow: Shadow::new(studio),
            sky: Sky::new(studio),
            owners: Owners::new(),
            beams: Vec::with_capacity(BLOCK),
            met: Vec::with_capacity(BLOCK),
            points: Vec::with_capacity(BLOCK),
            block: Block::zero(),
            slopes: Gradients::zero(),
            spots: Vec::with_capacity(BLOCK),
            places: Vec::with_capacity(BLOCK),
            keys: Vec::with_capacity(BLOCK),
            skies: Vec::with_capacity(BLOCK),
            samples: 1,
        }
    }

    /// What was done since the last call: for rays of sight, and to the light.
    pub(crate) fn take_work(&mut self) -> [Work; 2] {
        [&mut self.tracer, &mut self.shadow.tracer]
            .map(|tracer| std::mem::take(&mut tracer.work))
    }

    /// Puts what at most [`BLOCK`] places of the picture [pixels] show into `dabs`: `samples` by
    /// `samples` of a pixel, one pixel after the other.
    pub(crate) fn paint(&mut self, places: &[[f64; 2]], samples: u32, dabs: &mut Vec<Dab>) {
        self.samples = samples;
        let side = 1.0 / f64::from(samples);
        let Studio { camera, settings, background, .. } = self.studio;
        let size = [settings.width, settings.height];
        let beam =
            |place: &[f64; 2]| self.studio.cut(&camera.beam(*place, size).narrowed(side));
        self.beams.clear();
        self.beams.extend(places.iter().map(beam));
        self.tracer.aim(&self.beams);
        self.tracer.trace(Goal::First, &self.beams, &mut self.met);
        dabs.clear();
        dabs.extend(self.met.iter().map(|met| Dab {
            light: if met.end == End::Undecided {
                SrgbColor::UNDECIDED.light()
            } else {
                *background
            },
            is_edge: met.is_beside,
        }));
        self.spots.clear();
        self.find_bodies();
        self.find_ground();
        self.light(dabs);
    }

    /// Finds the bodies that rays meet, and their normals.
    fn find_bodies(&mut self) {
        let Self { studio, beams, met, points, owners, block, slopes, spots, samples, .. } =
            self;
        let is_seen = |(ray, met): (usize, &Met)| (met.end == End::Surface).then_some(ray);
        let rays: Vec<usize> = met.iter().enumerate().filter_map(is_seen).collect();
        if rays.is_empty() {
            return;
        }
        points.clear();
        points.extend(rays.iter().map(|ray| beams[*ray].at(met[*ray].distance)));
        owners.find(&studio.surfaces, points);
        block.fill(points.len(), |i| points[i]);
        let surfaces = &studio.surfaces;
        let near = surfaces.around(points, surfaces.gap);
        near.as_ref().unwrap_or(&surfaces.whole).block_gradients(block, points.len(), slopes);
        for (i, (ray, point)) in rays.into_iter().zip(&*points).enumerate() {
            let body = owners.bodies[i];
            let matter = if studio.surfaces.is_cut_face(body, *point) {
                Matter::CutFace(body)
            } else {
                Matter::LitBody(body)
            };
            let view = -beams[ray].direction;
            // Where a field is flat, as between two bodies, no direction is right.
            let normal = slopes.gradient.get(i).normalized().unwrap_or(view);
            let place = Place { point: *point, normal, part: Part::of_ray(ray, *samples) };
            let pixel = beams[ray].side(met[ray].distance) * f64::from(*samples);
            spots.push(Spot { ray, matter, place, view, pixel });
        }
    }

    /// Finds where rays meet the ground before any body.
    fn find_ground(&mut self) {
        let Some(height) = self.studio.settings.ground else { return };
        for (ray, (beam, met)) in self.beams.iter().zip(&self.met).enumerate() {
            let distance = (height - beam.origin[1]) / beam.direction[1];
            let is_first = met.end == End::Free || distance < met.distance;
            let is_in_front = distance > 0.0 || self.studio.camera.is_orthographic();
            if !(beam.direction[1] < 0.0 && is_first && is_in_front && distance.is_finite()) {
                continue;
            }
            self.spots.retain(|spot| spot.ray != ray);
            let (normal, part) = (Vector::unit(1), Part::of_ray(ray, self.samples));
            let place = Place { point: beam.at(distance), normal, part };
            let (matter, view) = (Matter::Ground, -beam.direction);
            self.spots.push(Spot { ray, matter, place, view, pixel: 0.0 });
        }
    }

    /// Puts the light of all spots into `dabs`.
    fn light(&mut self, dabs: &mut [Dab]) {
        let Self { studio, shadow, sky, spots, places, keys, skies, .. } = self;
        places.clear();
        places.extend(spots.iter().map(|spot| spot.place));
        shadow.of_key(places, keys);
        sky.open(places, skies);
        for ((spot, key), open) in spots.iter().zip(&*keys).zip(&*skies) {
            let lit =
                Lit { normal: spot.place.normal, view: spot.view, key: *key, open: *open };
            dabs[spot.ray].light = studio.faded(spot.place.point, studio.light(spot, &lit));
        }
    }
}

impl Studio {
    /// The light that a spot sends to the viewer.
    fn light(&self, spot: &Spot, lit: &Lit) -> Light {
        match spot.matter {
            Matter::LitBody(body) => lit.sent(self.surfaces.bodies[body].light, self.key),
            Matter::CutFace(body) => {
                let body = &self.surfaces.bodies[body];
                let (depth, slope) = body.uncut.distance_gradient(spot.place.point);
                let across = slope - spot.place.normal * slope.dot(spot.place.normal);
                let width = spot.pixel * across.norm();
                subject::light(body.light, depth / self.spacing, width / self.spacing)
            }
            Matter::Ground => self.background * lit.share(self.key),
        }
    }

    /// The light of a surface, which fades far away if bodies have no bounds.
    fn faded(&self, point: Point<3>, light: Light) -> Light {
        let Extent::Ball(ball) = &self.surfaces.extent else { return light };
        let far = (point - ball.centre).norm() / ball.radius;
        let share = ((far - FADE[0]) / (FADE[1] - FADE[0])).clamp(0.0, 1.0);
        light.mixed(self.background, share * share * (3.0 - 2.0 * share))
    }
}
