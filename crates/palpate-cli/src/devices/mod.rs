// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate devices`: the profiles of known devices and actuators.

mod actuators;
mod rendered;
mod stability;

use std::io::Write;

use palpate::device::{DeviceProfile, GripperProfile, PROFILES, TurningProfile};
use serde_json::{Map, Value, json};

use crate::arguments::DevicesOptions;
use crate::outcome::{Failure, Outcome};
use crate::output;

/// A number of a profile, for translation or for rotation.
struct Column<P: 'static> {
    /// The field.
    key: &'static str,
    unit: &'static str,
    /// The first two lines of the column's head; the third is the unit.
    head: [&'static str; 2],
    of: fn(&P) -> f64,
}

const COLUMNS: [Column<DeviceProfile>; 12] = [
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
    Column { key: "max_speed", unit: "m/s", head: ["", "speed"], of: |p| p.max_speed },
    Column {
        key: "max_acceleration",
        unit: "m/s²",
        head: ["accel-", "eration"],
        of: |p| p.max_acceleration,
    },
];

const TURNING: [Column<TurningProfile>; 11] = [
    Column {
        key: "max_torque",
        unit: "N·m",
        head: ["largest", "torque"],
        of: |p| p.max_torque,
    },
    Column {
        key: "continuous_torque",
        unit: "N·m",
        head: ["lasting", "torque"],
        of: |p| p.continuous_torque,
    },
    Column {
        key: "max_torque_rate",
        unit: "N·m/s",
        head: ["torque", "rate"],
        of: |p| p.max_torque_rate,
    },
    Column {
        key: "max_stiffness",
        unit: "N·m/rad",
        head: ["stiff-", "ness"],
        of: |p| p.max_stiffness,
    },
    Column {
        key: "max_damping",
        unit: "N·m·s/rad",
        head: ["damp-", "ing"],
        of: |p| p.max_damping,
    },
    Column { key: "inertia", unit: "kg·m²", head: ["", "inertia"], of: |p| p.inertia },
    Column {
        key: "least_damping",
        unit: "N·m·s/rad",
        head: ["its own", "damping"],
        of: |p| p.least_damping,
    },
    Column { key: "friction", unit: "N·m", head: ["fric-", "tion"], of: |p| p.friction },
    Column {
        key: "encoder_step",
        unit: "rad",
        head: ["encoder", "step"],
        of: |p| p.encoder_step,
    },
    Column { key: "max_speed", unit: "rad/s", head: ["", "speed"], of: |p| p.max_speed },
    Column {
        key: "max_acceleration",
        unit: "rad/s²",
        head: ["accel-", "eration"],
        of: |p| p.max_acceleration,
    },
];

const GRIPPER: [Column<GripperProfile>; 3] = [
    Column { key: "max_opening", unit: "m", head: ["", "opening"], of: |p| p.max_opening },
    Column { key: "max_force", unit: "N", head: ["largest", "force"], of: |p| p.max_force },
    Column {
        key: "max_force_rate",
        unit: "N/s",
        head: ["force", "rate"],
        of: |p| p.max_force_rate,
    },
];

pub(crate) fn run(options: &DevicesOptions) -> Result<Outcome, Failure> {
    if options.materials {
        return rendered::report(options);
    }
    if options.stability {
        return stability::report(options);
    }
    if options.actuators {
        return actuators::report(options.json);
    }
    let listed = listed(options);
    let mut out = output::answer();
    if options.json {
        let rows = listed.iter().map(|(name, profile)| described(name, profile)).collect();
        out.json(&Value::Array(rows))?;
        return Ok(Outcome::Yes);
    }
    let along: Vec<_> =
        listed.iter().map(|(name, profile)| (*name, *profile, &*profile.assumed)).collect();
    write_table(&mut out, &COLUMNS, &along, 9)?;
    let about = listed.iter().filter_map(|(name, profile)| {
        profile.turning.as_ref().map(|turning| (*name, turning, &*turning.assumed))
    });
    let about: Vec<_> = about.collect();
    if !about.is_empty() {
        writeln!(
            out,
            "devices with rotation, about their axes; those without a torque only sense it"
        )?;
        write_table(&mut out, &TURNING, &about, 10)?;
    }
    let grippers = listed.iter().filter_map(|(name, profile)| {
        profile.gripper.as_ref().map(|gripper| (*name, gripper, &[] as &[_]))
    });
    let grippers: Vec<_> = grippers.collect();
    if !grippers.is_empty() {
        writeln!(out, "devices with grippers, between the fingers")?;
        write_table(&mut out, &GRIPPER, &grippers, 10)?;
    }
    writeln!(out, "~ assumed, not from the source; stiffness and damping are those at 1 kHz")?;
    for (name, profile) in &listed {
        writeln!(out, "{name}: {}; source: {}", profile.name, profile.source)?;
        if let Some(turning) = &profile.turning {
            writeln!(out, "{name}, about its axes: source: {}", turning.source)?;
        }
        if !profile.buttons.is_empty() {
            writeln!(out, "{name}, buttons: {}", profile.buttons.join(", "))?;
        }
    }
    if options.profile.is_some() {
        return Ok(Outcome::Yes);
    }
    writeln!(out, "{} devices", listed.len())?;
    writeln!(out)?;
    actuators::report(false)
}

