// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The files that a run leaves: trace, vibration, picture.

use palpate::device::DeviceProfile;
use palpate::scene::BuiltScene;
use palpate::servo_loop::{Recorder, Sink, TraceRow, TraceWriter};
use palpate::vibration::Actuator;

use super::figure::Run;
use super::vibration::{Played, Vibration};
use crate::feel::{DeviceChoice, FeelOptions};
use crate::outcome::Failure;
use crate::output::{self, Destination, Files};
use crate::picture::{Dimensions, Drawable, Picture};

/// The requested files.
pub(super) struct Outputs {
    trace: Option<Destination>,
    wav: Option<Destination>,
    plot: Option<Picture>,
    /// What plays the vibration, if the command line says so.
    actuator: Option<Actuator>,
}

/// The rows of the trace, if one was written, or why it could not be.
pub(super) struct Traced(Result<Option<u64>, Failure>);

/// What else files tell of a run.
pub(super) struct Ran<'a> {
    /// Ticks a second [Hz].
    pub(super) rate: f64,
    pub(super) title: &'a str,
    pub(super) device: &'a DeviceProfile,
    /// The stiffness of each body as the device renders it [N/m].
    pub(super) rendered: Vec<f64>,
}

impl Ran<'_> {
    fn has_forces(&self) -> bool {
        self.device.max_force > 0.0
    }
}

impl Outputs {
    /// Checks that all of them can be written.
    pub(super) fn of(options: &FeelOptions) -> Result<Self, Failure> {
        let inputs = [&options.scene, &options.path].into_iter().filter_map(Option::as_deref);
        let device = options.device.as_ref().and_then(DeviceChoice::file);
        let mut files = Files::reading(inputs.chain(device), options.reading);
        Ok(Self {
            trace: options
                .trace
                .as_deref()
                .map(|path| files.output_as(path, "a trace", "csv"))
                .transpose()?,
            wav: options
                .wav
                .as_deref()
                .map(|path| files.output_as(path, "a vibration", "wav"))
                .transpose()?,
            plot: options
                .plot
                .as_deref()
                .map(|path| Picture::new(&mut files, path))
                .transpose()?,
            actuator: options.actuator.clone(),
        })
    }

    /// `true` if any file needs the ticks after the run.
    pub(super) fn keep_ticks(&self) -> bool {
        self.wav.is_some() || self.plot.is_some()
    }

    /// Calls `run` with a sink that writes the trace meanwhile, if one is requested. The trace is
    /// whole even if a device was lost or the run was interrupted.
    pub(super) fn traced<T, const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        run: impl FnOnce(Option<Sink<'_>>) -> Result<T, Failure>,
    ) -> Result<(T, Traced), Failure> {
        let Some(to) = &self.trace else { return Ok((run(None)?, Traced(Ok(None)))) };
        let mut ran = None;
        let written = to.write(|out| {
            let pose_at = |body, time| scene.pose_at(body, time).in_space();
            let mut trace = TraceWriter::new(out).with_poses(scene.moving(), pose_at);
            if D == 2 {
                trace = trace.in_plane();
            }
            let mut written = Ok(());
            let mut sink = |row: &TraceRow| {
                if written.is_ok() {
                    written = trace.write(row);
                }
            };
            ran = Some(run(Some(&mut sink))?);
            written?;
            let rows = trace.rows();
            trace.finish()?;
            Ok(rows)
        });
        match (ran, written) {
            (Some(ran), written) => Ok((ran, Traced(written.map(Some)))),
            (None, Err(failure)) => Err(failure),
            (None, Ok(_)) => unreachable!("a trace is written by a run"),
        }
    }

    /// Writes the other files from the ticks, and says which were written; if one fails, the
    /// others are still written. Returns what actuators played, if that was written.
    pub(super) fn write<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        recorder: &Recorder,
        traced: Traced,
        ran: &Ran<'_>,
    ) -> (Result<(), Failure>, Option<Played>)
    where
        Dimensions: Drawable<D>,
    {
        let vibrates = self.wav.is_some() || self.plot.is_some() && !ran.has_forces();
        let of_tool = || scene.tool.as_ref().and_then(|tool| tool.actuator.clone());
        let actuator = self.actuator.clone().or_else(of_tool);
        let vibration = vibrates.then(|| Vibration::of(scene, recorder, ran.rate, actuator));
        let vibration = match vibration.transpose() {
            Ok(vibration) => vibration,
            Err(failure) => return (Err(failure), None),
        };
        let (mut played, mut wav) = (None, None);
        if let (Some(to), Some(vibration)) = (&self.wav, &vibration) {
            let written = vibration.write(to).map(|of_file| played = Some(of_file));
            wav = Some((to.name(), written));
        }
        let (rows, traced) = match traced.0 {
            Ok(rows) => (rows, Ok(())),
            Err(failure) => (None, Err(failure)),
        };
        let trace = self.trace.iter().map(Destination::name).zip([traced]);
        let shown_vibration = vibration.as_ref().filter(|_| !ran.has_forces());
        let run = Run {
            scene,
            recorder,
            title: ran.title,
            rendered: &ran.rendered,
            device: ran.device,
            vibration: shown_vibration,
        };
        let plot = self.plot.iter().map(|to| (to.path(), run.draw(to)));
        let written: Vec<_> = trace.chain(wav).chain(plot).collect();
        let said = written.iter().filter(|(_, written)| written.is_ok()).map(|(path, _)| {
            let rows = rows.filter(|_| {
                let mut trace = self.trace.iter();
                trace.any(|trace| trace.name() == *path)
            });
            let rows = rows.map_or(String::new(), |rows| format!(" ({rows} rows)"));
            format!("{}{rows}", path.display())
        });
        let said: Vec<_> = said.collect();
        if !said.is_empty() {
            output::remark(format_args!("wrote {}", said.join(", ")));
        }
        (Failure::any(written.into_iter().map(|(_, written)| written)), played)
    }
}
