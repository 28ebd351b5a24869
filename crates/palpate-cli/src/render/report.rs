// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `palpate render` says of its pictures.

use std::fmt;

use palpate::render::Work;
use serde::Serialize;

use super::frames::Drawn;
use super::stage::Stage;
use crate::output::shown;

/// The answer of `palpate render`. Counts of rays are those of all its pictures together.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The files.
    pub(crate) outputs: Vec<String>,
    /// How many pictures there are.
    pub(crate) pictures: u32,
    /// The width of a picture [pixels].
    pub(crate) width: u32,
    /// The height of a picture [pixels].
    pub(crate) height: u32,
    /// The camera of the first picture.
    pub(crate) camera: Camera,
    /// The height of the ground [m]; `null` without one.
    pub(crate) ground: Option<f64>,
    /// A ray meets a surface where the field is at most this [m]; `null` without a picture.
    pub(crate) gap: Option<f64>,
    /// The radius with which curves and sheets without interior are drawn [m].
    pub(crate) thin: Option<f64>,
    /// With `--slice` between isolines [m].
    pub(crate) step: Option<f64>,
    /// With `--contacts` how many pairs touch.
    pub(crate) touching: Option<usize>,
    /// The rays of sight.
    pub(crate) sight: Rays,
    /// The rays to the light.
    pub(crate) light: Rays,
    /// The most evaluations for a ray.
    #[serde(skip)]
    budget: u32,
}

/// Where a picture is taken from.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Camera {
    /// The eye [m].
    pub(crate) from: [f64; 3],
    /// The unit vector in which it looks.
    pub(crate) direction: [f64; 3],
    /// `true` if all rays of sight are parallel.
    pub(crate) is_orthographic: bool,
}

/// How many rays were traced, and what they cost.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Rays {
    /// Rays.
    pub(crate) rays: u64,
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Rays that were cast one by one.
    pub(crate) grazing: u64,
    /// Rays that the budget left undecided.
    pub(crate) undecided: u64,
}

impl From<Work> for Rays {
    fn from(Work { rays, evaluations, grazing, undecided, .. }: Work) -> Self {
        Self { rays, evaluations, grazing, undecided }
    }
}

impl Answer {
    pub(super) fn of(stage: &Stage<'_>, drawn: &Drawn) -> Self {
        let (settings, first) = (&stage.settings, drawn.first.as_ref());
        let [sight, light] = drawn.work.map(Rays::from);
        Self {
            outputs: drawn.files.iter().map(|file| file.display().to_string()).collect(),
            pictures: drawn.pictures,
            width: settings.width,
            height: settings.height,
            camera: Camera {
                from: stage.camera.eye().0,
                direction: (-stage.camera.sight().back()).0,
                is_orthographic: stage.camera.is_orthographic(),
            },
            ground: settings.ground,
            gap: first.map(|first| first.gap),
            thin: first.map(|first| first.thin),
            step: first.filter(|_| settings.cut.is_some()).map(|first| first.spacing),
            touching: stage.touched.as_ref().map(|touched| touched.counts().0),
            sight,
            light,
            budget: settings.budget,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Numbered files have a line each.
        let what = match &self.outputs[..] {
            [] => return Ok(()),
            [file] => shown(file).to_string(),
            files => format!("{} pictures", files.len()),
        };
        let undecided = [self.sight.undecided, self.light.undecided];
        let decided = match undecided {
            [0, 0] => "all decided".to_owned(),
            [sight, light] => format!("{sight} of sight and {light} to the light undecided"),
        };
        writeln!(f, "{what}: {} rays, {decided}", self.sight.rays + self.light.rays)?;
        if undecided != [0; 2] {
            let budget = self.budget;
            let magenta =
                if self.sight.undecided > 0 { "; their pixels are magenta" } else { "" };
            writeln!(f, "  after {budget} evaluations{magenta}; raise --ray-budget")?;
        }
        Ok(())
    }
}
