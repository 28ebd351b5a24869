// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate devices`: the profiles of known devices.

use std::io::Write;

use palpate::devices::{DeviceProfile, PROFILES};
use serde_json::{Map, Value, json};

use crate::arguments::DevicesOptions;
use crate::outcome::{Failure, Outcome};

/// A number of a profile.
struct Column {
    /// The field.
    key: &'static str,
    unit: &'static str,
    /// Two lines above the column; the unit is the third.
    head: [&'static str; 2],
    of: fn(&DeviceProfile) -> f64,
}

const COLUMNS: [Column; 10] = [
    Column { key: "max_force", unit: "N", head: ["largest", "force"], of: |p| p.max_force },
    Column {
        key: "continuous_force",
        unit: "N",
        head: ["lasting", "force"],
        of: |p| p.continuous_force,
    },
    Column {
        key: "max_force_rate",
        unit: "N/s",
        head: ["force", "rate"],
        of: |p| p.max_force_rate,
    },
    Column {
        key: "max_stiffness",
        unit: "N/m",
        head: ["stiff-", "ness"],
        of: |p| p.max_stiffness,
    },
    Column {
        key: "max_damping", unit: "N·s/m", head: ["damp-", "ing"], of: |p| p.max_damping
    },
    Column {
        key: "workspace_radius",
        unit: "m",
        head: ["work-", "space"],
        of: |p| p.workspace_radius,
    },
    Column { key: "mass", unit: "kg", head: ["", "mass"], of: |p| p.mass },
    Column {
        key: "least_damping",
        unit: "N·s/m",
        head: ["its own", "damping"],
        of: |p| p.least_damping,
    },
    Column { key: "friction", unit: "N", head: ["fric-", "tion"], of: |p| p.friction },
    Column {
        key: "encoder_step",
        unit: "m",
        head: ["encoder", "step"],
        of: |p| p.encoder_step,
    },
];

pub(crate) fn run(options: &DevicesOptions) -> Result<Outcome, Failure> {
    let mut out = std::io::stdout().lock();
    if options.json {
        let rows = PROFILES.iter().map(|(name, profile)| described(name, profile)).collect();
        writeln!(out, "{:#}", Value::Array(rows))?;
        return Ok(Outcome::Yes);
    }
    let width = PROFILES.iter().map(|(name, _)| name.len()).max().unwrap_or_default();
    let lines: [fn(&Column) -> &str; 3] = [|c| c.head[0], |c| c.head[1], |c| c.unit];
    for line in lines {
        let heads: String = COLUMNS.iter().map(|c| format!("{:>9}", line(c))).collect();
        writeln!(out, "{:width$}{heads}", "")?;
    }
    for (name, profile) in &PROFILES {
        let cells: String = COLUMNS.iter().map(|column| cell(column, profile)).collect();
        writeln!(out, "{name:width$}{cells}")?;
    }
    writeln!(out, "~ assumed, not from the source; stiffness and damping are those at 1 kHz")?;
    for (name, profile) in &PROFILES {
        writeln!(out, "{name}: {}; source: {}", profile.name, profile.source)?;
    }
    writeln!(out, "{} devices", PROFILES.len())?;
    Ok(Outcome::Yes)
}

fn is_assumed(column: &Column, profile: &DeviceProfile) -> bool {
    profile.assumed.contains(&column.key)
}

/// A number in 9 places, with a sign before it if it is assumed.
fn cell(column: &Column, profile: &DeviceProfile) -> String {
    let value = (column.of)(profile);
    let mark = if is_assumed(column, profile) { "~" } else { "" };
    let number = if value < 1e-3 { format!("{value:e}") } else { value.to_string() };
    format!("{:>9}", format!("{mark}{number}"))
}

fn described(name: &str, profile: &DeviceProfile) -> Value {
    let number = |column: &Column| {
        let number = json!({
            "value": (column.of)(profile),
            "unit": column.unit,
            "assumed": is_assumed(column, profile),
        });
        (column.key.to_owned(), number)
    };
    let mut row = Map::new();
    row.insert("name".to_owned(), name.into());
    row.insert("device".to_owned(), profile.name.as_ref().into());
    row.extend(COLUMNS.iter().map(number));
    row.insert("source".to_owned(), profile.source.as_ref().into());
    Value::Object(row)
}
