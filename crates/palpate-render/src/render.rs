// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From a subject to a picture: a ray through each pixel, then more through those at edges.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use palpate_field::BLOCK;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::color::Light;
use crate::error::RenderError;
use crate::image::Image;
use crate::paint::{Dab, Painter};
use crate::settings::Settings;
use crate::studio::Studio;
use crate::subject::Subject;
use crate::trace::Work;

/// The side of a tile [pixels]: a tile is a block, and its rays go alike.
const TILE: u32 = 8;

/// Pixels at edges that a thread takes at a time.
const PART: usize = 64;

/// Neighbouring pixels make an edge if a channel differs by this share of its range.
const CONTRAST: f64 = 0.035;

/// A picture, and what was done for it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rendering {
    /// The picture.
    pub image: Image,
    /// A ray meets a surface where the field is at most this [m].
    pub gap: f64,
    /// The radius with which curves and sheets without interior are drawn [m].
    pub thin: f64,
    /// The distance between the isolines of a cut face [m].
    pub spacing: f64,
    /// Rays of sight. The pixels of those that are undecided have the colour
    /// [`SrgbColor::UNDECIDED`](crate::SrgbColor::UNDECIDED), or a share of it.
    pub sight: Work,
    /// Rays to the key light. Those that are undecided count as blocked.
    pub light: Work,
}

/// Renders a picture. The bits do not depend on the number of threads.
///
/// Again and again, a thread calls `watch` with the share of the work that is done; if it returns
/// `false`, the rendering ends without a picture.
///
/// # Errors
///
/// If a setting is out of range, the camera is inside a body, or a body cannot be cut.
pub fn render(
    subject: &Subject,
    camera: &Camera,
    settings: &Settings,
    watch: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Option<Rendering>, RenderError> {
    let studio = Studio::new(subject, camera, settings)?;
    let work = Mutex::new([Work::default(); 2]);
    let first = Stage { studio: &studio, watch, from: 0.0, work: &work };
    let Some(mut film) = first.exposed() else { return Ok(None) };
    if settings.samples > 1 {
        let edges = film.edges();
        let second = Stage { from: 0.5, ..first };
        let Some(lights) = second.refined(&edges) else { return Ok(None) };
        for (edge, light) in edges.into_iter().zip(lights) {
            film.dabs[edge].light = light;
        }
    }
    let pixels = film.dabs.iter().map(|dab| dab.light.color()).collect();
    let [sight, light] = work.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(Some(Rendering {
        image: Image::new(settings.width, pixels),
        gap: studio.surfaces.gap,
        thin: studio.thin,
        spacing: studio.spacing,
        sight,
        light,
    }))
}

/// A half of the work.
struct Stage<'a> {
    studio: &'a Studio,
    watch: &'a (dyn Fn(f64) -> bool + Sync),
    /// The share of the work that is done before.
    from: f64,
    /// Of sight, and to the light.
    work: &'a Mutex<[Work; 2]>,
}

