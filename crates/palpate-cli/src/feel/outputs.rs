// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The files that a run leaves: trace, vibration, picture.

use palpate::scene::BuiltScene;
use palpate::servo_loop::Recorder;

use super::{figure, vibration};
use crate::arguments::FeelOptions;
use crate::outcome::Failure;
use crate::output::{Destination, Files};
use crate::picture::{Dimensions, Drawable, Picture};
use crate::trace;

/// The requested files.
pub(super) struct Outputs {
    trace: Option<Destination>,
    wav: Option<Destination>,
    plot: Option<Picture>,
}

impl Outputs {
    /// Checks that all of them can be written.
    pub(super) fn of(options: &FeelOptions) -> Result<Self, Failure> {
        let inputs = [&options.scene, &options.path];
        let mut files = Files::reading(inputs.into_iter().filter_map(Option::as_deref));
        Ok(Self {
            trace: options.trace.as_deref().map(|path| files.output(path)).transpose()?,
            wav: options.wav.as_deref().map(|path| files.output(path)).transpose()?,
            plot: options
                .plot
                .as_deref()
                .map(|path| Picture::new(&mut files, path))
                .transpose()?,
        })
    }

    /// `true` if any file needs the recorded ticks.
    pub(super) fn keep_ticks(&self) -> bool {
        self.trace.is_some() || self.wav.is_some() || self.plot.is_some()
    }

    /// Writes all files from the ticks at `rate` [Hz]; if one fails, the others are still
    /// written.
    pub(super) fn write<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        recorder: &Recorder<D>,
        rate: f64,
        title: &str,
    ) -> Result<(), Failure>
    where
        Dimensions: Drawable<D>,
    {
        let trace =
            self.trace.iter().map(|to| to.write(|out| trace::write(scene, recorder, out)));
        let wav = self.wav.iter().map(|to| vibration::write(scene, recorder, rate, to));
        let plot = self.plot.iter().map(|to| figure::draw(scene, recorder, title, to));
        Failure::any(trace.chain(wav).chain(plot))
    }
}
