// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What devices render of the materials that have names.

use std::io::Write;

use palpate::device::DeviceProfile;
use palpate::field::Shape;
use palpate::haptics::{Bodies, Body, Material, Protection, Surface};
use palpate::safety::Accepted;
use serde::Serialize;

use super::with_forces;
use crate::devices::DevicesOptions;
use crate::outcome::{Failure, Outcome};
use crate::output;
use palpate::scene::text::rounded;

/// Prints a table, of which a page can be made, or JSON.
pub(super) fn report(options: &DevicesOptions) -> Result<Outcome, Failure> {
    let rows = with_forces(options)?;
    let rows = rows.map(|(name, profile)| Ok((name, rendered(profile, options.rate)?)));
    let rows = rows.collect::<Result<Vec<_>, Failure>>()?;
    let names: Vec<_> = Material::preset_names().collect();
    let mut out = output::answer();
    if options.json {
        let of = |(name, accepted): &(&str, Vec<Accepted>)| {
            let named = |(name, accepted): (&&'static str, &Accepted)| Rendered {
                accepted: accepted.clone(),
                name,
            };
            RenderedDevice {
                device: (*name).to_owned(),
                rate: options.rate,
                materials: names.iter().zip(accepted).map(named).collect(),
            }
        };
        out.json(&Answer { devices: rows.iter().map(of).collect() })?;
        return Ok(Outcome::Yes);
    }
    writeln!(out, "| | {} |", names.join(" | ").replace('_', " "))?;
    writeln!(out, "|---{}|", "|---".repeat(names.len()))?;
    let mut line =
        |name: &str, cells: Vec<String>| writeln!(out, "| {name} | {} |", cells.join(" | "));
    let asked = names.iter().map(|name| Material::preset(name).map_err(Failure::input));
    let asked = asked.collect::<Result<Vec<_>, _>>()?;
    line("*asked for*", asked.iter().map(|m| cell(stiffest(m), m.damping)).collect())?;
    for (name, accepted) in rows {
        let cells = accepted.iter().map(|a| cell(a.device_stiffness, a.device_damping));
        line(&format!("`{name}`"), cells.collect())?;
    }
    Ok(Outcome::Yes)
}

/// What a device renders of each material, in a world of its own scale.
fn rendered(profile: &DeviceProfile, rate: f64) -> Result<Vec<Accepted>, Failure> {
    let ball = Shape::<3>::sphere(1.0).map_err(Failure::input)?;
    let bodies = Material::preset_names().map(|name| {
        let material = Material::preset(name).map_err(Failure::input)?;
        let surface = Surface::new(&material).map_err(Failure::input)?;
        Body::new(ball.clone(), surface).map_err(Failure::input)
    });
    let bodies = bodies.collect::<Result<Vec<_>, Failure>>()?;
    let bodies = Bodies::new(bodies).map_err(Failure::input)?;
    let accepted = Protection::new(profile.clone()).accept(bodies, rate);
    Ok(accepted.map_err(Failure::input)?.1)
}

/// The stiffness of a material's stiffest layer [N/m].
fn stiffest(material: &Material) -> f64 {
    let layers = material.layers.iter().filter_map(|layer| layer.stiffness);
    layers.fold(material.stiffness, f64::max)
}

fn cell(stiffness: f64, damping: f64) -> String {
    format!("{} / {}", rounded(stiffness), rounded(damping))
}

/// The answer of `palpate devices --materials`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The devices that give forces.
    devices: Vec<RenderedDevice>,
}

/// What a device renders of each material.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct RenderedDevice {
    /// Its name on the command line.
    device: String,
    /// Ticks a second [Hz].
    rate: f64,
    /// The materials.
    materials: Vec<Rendered>,
}

/// What a device renders of a material.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Rendered {
    #[serde(flatten)]
    accepted: Accepted,
    /// The name of the material.
    name: &'static str,
}
