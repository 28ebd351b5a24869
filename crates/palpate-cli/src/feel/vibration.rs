// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The vibration of a run, for fingers without force feedback.

use std::fmt::Write;
use std::io::Cursor;

use palpate::field::Point;
use palpate::scene::BuiltScene;
use palpate::servo_loop::{Recorder, TraceRow};
use palpate::vibration::{
    Actuator, ActuatorModel, Cue, Limiting, Mapping, MappingOptions, Sensation, Synthesiser,
    Tap, Tones, Voice, sensation_level, write_wav,
};
use serde::Serialize;

use crate::outcome::Failure;
use crate::output::{Destination, counted, shown};

/// The sample rate [Hz]; the skin feels nothing above 1 kHz.
const SAMPLE_RATE: u32 = 8000;

/// What the contact points of a run feel, each by an actuator of its own.
pub(super) struct Vibration {
    mapping: Mapping,
    /// What plays it; `None` for one that plays every frequency.
    actuator: Option<Actuator>,
    /// The time of each tick [s].
    times: Vec<f64>,
    /// The sensations of each contact point in all ticks.
    points: Vec<Vec<Sensation>>,
    /// Ticks a second [Hz].
    rate: f64,
}

/// What actuators played.
pub(super) struct Played {
    pub(super) actuator: Option<Actuator>,
    /// What was made smaller, of all actuators together.
    pub(super) limiting: Limiting,
    /// How far each actuator's strongest moment is above the threshold of the skin [dB]; `None` for
    /// one that was silent.
    pub(super) levels: Vec<Option<f64>>,
}

/// What one actuator played.
struct Channel {
    samples: Vec<f32>,
    limiting: Limiting,
    level: Option<f64>,
}

impl Vibration {
    /// The vibration of a run at `rate` [Hz].
    pub(super) fn of<const D: usize>(
        scene: &BuiltScene<D>,
        recorder: &Recorder,
        rate: f64,
        actuator: Option<Actuator>,
    ) -> Result<Self, Failure> {
        let rows = recorder.rows();
        let count = rows.iter().map(|row| row.point).max().map_or(0, |last| last as usize + 1);
        let options = MappingOptions::default();
        let options = actuator.as_ref().map_or(options, |actuator| actuator.options(options));
        let mapping = Mapping::new(options).map_err(Failure::input)?;
        let felt = |point: usize| {
            let of_point = rows.iter().skip(point).step_by(count.max(1));
            let mut last: Option<&TraceRow> = None;
            let sensations = of_point.map(|row| {
                let cue = cue(scene, row, last, rate);
                last = Some(row);
                mapping.feel(&cue)
            });
            sensations.collect()
        };
        let times = rows.iter().step_by(count.max(1)).map(|row| row.time_s).collect();
        let points = (0..count).map(felt).collect();
        Ok(Self { mapping, actuator, times, points, rate })
    }

    /// What the contact points are to feel in all ticks.
    pub(super) fn tones(&self) -> Result<Vec<Vec<Tones>>, Failure> {
        let of_point = |sensations: &Vec<Sensation>| {
            let voice = Voice::new(&self.mapping, self.rate);
            let mut voice = voice.map_err(Failure::input)?;
            Ok(sensations.iter().map(|sensation| voice.step(sensation)).collect())
        };
        self.points.iter().map(of_point).collect()
    }

    /// The times of the ticks [s].
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// Writes a WAV file with a channel for each contact point.
    pub(super) fn write(&self, destination: &Destination) -> Result<Played, Failure> {
        let channels = self.points.iter().map(|sensations| self.channel(sensations));
        let channels = channels.collect::<Result<Vec<_>, _>>()?;
        let length = channels.first().map_or(0, |channel| channel.samples.len());
        let turns =
            (0..length).flat_map(|i| channels.iter().map(move |channel| channel.samples[i]));
        let count = u16::try_from(channels.len().max(1)).map_err(Failure::input)?;
        // The header holds the length and comes first, so the WAV is complete before it is
        // written.
        let mut wav = Cursor::new(Vec::new());
        write_wav(&mut wav, SAMPLE_RATE, count, turns).map_err(Failure::input)?;
        destination.write(|out| Ok(out.write_all(wav.get_ref())?))?;
        let limiting = channels.iter().map(|channel| channel.limiting);
        Ok(Played {
            actuator: self.actuator.clone(),
            limiting: limiting.fold(Limiting::default(), Limiting::and),
            levels: channels.iter().map(|channel| channel.level).collect(),
        })
    }

