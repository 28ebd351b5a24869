// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lit pictures.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use palpate_field::{BLOCK, ShapeError};
use palpate_query::QueryError;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::image::{Image, Light};
use crate::paint::{Dab, Painter};
use crate::subject::{Cut, Studio, Subject};
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

/// The most pixels of a picture: their light fills a gigabyte of memory.
pub(crate) const MOST_PIXELS: u64 = 40_000_000;

/// The most samples along a pixel's side: those of a pixel are painted together, so they must fit
/// into a block of 64.
pub(crate) const MOST_SAMPLES: u32 = 8;

/// The shadows of the key light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadows {
    /// None.
    None,
    /// Of a light as small as a point.
    Hard,
    /// Of a disc of 6°.
    Soft,
}

/// How a picture is rendered.
///
/// ```
/// use palpate_render::{Settings, Shadows};
///
/// let settings = Settings {
///     shadows: Shadows::Hard,
///     ground: Some(0.0),
///     ..Settings::new(320, 240)
/// };
/// assert_eq!((settings.width, settings.ground), (320, Some(0.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The width [pixels].
    pub width: u32,
    /// The height [pixels].
    pub height: u32,
    /// Samples along the side of a pixel at an edge.
    pub samples: u32,
    /// The shadows.
    pub shadows: Shadows,
    /// The height of a level ground on which shadows fall [m]; none if left out.
    pub ground: Option<f64>,
    /// A plane that cuts bodies.
    pub cut: Option<Cut>,
    /// The distance between the isolines of a cut face [m]; chosen if left out.
    pub spacing: Option<f64>,
    /// The most evaluations for each ray.
    pub budget: u32,
}

impl Settings {
    /// The budget unless another is given: hundreds of times what a grazing ray needs.
    pub const BUDGET: u32 = 50_000;

    /// A picture of this size [pixels], with soft shadows and edges of 4 × 4 samples, without
    /// ground.
    #[must_use]
    pub const fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            samples: 4,
            shadows: Shadows::Soft,
            ground: None,
            cut: None,
            spacing: None,
            budget: Self::BUDGET,
        }
    }

    /// Refuses what cannot be rendered, as [`render`](crate::render) does.
    ///
    /// # Errors
    ///
    /// If the picture has no pixels or too many, the samples are not from 1 to 8, the spacing is
    /// not positive, or the ground not finite.
    pub fn check(&self) -> Result<(), RenderError> {
        let Self { width, height, samples, .. } = *self;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MOST_PIXELS {
            return Err(RenderError::Size { width, height });
        }
        if samples == 0 || samples > MOST_SAMPLES {
            return Err(RenderError::Samples { samples });
        }
        if let Some(spacing) = self.spacing {
            RenderError::check_positive("the spacing of isolines", spacing, " m")?;
        }
        match self.ground {
            Some(value) if !value.is_finite() => {
                let (what, rule) = ("the height of the ground", "finite");
                Err(RenderError::Number { what, rule, value, unit: " m" })
            }
            _ => Ok(()),
        }
    }
}

/// Why a picture cannot be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// There is nothing to draw.
    #[error("a picture must show at least 1 body, got 0")]
    NoBody,
    /// A number breaks its rule.
    #[error("{what} must be {rule}, got {value:?}{unit}")]
    Number {
        /// What the number was for.
        what: &'static str,
        /// The rule.
        rule: &'static str,
        /// The number.
        value: f64,
        /// A space and the symbol of the unit; empty for a plain number.
        unit: &'static str,
    },
    /// A camera that looks from a point at the same point.
    #[error("a camera must look at another point than its own, got {at:?} m for both")]
    NoSight {
        /// The point [m].
        at: [f64; 3],
    },
    /// A direction that has no length, or two that lie on one line.
    #[error("{what} must have a direction, got {got:?}")]
    NoPlane {
        /// What the direction was for.
        what: &'static str,
        /// The direction.
        got: [f64; 3],
    },
    /// A camera within a body, which sees nothing else.
    #[error("the camera at {from:?} m is inside body {body}: move it out")]
    Inside {
        /// The number of the body.
        body: usize,
        /// Where the camera is [m].
        from: [f64; 3],
    },
    /// A picture without pixels, or with too many.
    #[error("a picture must have 1 to {MOST_PIXELS} pixels, got {width} x {height}")]
    Size {
        /// The width [pixels].
        width: u32,
        /// The height [pixels].
        height: u32,
    },
    /// Too few or too many samples.
    #[error(
        "an edge must have 1 to {MOST_SAMPLES} samples along a pixel's side, got {samples}"
    )]
    Samples {
        /// The number that was asked for.
        samples: u32,
    },
    /// An animation without pictures.
    #[error("an animation must have at least 1 picture, got 0")]
    NoPicture,
    /// Pictures of an animation that differ in size.
    #[error(
        "the pictures of an animation must be alike in size, got {} x {} and {} x {} pixels",
        first[0], first[1], other[0], other[1]
    )]
    OtherSize {
        /// The size of the first [pixels].
        first: [u32; 2],
        /// The size of another [pixels].
        other: [u32; 2],
    },
    /// A body cannot be cut or thickened.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A point or length cannot be computed with.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A picture cannot be written as PNG.
    #[error("the picture cannot be written as PNG: {reason}")]
    Png {
        /// What the encoder said.
        reason: String,
    },
}

impl RenderError {
    /// Refuses a number that is not more than zero, or too large to compute with.
    pub(crate) fn check_positive(
        what: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<f64, Self> {
        let rule = "positive and at most 1e15";
        // Written so that NaN is refused.
        if value > 0.0 && value <= palpate_field::LARGEST_LENGTH {
            Ok(value)
        } else {
            Err(Self::Number { what, rule, value, unit })
        }
    }
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
