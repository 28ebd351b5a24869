// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The vibration of a run, for fingers without force feedback.

use std::io::Cursor;

use palpate::field::Point;
use palpate::scene::BuiltScene;
use palpate::servo_loop::{Recorder, TraceRow};
use palpate::vibration::{
    Cue, Mapping, MappingOptions, Sensation, Synthesiser, Tap, Tones, Voice, write_wav,
};

use crate::outcome::Failure;
use crate::output::Destination;

/// The sample rate [Hz]; the skin feels nothing above 1 kHz.
const SAMPLE_RATE: u32 = 8000;

/// What the contact points of a run feel, each by an actuator of its own.
pub(super) struct Vibration {
    mapping: Mapping,
    /// The time of each tick [s].
    times: Vec<f64>,
    /// The sensations of each contact point in all ticks.
    points: Vec<Vec<Sensation>>,
    /// Ticks a second [Hz].
    rate: f64,
}

impl Vibration {
    /// The vibration of a run at `rate` [Hz].
    pub(super) fn of<const D: usize>(
        scene: &BuiltScene<D>,
        recorder: &Recorder<D>,
        rate: f64,
    ) -> Result<Self, Failure> {
        let rows = recorder.rows();
        let count = rows.iter().map(|row| row.point).max().map_or(0, |last| last as usize + 1);
        let mapping = Mapping::new(MappingOptions::default()).map_err(Failure::input)?;
        let felt = |point: usize| {
            let of_point = rows.iter().skip(point).step_by(count.max(1));
            let mut last: Option<&TraceRow<D>> = None;
            let sensations = of_point.map(|row| {
                let cue = cue(scene, row, last, rate);
                last = Some(row);
                mapping.feel(&cue)
            });
            sensations.collect()
        };
        let times = rows.iter().step_by(count.max(1)).map(|row| row.time_s).collect();
        Ok(Self { mapping, times, points: (0..count).map(felt).collect(), rate })
    }

    /// What the actuator of each contact point plays in all ticks.
    pub(super) fn tones(&self) -> Result<Vec<Vec<Tones>>, Failure> {
        let of_point = |sensations: &Vec<Sensation>| {
            let mut voice = Voice::new(self.rate).map_err(Failure::input)?;
            Ok(sensations.iter().map(|sensation| voice.step(sensation)).collect())
        };
        self.points.iter().map(of_point).collect()
    }

    /// The times of the ticks [s].
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// Writes a WAV file with a channel for each contact point.
    pub(super) fn write(&self, destination: &Destination) -> Result<(), Failure> {
        let channels = self.points.iter().map(|sensations| self.samples(sensations));
        let channels = channels.collect::<Result<Vec<_>, _>>()?;
        let length = channels.first().map_or(0, Vec::len);
        let turns = (0..length).flat_map(|i| channels.iter().map(move |samples| samples[i]));
        let count = u16::try_from(channels.len().max(1)).map_err(Failure::input)?;
        // The header holds the length and comes first, so the WAV is complete before it is
        // written.
        let mut wav = Cursor::new(Vec::new());
        write_wav(&mut wav, SAMPLE_RATE, count, turns).map_err(Failure::input)?;
        destination.write(|out| Ok(out.write_all(wav.get_ref())?))
    }

    /// The samples of a contact point.
    fn samples(&self, sensations: &[Sensation]) -> Result<Vec<f32>, Failure> {
        let mut synthesiser = Synthesiser::new(&self.mapping, f64::from(SAMPLE_RATE), 1)
            .map_err(Failure::input)?;
        let mut samples = Vec::new();
        for (time, sensation) in self.times.iter().zip(sensations) {
            // All samples until the end of the tick, for rates that do not divide the sample
            // rate.
            let end = ((time + 1.0 / self.rate) * f64::from(SAMPLE_RATE)).round() as usize;
            let start = samples.len();
            samples.resize(end.max(start), 0.0);
            synthesiser.render(&[*sensation], &mut samples[start..]);
        }
        Ok(samples)
    }
}

/// Where a body takes a point between two times [s].
fn carried<const D: usize>(
    scene: &BuiltScene<D>,
    body: usize,
    times: [f64; 2],
    point: Point<D>,
) -> Point<D> {
    let [before, after] = times.map(|time| scene.pose_at(body, time));
    if before == after {
        return point;
    }
    after.transform_point(before.inverse().transform_point(point))
}

/// The cue of a contact point in a tick, which is felt relative to the body.
fn cue<const D: usize>(
    scene: &BuiltScene<D>,
    row: &TraceRow<D>,
    last: Option<&TraceRow<D>>,
    rate: f64,
) -> Cue {
    let Some(body) = scene.bodies.get(row.body as usize).filter(|_| row.contact) else {
        return Cue::default();
    };
    let velocity = last.map_or(row.device * 0.0, |last| {
        let carried = carried(scene, row.body as usize, [last.time_s, row.time_s], last.device);
        (row.device - carried) * rate
    });
    let outward = velocity.dot(row.normal);
    Cue {
        depth: (row.proxy - row.device).norm(),
        normal_force: row.wanted.dot(row.normal),
        normal_speed: -outward,
        slide_speed: (velocity - row.normal * outward).norm(),
        wavelength: body.material.texture.as_ref().map(|texture| texture.wavelength),
        impact: body.material.impact.as_ref().map(Tap::from),
        began: last.is_some_and(|last| !last.contact),
    }
}
