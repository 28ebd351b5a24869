// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How hands rest on walls when devices differ from their profiles.

use std::io::Write;

use indicatif::{ProgressBar, ProgressStyle};
use palpate::device::DeviceProfile;
use palpate::haptics::Material;
use palpate::stability::{Plant, Press, Rest};
use rayon::prelude::*;
use serde::Serialize;

use super::with_forces;
use crate::devices::DevicesOptions;
use crate::outcome::{Failure, Outcome};
use crate::output;
use palpate::scene::text::rounded;

/// The delays of the columns [ticks].
const DELAYS: [usize; 3] = [0, 1, 2];

/// Energy that a wall may give out [J].
const MOST_GIVEN: f64 = 1e-3;

/// The worst of many presses.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Worst {
    /// How many presses there were.
    presses: usize,
    /// Presses in which the hand did not come to rest.
    restless: usize,
    /// Presses that gave out more than a millijoule.
    giving: usize,
    /// Presses after which the wall was softer.
    softer: usize,
    /// The largest swing [m].
    largest_swing: f64,
    /// The largest swing of the force [N].
    largest_force_swing: f64,
    /// The most energy given [J].
    most_energy_given: f64,
    /// The largest change of what the controller took [N].
    largest_controller_step: f64,
}

impl Worst {
    fn with(self, rest: &Rest) -> Self {
        Self {
            presses: self.presses + 1,
            restless: self.restless + usize::from(!rest.is_at_rest()),
            giving: self.giving + usize::from(rest.energy_given > MOST_GIVEN),
            softer: self.softer + usize::from(rest.stiffness_part < 1.0),
            largest_swing: self.largest_swing.max(rest.swing),
            largest_force_swing: self.largest_force_swing.max(rest.force_swing),
            most_energy_given: self.most_energy_given.max(rest.energy_given),
            largest_controller_step: self.largest_controller_step.max(rest.controller_step),
        }
    }

    fn cell(&self) -> String {
        let mut parts = Vec::new();
        if self.restless > 0 {
            let (swing, force) =
                (rounded(1e3 * self.largest_swing), rounded(self.largest_force_swing));
            parts.push(format!("{} swing, to {swing} mm, {force} N", self.restless));
        }
        if self.giving > 0 {
            parts.push(format!(
                "{} give, to {} mJ",
                self.giving,
                rounded(1e3 * self.most_energy_given)
            ));
        }
        if parts.is_empty() { "all rest".to_owned() } else { parts.join("; ") }
    }
}

/// The answer of `palpate devices --stability`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The presses by each device on each material with each delay.
    presses: Vec<Pressed>,
}

/// The presses by a device on a material with a delay.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Pressed {
    /// The name of the device on the command line.
    device: String,
    /// The name of the material.
    material: String,
    /// The delay of forces [ticks].
    delay: usize,
    #[serde(flatten)]
    worst: Worst,
}

/// Prints a table, of which a page can be made, or JSON.
pub(super) fn report(options: &DevicesOptions) -> Result<Outcome, Failure> {
    let materials = materials(options)?;
    let rows: Vec<_> = with_forces(options)?
        .flat_map(|(name, profile)| materials.iter().map(move |m| (name, profile, m)))
        .collect();
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} devices and materials");
    let bar = ProgressBar::new(rows.len() as u64);
    let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let mut found = Vec::with_capacity(rows.len());
    for (count, (device, profile, (material, asked))) in rows.iter().enumerate() {
        if bar.is_hidden() && rows.len() > 1 {
            let (count, all) = (count + 1, rows.len());
            output::remark(format_args!("{device}, {material} ({count} of {all})"));
        }
        let worst = DELAYS.iter().map(|delay| worst(profile, asked, *delay));
        found.push((*device, *material, worst.collect::<Result<Vec<_>, Failure>>()?));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let mut out = output::answer();
    if options.json {
        let of = |(device, material, cells): &(&str, &str, Vec<Worst>)| {
            let pressed = |(worst, delay): (&Worst, usize)| Pressed {
                device: (*device).to_owned(),
                material: (*material).to_owned(),
                delay,
                worst: *worst,
            };
            cells.iter().zip(DELAYS).map(pressed).collect::<Vec<_>>()
        };
        out.json(&Answer { presses: found.iter().flat_map(of).collect() })?;
        return Ok(Outcome::Yes);
    }
    writeln!(
        out,
        "Each cell: {} presses by devices that differ from their profile. At rest, the position \
         swings by at most 0.2 mm and the force by at most 0.5 N; a press gives if the wall gave \
         out more than 1 mJ.",
        Plant::wrong(0).count()
    )?;
    writeln!(out)?;
    writeln!(out, "| | no delay | a tick late | two ticks late |")?;
    writeln!(out, "|---|---|---|---|")?;
    for (device, material, cells) in found {
        let cells: Vec<_> = cells.iter().map(Worst::cell).collect();
        let of = if materials.len() > 1 { format!(", {material}") } else { String::new() };
        writeln!(out, "| `{device}`{of} | {} |", cells.join(" | "))?;
    }
    Ok(Outcome::Yes)
}

/// The materials that were asked for, with their names.
fn materials(options: &DevicesOptions) -> Result<Vec<(&str, Material)>, Failure> {
    let asked = options.material.iter().map(|name| {
        let material = Material::preset(name).map_err(Failure::input)?;
        Ok((name.as_str(), material))
    });
    asked.collect()
}

/// The worst of all presses on a device.
fn worst(profile: &DeviceProfile, material: &Material, delay: usize) -> Result<Worst, Failure> {
    let presses: Vec<_> = Plant::wrong(delay).collect();
    let rest = |plant: &Plant| Press::new(profile, material)?.on(*plant);
    let rests = presses.par_iter().map(rest).collect::<Result<Vec<_>, _>>();
    let rests = rests.map_err(Failure::input)?;
    Ok(rests.iter().fold(Worst::default(), Worst::with))
}