/// The devices that are asked for, with their names.
fn listed(options: &DevicesOptions) -> Vec<(&str, &DeviceProfile)> {
    match &options.profile {
        Some(choice) => vec![(&choice.name, &choice.profile)],
        None => PROFILES.iter().map(|(name, profile)| (*name, profile)).collect(),
    }
}

/// The devices that are asked for and give forces.
fn with_forces(
    options: &DevicesOptions,
) -> Result<impl Iterator<Item = (&str, &DeviceProfile)>, Failure> {
    if let Some(choice) = options.profile.as_ref().filter(|c| c.profile.max_force == 0.0) {
        let name = &choice.profile.name;
        return Err(Failure::input(format!("{name} gives no forces, so nothing presses back")));
    }
    let gives_forces = |(_, profile): &(&str, &DeviceProfile)| profile.max_force > 0.0;
    Ok(listed(options).into_iter().filter(gives_forces))
}

/// A row for each profile, with its name and its assumed numbers; columns are `wide` characters
/// wide.
fn write_table<P>(
    out: &mut impl Write,
    columns: &[Column<P>],
    rows: &[(&str, &P, &[&str])],
    wide: usize,
) -> std::io::Result<()> {
    let width = rows.iter().map(|(name, ..)| name.len()).max().unwrap_or_default();
    let lines: [fn(&Column<P>) -> &str; 3] = [|c| c.head[0], |c| c.head[1], |c| c.unit];
    for line in lines {
        let heads: String = columns.iter().map(|c| format!("{:>wide$}", line(c))).collect();
        writeln!(out, "{:width$}{heads}", "")?;
    }
    for (name, profile, assumed) in rows {
        let cell = |c: &Column<P>| cell((c.of)(profile), assumed.contains(&c.key));
        let cells: String = columns.iter().map(|c| format!("{:>wide$}", cell(c))).collect();
        writeln!(out, "{name:width$}{cells}")?;
    }
    Ok(())
}

/// A number, after a `~` if it is assumed.
fn cell(value: f64, is_assumed: bool) -> String {
    let mark = if is_assumed { "~" } else { "" };
    let is_small = value < 1e-3 && value != 0.0;
    let number = if is_small { format!("{value:e}") } else { value.to_string() };
    format!("{mark}{number}")
}

fn described(name: &str, profile: &DeviceProfile) -> Value {
    let mut row = Map::new();
    row.insert("name".to_owned(), name.into());
    row.insert("device".to_owned(), profile.name.as_ref().into());
    row.extend(numbers(&COLUMNS, profile, &profile.assumed));
    row.insert("source".to_owned(), profile.source.as_ref().into());
    if let Some(turning) = &profile.turning {
        let mut about: Map<_, _> = numbers(&TURNING, turning, &turning.assumed).collect();
        about.insert("source".to_owned(), turning.source.as_ref().into());
        row.insert("turning".to_owned(), about.into());
    }
    if let Some(gripper) = &profile.gripper {
        let numbers: Map<_, _> = numbers(&GRIPPER, gripper, &[]).collect();
        row.insert("gripper".to_owned(), numbers.into());
    }
    if !profile.buttons.is_empty() {
        row.insert("buttons".to_owned(), json!(profile.buttons));
    }
    Value::Object(row)
}

/// The numbers of a profile with their units.
fn numbers<P>(
    columns: &[Column<P>],
    profile: &P,
    assumed: &[&str],
) -> impl Iterator<Item = (String, Value)> {
    columns.iter().map(move |column| {
        let number = json!({
            "value": (column.of)(profile),
            "unit": column.unit,
            "assumed": assumed.contains(&column.key),
        });
        (column.key.to_owned(), number)
    })
}
