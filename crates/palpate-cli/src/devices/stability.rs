// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How hands rest on walls when devices differ from their profiles.

use std::io::Write;

use indicatif::{ProgressBar, ProgressStyle};
use palpate::devices::DeviceProfile;
use palpate::devices::stability::{Plant, Press, Rest};
use palpate::haptics::Material;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::listed;
use crate::arguments::DevicesOptions;
use crate::numbers::rounded;
use crate::outcome::{Failure, Outcome};
use crate::output;

/// The delays of the columns [ticks].
const DELAYS: [usize; 3] = [0, 1, 2];

/// Energy that a wall may give out [J].
const MOST_GIVEN: f64 = 1e-3;

/// The worst of many presses.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    presses: usize,
    /// Presses in which the hand did not come to rest.
    restless: usize,
    /// Presses that gave out more than a millijoule.
    giving: usize,
    /// Presses after which the wall was softer.
    softer: usize,
    /// The largest swing [m].
    swing: f64,
    /// The largest swing of the force [N].
    force_swing: f64,
    /// The most energy given [J].
    energy_given: f64,
    /// The largest change of what the controller took [N].
    controller_step: f64,
}

impl Worst {
    fn with(self, rest: &Rest) -> Self {
        Self {
            presses: self.presses + 1,
            restless: self.restless + usize::from(!rest.is_at_rest()),
            giving: self.giving + usize::from(rest.energy_given > MOST_GIVEN),
            softer: self.softer + usize::from(rest.stiffness_part < 1.0),
            swing: self.swing.max(rest.swing),
            force_swing: self.force_swing.max(rest.force_swing),
            energy_given: self.energy_given.max(rest.energy_given),
            controller_step: self.controller_step.max(rest.controller_step),
        }
    }

    fn cell(&self) -> String {
        let mut parts = Vec::new();
        if self.restless > 0 {
            let (swing, force) = (rounded(1e3 * self.swing), rounded(self.force_swing));
            parts.push(format!("{} swing, to {swing} mm, {force} N", self.restless));
        }
        if self.giving > 0 {
            parts.push(format!(
                "{} give, to {} mJ",
                self.giving,
                rounded(1e3 * self.energy_given)
            ));
        }
        if parts.is_empty() { "all rest".to_owned() } else { parts.join("; ") }
    }

    fn described(&self, device: &str, delay: usize) -> Value {
        json!({
            "device": device,
            "delay": delay,
            "presses": self.presses,
            "restless": self.restless,
            "giving": self.giving,
            "softer": self.softer,
            "largest_swing": self.swing,
            "largest_force_swing": self.force_swing,
            "most_energy_given": self.energy_given,
            "largest_controller_step": self.controller_step,
        })
    }
}

/// Prints a table, of which a page can be made, or JSON.
pub(super) fn report(options: &DevicesOptions) -> Result<Outcome, Failure> {
    let materials = materials(options)?;
    let devices: Vec<_> = listed(options)
        .into_iter()
        .filter(|(_, profile)| profile.max_force > 0.0 && profile.max_force < f64::INFINITY)
        .collect();
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} devices");
    let bar = ProgressBar::new(devices.len() as u64);
    let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let mut rows = Vec::new();
    for (name, profile) in bar.wrap_iter(devices.into_iter()) {
        let worst = DELAYS.iter().map(|delay| worst(profile, &materials, *delay));
        rows.push((name, worst.collect::<Result<Vec<_>, Failure>>()?));
    }
    bar.finish_and_clear();
    let mut out = output::answer();
    if options.json {
        let of = |(name, cells): &(&str, Vec<Worst>)| {
            let cells =
                cells.iter().zip(DELAYS).map(|(worst, delay)| worst.described(name, delay));
            cells.collect::<Vec<_>>()
        };
        out.json(&Value::Array(rows.iter().flat_map(of).collect()))?;
        return Ok(Outcome::Yes);
    }
    writeln!(out, "| | no delay | a tick late | two ticks late |")?;
    writeln!(out, "|---|---|---|---|")?;
    for (name, cells) in rows {
        let cells: Vec<_> = cells.iter().map(Worst::cell).collect();
        writeln!(out, "| `{name}` | {} |", cells.join(" | "))?;
    }
    Ok(Outcome::Yes)
}

/// The materials that were asked for.
fn materials(options: &DevicesOptions) -> Result<Vec<Material>, Failure> {
    let asked =
        options.material.iter().map(|name| Material::preset(name).map_err(Failure::input));
    asked.collect()
}

/// The worst of all presses on a device.
fn worst(
    profile: &DeviceProfile,
    materials: &[Material],
    delay: usize,
) -> Result<Worst, Failure> {
    let presses: Vec<_> = materials
        .iter()
        .flat_map(|material| Plant::wrong(delay).map(move |plant| (material, plant)))
        .collect();
    let rest =
        |(material, plant): &(&Material, Plant)| Press::new(profile, material)?.on(*plant);
    let rests = presses.par_iter().map(rest).collect::<Result<Vec<_>, _>>();
    let rests = rests.map_err(Failure::input)?;
    Ok(rests.iter().fold(Worst::default(), Worst::with))
}
