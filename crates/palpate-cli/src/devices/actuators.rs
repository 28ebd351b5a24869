// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The profiles of known actuators.

use std::collections::BTreeMap;
use std::io::Write;

use palpate::vibration::{ACTUATORS, Actuator};
use serde::Serialize;

use super::Figure;
use crate::outcome::{Failure, Outcome};
use crate::output;
use palpate::scene::text::rounded;

/// Prints a line for each actuator, or JSON.
pub(super) fn report(as_json: bool) -> Result<Outcome, Failure> {
    let mut out = output::answer();
    if as_json {
        let actuators = ACTUATORS.iter().map(|(name, actuator)| Described::of(name, actuator));
        out.json(&Answer { actuators: actuators.collect() })?;
        return Ok(Outcome::Yes);
    }
    writeln!(out, "actuators that shake; levels are parts of the rated level; ~ assumed")?;
    for (name, actuator) in &ACTUATORS {
        let figures = actuator.mechanism.figures().into_iter().map(|(field, value, unit)| {
            let is_assumed = actuator.assumed.contains(&field);
            let mark = if is_assumed { "~" } else { "" };
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            format!("{} {mark}{}{unit}", field.replace('_', " "), rounded(value))
        });
        let figures: Vec<_> = figures.collect();
        let kind = actuator.mechanism.kind_name();
        writeln!(out, "{name}: {kind}, {}: {}", actuator.name, figures.join(", "))?;
        writeln!(out, "{name}: source: {}", actuator.source)?;
    }
    writeln!(out, "{} actuators", ACTUATORS.len())?;
    Ok(Outcome::Yes)
}

/// The answer of `palpate devices --actuators`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The actuators.
    actuators: Vec<Described>,
}

/// An actuator, with a figure for each number of its profile.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Described {
    /// Its name on the command line.
    name: &'static str,
    /// Its name.
    actuator: String,
    /// What makes it shake.
    kind: &'static str,
    #[serde(flatten)]
    figures: BTreeMap<&'static str, Figure>,
    /// Where the numbers are from.
    source: String,
}

impl Described {
    fn of(name: &'static str, actuator: &Actuator) -> Self {
        let figures = actuator.mechanism.figures().into_iter().map(|(field, value, unit)| {
            (field, Figure { value, unit, is_assumed: actuator.assumed.contains(&field) })
        });
        Self {
            name,
            actuator: actuator.name.to_string(),
            kind: actuator.mechanism.kind_name(),
            figures: figures.collect(),
            source: actuator.source.to_string(),
        }
    }
}
