// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The vibration of a run as a WAV file, for fingers without force feedback.

use std::io::Cursor;

use palpate::field::Point;
use palpate::scene::BuiltScene;
use palpate::servo_loop::{Recorder, TraceRow};
use palpate::vibration::{
    Cue, Mapping, MappingOptions, Sensation, Synthesiser, Tap, write_wav,
};

use crate::outcome::Failure;
use crate::output::Destination;

/// The sample rate [Hz]; the skin feels nothing above 1 kHz.
const SAMPLE_RATE: u32 = 8000;

/// Writes the vibration of all contact points of a run at `rate` [Hz] together.
pub(super) fn write<const D: usize>(
    scene: &BuiltScene<D>,
    recorder: &Recorder<D>,
    rate: f64,
    destination: &Destination,
) -> Result<(), Failure> {
    let points = recorder.rows().iter().map(|row| row.point).max().map_or(0, |last| last + 1);
    let points = points as usize;
    let mapping = Mapping::new(MappingOptions::default()).map_err(Failure::input)?;
    let mut synthesiser = Synthesiser::new(&mapping, f64::from(SAMPLE_RATE), points.max(1))
        .map_err(Failure::input)?;
    let mut samples = Vec::new();
    let mut last: Option<&[TraceRow<D>]> = None;
    let mut sensations = vec![Sensation::default(); points];
    for tick in recorder.rows().chunks_exact(points.max(1)) {
        for (i, row) in tick.iter().enumerate() {
            let cue = cue(scene, row, last.and_then(|last| last.get(i)), rate);
            sensations[i] = mapping.feel(&cue);
        }
        // All samples until the end of the tick, for rates that do not divide the sample rate.
        let end = ((tick[0].time_s + 1.0 / rate) * f64::from(SAMPLE_RATE)).round() as usize;
        let start = samples.len();
        samples.resize(end.max(start), 0.0);
        synthesiser.render(&sensations, &mut samples[start..]);
        last = Some(tick);
    }
    // The header holds the length and comes first, so the WAV is complete before it is written.
    let mut wav = Cursor::new(Vec::new());
    write_wav(&mut wav, SAMPLE_RATE, samples).map_err(Failure::input)?;
    destination.write(|out| Ok(out.write_all(wav.get_ref())?))
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