impl Stage<'_> {
    /// Paints parts of the picture on all threads; `None` if the watch ends it.
    fn painted<T: Send>(
        &self,
        parts: usize,
        paint: impl Fn(&mut Painter<'_>, usize) -> T + Sync,
    ) -> Option<Vec<T>> {
        let (ends, done) = (AtomicBool::new(false), AtomicUsize::new(0));
        let part = |painter: &mut Box<Painter<'_>>, part| {
            if ends.load(Ordering::Relaxed) {
                return None;
            }
            let painted = paint(painter, part);
            self.add(painter.take_work());
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            let share = self.from + 0.5 * done as f64 / parts as f64;
            if !(self.watch)(share) {
                ends.store(true, Ordering::Relaxed);
            }
            Some(painted)
        };
        // Not on the stack, on which a thread that waits for others begins more parts.
        let painter = || Painter::boxed(self.studio);
        (0..parts).into_par_iter().map_init(painter, part).collect()
    }

    fn add(&self, work: [Work; 2]) {
        let mut all = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        for (all, work) in all.iter_mut().zip(work) {
            all.add(&work);
        }
    }

    /// A ray through the middle of every pixel.
    fn exposed(&self) -> Option<Film> {
        let Settings { width, height, .. } = self.studio.settings;
        let across = width.div_ceil(TILE);
        let tiles = (across * height.div_ceil(TILE)) as usize;
        let corner =
            |tile: usize| [TILE * (tile as u32 % across), TILE * (tile as u32 / across)];
        let pixels = |tile: usize| {
            let [left, top] = corner(tile);
            let rows = top..(top + TILE).min(height);
            rows.flat_map(move |y| (left..(left + TILE).min(width)).map(move |x| [x, y]))
        };
        let painted = self.painted(tiles, |painter, tile| {
            let middles = pixels(tile).map(|pixel| pixel.map(|x| f64::from(x) + 0.5));
            let mut dabs = Vec::with_capacity(BLOCK);
            painter.paint(&middles.collect::<Vec<_>>(), 1, &mut dabs);
            dabs
        })?;
        let nothing = Dab { light: Light::NONE, is_edge: false };
        let mut film = Film { width, dabs: vec![nothing; (width * height) as usize] };
        for (tile, dabs) in painted.into_iter().enumerate() {
            for ([x, y], dab) in pixels(tile).zip(dabs) {
                film.dabs[(y * width + x) as usize] = dab;
            }
        }
        Some(film)
    }

    /// The mean light of many rays through each of these pixels.
    fn refined(&self, edges: &[usize]) -> Option<Vec<Light>> {
        let Settings { width, samples, .. } = self.studio.settings;
        let offsets = offsets(samples);
        let places = |edge: usize| {
            let corner = [edge as u32 % width, edge as u32 / width].map(f64::from);
            offsets.iter().map(move |[x, y]| [corner[0] + x, corner[1] + y])
        };
        let parts: Vec<&[usize]> = edges.chunks(PART).collect();
        let painted = self.painted(parts.len(), |painter, part| {
            let places: Vec<_> = parts[part].iter().flat_map(|edge| places(*edge)).collect();
            let (mut lights, mut dabs) = (Vec::with_capacity(places.len()), Vec::new());
            // Whole pixels at a time.
            for block in places.chunks(BLOCK / offsets.len() * offsets.len()) {
                painter.paint(block, samples, &mut dabs);
                lights.extend(dabs.iter().map(|dab| dab.light));
            }
            let mean = |lights: &[Light]| {
                let sum = lights.iter().fold(Light::NONE, |sum, light| sum + *light);
                sum * (1.0 / lights.len() as f64)
            };
            lights.chunks(offsets.len()).map(mean).collect::<Vec<_>>()
        })?;
        Some(painted.into_iter().flatten().collect())
    }
}

/// What all pixels show, row by row.
struct Film {
    width: u32,
    dabs: Vec<Dab>,
}

impl Film {
    /// The pixels at edges, in their order: those whose cone a surface may be in that their ray
    /// does not meet, and those that differ from a neighbour.
    fn edges(&self) -> Vec<usize> {
        let width = self.width as usize;
        let colors: Vec<_> = self.dabs.iter().map(|dab| dab.light.encoded()).collect();
        let differ = |a: usize, b: usize| {
            colors[a].iter().zip(&colors[b]).any(|(a, b)| (a - b).abs() > CONTRAST)
        };
        let mut is_edge: Vec<bool> = self.dabs.iter().map(|dab| dab.is_edge).collect();
        for pixel in 0..colors.len() {
            let right = (pixel % width + 1 < width).then_some(pixel + 1);
            let below = (pixel + width < colors.len()).then_some(pixel + width);
            for other in right.into_iter().chain(below).filter(|other| differ(pixel, *other)) {
                (is_edge[pixel], is_edge[other]) = (true, true);
            }
        }
        (0..colors.len()).filter(|pixel| is_edge[*pixel]).collect()
    }
}

/// Places in a pixel, `samples` squared: a grid, sheared so that no two share a row or a column.
fn offsets(samples: u32) -> Vec<[f64; 2]> {
    let side = f64::from(samples);
    let along = |i: u32, j: u32| (f64::from(i) + (f64::from(j) + 0.5) / side) / side;
    let row = |i| (0..samples).map(move |j| [along(i, j), along(j, i)]);
    (0..samples).flat_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_samples_of_a_pixel_share_a_row_or_a_column() {
        let offsets = offsets(4);
        for axis in [0, 1] {
            let mut along: Vec<f64> = offsets.iter().map(|offset| offset[axis]).collect();
            along.sort_by(f64::total_cmp);
            let even: Vec<f64> = (0..16).map(|i| (f64::from(i) + 0.5) / 16.0).collect();
            assert_eq!(along, even);
        }
    }
}
