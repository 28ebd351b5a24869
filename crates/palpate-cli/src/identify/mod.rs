// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate identify`: moves a device, says what it is made of, and writes its profile.

pub(crate) mod report;

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use palpate::device::{DeviceProfile, TurningProfile};
use palpate::field::Vector;
use palpate::scene::device_to_json;
use palpate::sim::{
    Hand, Identified, IdentifyError, IdentifyOptions as Motions, IdentifyProgress,
    SimulatedDevice, SimulationError, identify,
};

use crate::arguments::IdentifyOptions;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination, Files};
use palpate::scene::text::rounded;
use report::Report;

/// How often the live line is renewed.
const LIVE_EVERY: Duration = Duration::from_millis(250);

/// How often a line tells the progress where there is no terminal.
const REMARK_EVERY: Duration = Duration::from_secs(5);

/// The mass [kg] and the damping [N·s/m] of a hand that holds the handle.
const HAND: (f64, f64) = (0.1, 5.0);

pub(crate) fn run(
    options: &IdentifyOptions,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let given = [Some(&options.device), options.plant.as_ref()];
    let inputs = given.into_iter().flatten().filter_map(|choice| choice.file.as_deref());
    let mut files = Files::reading(inputs);
    let out = options.out.as_deref();
    let out = out.map(|path| files.output_as(path, "a profile", "json")).transpose()?;
    let profile = &options.device.profile;
    let plant = plant(options);
    let mut device = simulated(&plant, options.grip).map_err(Failure::input)?;
    let motions = Motions {
        travel: options.travel,
        force_part: options.force_part,
        seed: options.seed,
        ..Motions::new(options.rate)
    };
    interrupt.heed();
    let found = identified(&mut device, profile, motions, interrupt);
    let found = match found {
        Ok(found) => found,
        Err(IdentifyError::Interrupted { axis }) => {
            output::remark(format_args!("stopped {axis}, with zero force; nothing is written"));
            return Ok(Outcome::Interrupted);
        }
        Err(error) => return Err(Failure::input(error)),
    };
    let source = format!(
        "palpate identify {}, {} Hz, seed {}",
        env!("CARGO_PKG_VERSION"),
        options.rate,
        options.seed
    );
    let better = found.profile(profile, &source);
    let written = out.as_ref().map_or(Ok(()), |out| write(out, &better));
    let out = out.as_ref().filter(|_| written.is_ok());
    let report = Report { options, profile, plant: &plant, found: &found, out };
    let printed = report.print();
    // The numbers are told even if the file cannot be written.
    written.and(printed)?;
    let is_seen = found.axes.iter().all(palpate::sim::IdentifiedAxis::is_seen);
    Ok(if is_seen { Outcome::Yes } else { Outcome::No })
}

/// Says what will happen, before the first force.
fn warn(profile: &DeviceProfile, motions: &Motions) {
    let turning = profile.turning.as_ref().filter(|turning| turning.max_torque > 0.0);
    let turns = turning.map_or_else(String::new, |turning| {
        let torque = motions.largest_torque(turning);
        let angle = rounded(motions.angle);
        format!(", and turns by at most {angle} rad, with at most {} N·m", rounded(torque))
    });
    output::remark(format_args!(
        "let go of the handle of the {}: it moves by at most {} mm to each side, with at most {} \
         N{turns}; Ctrl-C stops it",
        profile.name,
        rounded(motions.travel * 1000.0),
        rounded(motions.largest_force(profile)),
    ));
}

/// The device as it is made.
fn plant(options: &IdentifyOptions) -> DeviceProfile {
    let profile = &options.device.profile;
    let made = options.plant.as_ref().map_or(profile, |choice| &choice.profile);
    let plant = DeviceProfile {
        mass: made.mass * options.plant_mass,
        least_damping: made.least_damping * options.plant_damping,
        friction: made.friction * options.plant_friction,
        encoder_step: made.encoder_step * options.plant_encoder_step,
        ..profile.clone()
    };
    let Some(turning) = &profile.turning else { return plant };
    let made = made.turning.as_ref().unwrap_or(turning);
    DeviceProfile {
        turning: Some(TurningProfile {
            inertia: made.inertia * options.plant_mass,
            least_damping: made.least_damping * options.plant_damping,
            friction: made.friction * options.plant_friction,
            encoder_step: made.encoder_step * options.plant_encoder_step,
            ..turning.clone()
        }),
        ..plant
    }
}

fn simulated(
    plant: &DeviceProfile,
    grip: Option<f64>,
) -> Result<SimulatedDevice, SimulationError> {
    let hand = Hand::free(Vector::ZERO)?;
    let hand = match grip {
        Some(stiffness) => hand.with_mass(HAND.0)?.with_spring(stiffness, HAND.1)?,
        None => hand,
    };
    SimulatedDevice::new(plant.clone(), vec![hand])
}

/// Identifies on virtual time, with a live line.
fn identified(
    device: &mut SimulatedDevice,
    profile: &DeviceProfile,
    motions: Motions,
    interrupt: &Interrupt,
) -> Result<Identified, IdentifyError> {
    let shows_line = io::stderr().is_terminal();
    let (mut told, mut told_at) = (None, Instant::now());
    let mut ticks = 0.0;
    let mut next_tick = |progress: &IdentifyProgress| {
        let &IdentifyProgress { axis, axis_number, axes, strokes, .. } = progress;
        let is_new = told.is_none_or(|(number, _)| number != axis_number);
        if told.is_none() {
            warn(profile, &motions);
        }
        let every = if shows_line { LIVE_EVERY } else { REMARK_EVERY };
        let is_changed = shows_line && told != Some((axis_number, strokes));
        if is_new || is_changed || told_at.elapsed() >= every {
            (told, told_at) = (Some((axis_number, strokes)), Instant::now());
            let time = ticks / motions.rate;
            let line =
                format!("{axis} ({axis_number} of {axes}): {strokes} strokes, at {time:.1} s");
            if shows_line { output::live(line) } else { output::remark(line) }
        }
        ticks += 1.0;
        (!interrupt.is_asked()).then_some(ticks / motions.rate)
    };
    let found = identify(device, motions, &mut next_tick);
    if shows_line {
        output::remark("");
    }
    found
}

fn write(out: &Destination, profile: &DeviceProfile) -> Result<(), Failure> {
    let text = device_to_json(profile).map_err(Failure::input)?;
    out.write(|file| Ok(file.write_all(text.as_bytes())?))
}
