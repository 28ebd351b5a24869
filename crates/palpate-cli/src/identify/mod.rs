// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate identify`: measures a device.

use std::io::{self, IsTerminal};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use palpate::device::{DeviceProfile, TurningProfile};
use palpate::field::Vector;
use palpate::scene::device_to_json;
use palpate::scene::text::rounded;
use palpate::sim::{
    Hand, Identified, IdentifyError, IdentifyOptions as Motions, IdentifyProgress,
    SimulatedDevice, SimulationError, identify,
};
use report::Report;

use crate::arguments::numbers::{count, positive, within, zero_or_more};
use crate::arguments::{ProfileChoice, Reading};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination, Files};

pub(crate) mod report;

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
    let mut files = Files::reading(inputs, Reading::default());
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

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate identify --device omega
  palpate identify --device touch --plant-damping 0.3 --plant-friction 3
  palpate identify --device falcon --plant-mass 1.5 --out falcon.json
  palpate feel --device simulated:falcon.json";

/// The options of `palpate identify`.
#[derive(Args, Debug)]
pub(crate) struct IdentifyOptions {
    /// The device, simulated: a name of `palpate devices`, or a JSON file with a profile.
    #[arg(long, value_name = "NAME|JSON")]
    pub(crate) device: ProfileChoice,
    /// What the simulated device is made of, in place of its profile: mass, damping, friction and
    /// encoder step of another one, by name or from a file.
    #[arg(long, value_name = "NAME|JSON")]
    pub(crate) plant: Option<ProfileChoice>,
    /// Its mass and moment of inertia, over those of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = positive(""))]
    pub(crate) plant_mass: f64,
    /// Its damping, over that of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = zero_or_more(""))]
    pub(crate) plant_damping: f64,
    /// Its friction, over that of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = zero_or_more(""))]
    pub(crate) plant_friction: f64,
    /// Its encoder steps, over those of the profile.
    #[arg(long, value_name = "FACTOR", default_value = "1", hide_default_value = true, allow_negative_numbers = true, value_parser = zero_or_more(""))]
    pub(crate) plant_encoder_step: f64,
    /// A simulated hand that holds the handle by this stiffness [N/m], to see that it is noticed: from
    /// a fifth of the friction at the end of the travel; no hand if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("N/m"))]
    pub(crate) grip: Option<f64>,
    /// Ticks a second, from 500 to 10000 [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = within(500.0, 10_000.0, "Hz"))]
    pub(crate) rate: f64,
    /// The farthest that the handle moves from its start, from 0.0001 to 0.05 [m]. The handle is
    /// stopped at 200 times this in a second, 1 m/s for 0.005 m, so encoder steps set a least travel.
    #[arg(long, allow_negative_numbers = true, default_value = "0.005", value_parser = within(1e-4, 0.05, "m"))]
    pub(crate) travel: f64,
    /// The largest part of the largest force that pushes, from 0.01 to 1.
    #[arg(long, value_name = "PART", allow_negative_numbers = true, default_value = "0.3", value_parser = within(0.01, 1.0, ""))]
    pub(crate) force_part: f64,
    /// Shifts the lengths of the strokes: a whole number from 0 to 18446744073709551615.
    #[arg(long, allow_negative_numbers = true, default_value = "0", value_parser = count(0, u64::MAX))]
    pub(crate) seed: u64,
    /// Write the profile with what was found to this file, whose name ends in .json.
    #[arg(long, value_name = "JSON")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
