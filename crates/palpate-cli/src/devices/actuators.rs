// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The profiles of known actuators.

use std::io::Write;

use palpate::vibration::{ACTUATORS, Actuator};
use serde_json::{Map, Value, json};

use crate::outcome::{Failure, Outcome};
use crate::output;
use palpate::scene::text::rounded;

/// Prints a line for each actuator, or JSON.
pub(super) fn report(as_json: bool) -> Result<Outcome, Failure> {
    let mut out = output::answer();
    if as_json {
        let rows = ACTUATORS.iter().map(|(name, actuator)| described(name, actuator));
        out.json(&Value::Array(rows.collect()))?;
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

fn described(name: &str, actuator: &Actuator) -> Value {
    let mut row = Map::new();
    row.insert("name".to_owned(), name.into());
    row.insert("actuator".to_owned(), actuator.name.as_ref().into());
    row.insert("kind".to_owned(), actuator.mechanism.kind_name().into());
    for (field, value, unit) in actuator.mechanism.figures() {
        let assumed = actuator.assumed.contains(&field);
        let figure = json!({ "value": value, "unit": unit, "assumed": assumed });
        row.insert(field.to_owned(), figure);
    }
    row.insert("source".to_owned(), actuator.source.as_ref().into());
    Value::Object(row)
}
