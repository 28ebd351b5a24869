// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All that a picture is made of, set up before its first ray.

use palpate_field::Vector;

use crate::beam::Beam;
use crate::camera::Camera;
use crate::color::{Light, SrgbColor};
use crate::error::RenderError;
use crate::light::key_direction;
use crate::settings::Settings;
use crate::subject::Subject;
use crate::surfaces::{Surface, Surfaces};
use crate::trace::Tracer;

/// How near a field must come to zero to be a surface, in pixels.
const GAP: f64 = 1.0 / 32.0;

/// The radius of curves and sheets without interior, in pixels: thinner ones would pass between
/// the middles of pixels.
const THIN: f64 = 0.6;

/// How far the sky is looked for, as a share of the scene's size.
const REACH: f64 = 0.16;

/// The distance between isolines on a cut face, as a share of the scene's size, before it is
/// rounded.
const SPACING: f64 = 0.025;

/// All that a picture is made of.
#[derive(Debug)]
pub(crate) struct Studio {
    pub(crate) surfaces: Surfaces,
    pub(crate) camera: Camera,
    pub(crate) settings: Settings,
    /// The unit vector towards the key light.
    pub(crate) key: Vector<f64, 3>,
    pub(crate) background: Light,
    /// How far the sky is looked for [m].
    pub(crate) reach: f64,
    /// Between the isolines on a cut face [m].
    pub(crate) spacing: f64,
    /// The radius of curves and sheets [m].
    pub(crate) thin: f64,
}

impl Studio {
    pub(crate) fn new(
        subject: &Subject,
        camera: &Camera,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        settings.check()?;
        let pixel = camera.pixel(settings.height);
        let (gap, thin) = (GAP * pixel, THIN * pixel);
        let surfaces = Surfaces::new(subject, settings.cut, gap, thin)?;
        let size = 2.0 * subject.bounds().half_extents().norm();
        let studio = Self {
            surfaces,
            camera: *camera,
            settings: *settings,
            key: key_direction(camera.sight()),
            background: SrgbColor::BACKGROUND.light(),
            reach: REACH * size,
            spacing: settings.spacing.unwrap_or_else(|| round(SPACING * size)),
            thin,
        };
        studio.check_eye()?;
        Ok(studio)
    }

    /// The part of a beam in which there may be surfaces, its cone included.
    pub(crate) fn cut(&self, beam: &Beam) -> Beam {
        let extent = &self.surfaces.extent;
        extent.cut(beam, beam.radius(extent.farthest(beam.origin)))
    }

    /// For rays through its surfaces.
    pub(crate) fn tracer(&self) -> Tracer<'_> {
        Tracer::new(&self.surfaces, self.settings.budget)
    }

    /// Refuses a camera within a body.
    fn check_eye(&self) -> Result<(), RenderError> {
        let eye = self.camera.eye();
        if self.camera.is_orthographic() {
            return Ok(());
        }
        let is_inside = |surface: &Surface| surface.distance(eye) <= 0.0;
        match self.surfaces.bodies.iter().position(is_inside) {
            None => Ok(()),
            Some(body) => Err(RenderError::Inside { body, from: eye.0 }),
        }
    }
}

/// The nearest number of 1, 2 or 5 times a power of ten that is not less.
fn round(length: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(length)));
    let steps = [1.0, 2.0, 5.0, 10.0];
    let step = steps.into_iter().find(|step| step * power >= length * (1.0 - 1e-12));
    step.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn spacings_are_round() {
        assert_eq!([0.0013, 0.02, 0.021, 7.0].map(round), [0.002, 0.02, 0.05, 10.0]);
    }
}