    /// What the actuator of a contact point plays.
    fn channel(&self, sensations: &[Sensation]) -> Result<Channel, Failure> {
        let sample_rate = f64::from(SAMPLE_RATE);
        let synthesiser = match &self.actuator {
            Some(actuator) => {
                Synthesiser::for_actuator(&self.mapping, actuator, sample_rate, 1)
            }
            None => Synthesiser::new(&self.mapping, sample_rate, 1),
        };
        let mut synthesiser = synthesiser.map_err(Failure::input)?;
        let mut samples = Vec::new();
        for (time, sensation) in self.times.iter().zip(sensations) {
            // All samples until the end of the tick, for rates that do not divide the sample
            // rate.
            let end = ((time + 1.0 / self.rate) * sample_rate).round() as usize;
            let start = samples.len();
            samples.resize(end.max(start), 0.0);
            synthesiser.render(&[*sensation], &mut samples[start..]);
        }
        // The file begins with the run, and not with the limiter's look-ahead.
        let (delay, length) = (synthesiser.delay(), samples.len());
        samples.resize(length + delay, 0.0);
        synthesiser.render(&[], &mut samples[length..]);
        samples.drain(..delay);
        let level = self.level(&samples)?;
        Ok(Channel { samples, limiting: synthesiser.limiting(), level })
    }

    /// How far the actuator's shaking is above the threshold of the skin [dB].
    fn level(&self, samples: &[f32]) -> Result<Option<f64>, Failure> {
        let sample_rate = f64::from(SAMPLE_RATE);
        let model = self
            .actuator
            .as_ref()
            .map(|actuator| ActuatorModel::new(actuator, sample_rate).map_err(Failure::input));
        let mut model = model.transpose()?;
        let shaking = samples.iter().map(|sample| {
            let sample = f64::from(*sample);
            model.as_mut().map_or(sample, |model| model.step(sample))
        });
        let shaking: Vec<f64> = shaking.collect();
        sensation_level(&shaking, sample_rate).map_err(Failure::input)
    }
}

impl Played {
    /// The lines of a report.
    pub(super) fn write(&self, out: &mut String) -> std::fmt::Result {
        let what = match &self.actuator {
            Some(actuator) => {
                format!("{}, {}", actuator.mechanism.kind_name(), shown(&actuator.name))
            }
            None => "of any frequency".to_owned(),
        };
        let actuators = counted(self.levels.len(), "actuator", "actuators");
        writeln!(out, "  vibration      {actuators}: {what}")?;
        let loudest = self.levels.iter().flatten().copied().reduce(f64::max);
        match loudest {
            Some(level) if level > 0.0 => writeln!(
                out,
                "                 felt up to {level:.0} dB above the threshold of the skin"
            )?,
            Some(level) => writeln!(
                out,
                "                 not felt: {:.0} dB below the threshold of the skin",
                -level
            )?,
            None => writeln!(out, "                 silent")?,
        }
        if self.limiting.ticks > 0 {
            writeln!(
                out,
                "                 limited in {} ticks, by up to {:.1} dB",
                self.limiting.ticks,
                self.limiting.largest_reduction_db()
            )?;
        }
        Ok(())
    }

    /// The part of the answer.
    pub(super) fn answer(&self) -> Vibrated {
        let actuator = self.actuator.as_ref();
        Vibrated {
            actuator: actuator.map(|actuator| actuator.name.to_string()),
            kind: actuator.map(|actuator| actuator.mechanism.kind_name()),
            channels: self.levels.len(),
            limited_ticks: self.limiting.ticks,
            largest_reduction: self.limiting.largest_reduction_db(),
            sensation_levels: self.levels.clone(),
        }
    }
}

/// What actuators played.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Vibrated {
    /// The actuator; `null` for one that plays every frequency.
    actuator: Option<String>,
    /// Its kind.
    kind: Option<&'static str>,
    /// How many actuators there are.
    channels: usize,
    /// Ticks in which the vibration was made smaller.
    limited_ticks: u64,
    /// The largest reduction of the vibration [dB].
    largest_reduction: f64,
    /// How far each actuator's strongest moment is above the threshold of the skin [dB]; `null` for
    /// one that was silent.
    sensation_levels: Vec<Option<f64>>,
}

/// Where a body takes a point between two times [s].
fn carried<const D: usize>(
    scene: &BuiltScene<D>,
    body: usize,
    times: [f64; 2],
    point: Point<3>,
) -> Point<3> {
    let [before, after] = times.map(|time| scene.pose_at(body, time));
    if before == after {
        return point;
    }
    let [before, after] = [before, after].map(|pose| pose.in_space());
    after.transform_point(before.inverse().transform_point(point))
}

/// The cue of a contact point in a tick, which is felt relative to the body.
fn cue<const D: usize>(
    scene: &BuiltScene<D>,
    row: &TraceRow,
    last: Option<&TraceRow>,
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
