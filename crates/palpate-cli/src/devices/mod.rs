// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate devices`: profiles of devices and actuators.

use std::collections::BTreeMap;
use std::io::Write;

use clap::Args;
use palpate::device::{DeviceProfile, GripperProfile, PROFILES, TurningProfile};
use serde::Serialize;

use crate::arguments::ProfileChoice;
use crate::arguments::numbers::positive;
use crate::outcome::{Failure, Outcome};
use crate::output;

pub(crate) mod actuators;
pub(crate) mod rendered;
pub(crate) mod stability;

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
        let devices = listed.iter().map(|(name, profile)| Device::of(name, profile)).collect();
        out.json(&Answer { devices })?;
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

/// The answer of `palpate devices`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The devices.
    devices: Vec<Device>,
}

/// A device, with a figure for each number of its profile.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Device {
    /// Its name on the command line.
    name: String,
    /// Its name.
    device: String,
    #[serde(flatten)]
    figures: BTreeMap<&'static str, Figure>,
    /// Where the numbers are from.
    source: String,
    /// About its axes; `null` without rotation.
    turning: Option<Turning>,
    /// Between its fingers; `null` without a gripper.
    gripper: Option<BTreeMap<&'static str, Figure>>,
    /// The names of its buttons.
    buttons: Vec<String>,
}

/// A device about its axes.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Turning {
    #[serde(flatten)]
    figures: BTreeMap<&'static str, Figure>,
    /// Where the numbers are from.
    source: String,
}

/// A number of a profile.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Figure {
    /// The number.
    value: f64,
    /// Its unit.
    unit: &'static str,
    /// `true` if it is not from the source.
    is_assumed: bool,
}

impl Device {
    fn of(name: &str, profile: &DeviceProfile) -> Self {
        let turning = profile.turning.as_ref().map(|turning| Turning {
            figures: figures(&TURNING, turning, &turning.assumed),
            source: turning.source.to_string(),
        });
        Self {
            name: name.to_owned(),
            device: profile.name.to_string(),
            figures: figures(&COLUMNS, profile, &profile.assumed),
            source: profile.source.to_string(),
            turning,
            gripper: profile.gripper.as_ref().map(|gripper| figures(&GRIPPER, gripper, &[])),
            buttons: profile.buttons.iter().map(ToString::to_string).collect(),
        }
    }
}

/// The numbers of a profile with their units.
fn figures<P>(
    columns: &[Column<P>],
    profile: &P,
    assumed: &[&str],
) -> BTreeMap<&'static str, Figure> {
    let figures = columns.iter().map(|Column { key, unit, of, .. }| {
        (*key, Figure { value: of(profile), unit, is_assumed: assumed.contains(key) })
    });
    figures.collect()
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate devices
  palpate devices --json
  palpate devices --actuators
  palpate devices --materials --rate 4000
  palpate devices --profile falcon.json
  palpate devices --stability --profile omega --material steel --material rubber";

/// The options of `palpate devices`.
#[derive(Args, Debug)]
pub(crate) struct DevicesOptions {
    /// What each device with forces renders of each material by name: stiffness [N/m] / damping
    /// [N·s/m].
    #[arg(long)]
    pub(crate) materials: bool,
    /// The actuators for `palpate feel --actuator` alone.
    #[arg(long, conflicts_with = "materials")]
    pub(crate) actuators: bool,
    /// How hands rest on walls where devices have other damping, friction, encoder steps and delays
    /// than their profiles say: the worst of 108 presses of ten simulated seconds at 1 kHz for each
    /// device, material and delay.
    #[arg(long, conflicts_with_all = ["materials", "actuators"])]
    pub(crate) stability: bool,
    /// A material by name of which the walls are; may be given several times.
    #[arg(long, value_name = "NAME", requires = "stability", conflicts_with_all = ["materials", "actuators"], default_values = ["steel"])]
    pub(crate) material: Vec<String>,
    /// One device in place of all: its name, or a JSON file with its profile.
    #[arg(long, value_name = "NAME|JSON", conflicts_with = "actuators")]
    pub(crate) profile: Option<ProfileChoice>,
    /// Ticks a second, on which what devices render of materials depends [Hz].
    #[arg(long, requires = "materials", conflicts_with_all = ["stability", "actuators"], default_value = "1000", allow_negative_numbers = true, value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
