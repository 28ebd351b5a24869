// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles of devices as files.

use std::path::Path;

use palpate_device::{Buttons, DeviceProfile, GripperProfile, TurningProfile};
use serde::{Deserialize, Serialize};

use crate::encoding::utf8;
use crate::file::read_file;
use crate::json::{self, Document, Source};
use crate::names::unknown as unknown_name;
use crate::problem::{
    Problem, Problems, SceneError, SceneProblem, at_least, positive, version,
};

/// The version of the format.
const VERSION: u64 = 1;

/// The largest file of a device [bytes]: a hundred times as much as any has.
const LARGEST_FILE: u64 = 1 << 20;

/// Stands in for a number that is missing, so that the rest of the file can be checked. No device has
/// it, and problems with it are not told, as the missing key is.
pub(crate) const UNKNOWN: f64 = -1.0;

/// The keys of the numbers that a file has to have, in any of its objects.
pub(crate) fn numbers() -> impl Iterator<Item = &'static str> {
    let gripper = ["max_opening", "max_force", "max_force_rate"];
    let all = DeviceProfile::NUMBERS.iter().chain(TurningProfile::NUMBERS).copied();
    all.chain(gripper)
}

/// A [`DeviceProfile`] as a file gives it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct WrittenDevice {
    palpate_device: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    description: Option<String>,
    device: String,
    max_force: f64,
    continuous_force: f64,
    max_force_rate: f64,
    max_stiffness: f64,
    max_damping: f64,
    workspace_radius: f64,
    mass: f64,
    least_damping: f64,
    friction: f64,
    encoder_step: f64,
    max_speed: f64,
    max_acceleration: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    turning: Option<WrittenTurning>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gripper: Option<WrittenGripper>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    buttons: Vec<String>,
    source: String,
    #[serde(default)]
    assumed: Vec<String>,
}

/// A [`GripperProfile`] as a file gives it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct WrittenGripper {
    max_opening: f64,
    max_force: f64,
    max_force_rate: f64,
}

/// A [`TurningProfile`] as a file gives it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct WrittenTurning {
    max_torque: f64,
    continuous_torque: f64,
    max_torque_rate: f64,
    max_stiffness: f64,
    max_damping: f64,
    inertia: f64,
    least_damping: f64,
    friction: f64,
    encoder_step: f64,
    max_speed: f64,
    max_acceleration: f64,
    source: String,
    #[serde(default)]
    assumed: Vec<String>,
}

/// Reads the profile of a device from the bytes of a JSON file, whose keys `docs/formats.md`
/// lists.
///
/// # Errors
///
/// All that is wrong, with paths, lines and columns: a number that is missing, not finite or not
/// in its range, a name in `assumed` that is no number of a device, a text that is no JSON.
///
/// # Examples
///
/// ```
/// use palpate_device::profile_named;
/// use palpate_scene::{device_from_json, device_to_json};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let omega = profile_named("omega7")?;
/// let text = device_to_json(&omega)?;
/// assert_eq!(device_from_json(text.as_bytes())?, omega);
///
/// let wrong = text.replace("\"mass\": 0.25", "\"mass\": -0.25");
/// let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
/// assert_eq!(error, "mass, line 10: mass must be positive, got -0.25 kg");
/// # Ok(())
/// # }
/// ```
pub fn device_from_json(bytes: &[u8]) -> Result<DeviceProfile, SceneError> {
    let text = utf8(bytes).map_err(|error| Problem::new(error.to_string()))?;
    let source = Source::of(text);
    let written: WrittenDevice = Document::parse(&source)?.read(check)?;
    Ok(profile(written))
}

/// Reads the profile of the file at `path`, as [`device_from_json`].
///
/// # Errors
///
/// As `device_from_json`; if the file cannot be read, or has more than 1 MiB, an error without place
/// that names it.
pub fn device_from_file(path: impl AsRef<Path>) -> Result<DeviceProfile, SceneError> {
    let path = path.as_ref();
    let bytes =
        read_file(path, LARGEST_FILE).map_err(|error| SceneProblem::of_file(path, &error))?;
    device_from_json(&bytes)
}

/// The text of a file from which [`device_from_json`] reads the same profile.
///
/// # Errors
///
/// If a number is not finite or not in its range, as those of a device without limits, which
/// JSON does not hold.
pub fn device_to_json(profile: &DeviceProfile) -> Result<String, SceneError> {
    let written = written(profile);
    if let Err(problems) = check(&written) {
        return Err(SceneError::of(
            problems.into_vec().into_iter().map(|problem| problem.located(None)),
        ));
    }
    // Serialisation of plain data to a value has no way to fail.
    Ok(json::write(&serde_json::to_value(written).unwrap_or_default()))
}

fn check(written: &WrittenDevice) -> Result<(), Problems> {
    let version = version("palpate_device", written.palpate_device, VERSION);
    let forces = written.max_force != 0.0;
    let numbers = check_numbers(
        forces,
        &[
            ("max_force", written.max_force, NotNegative, "N"),
            ("continuous_force", written.continuous_force, OfForces, "N"),
            ("max_force_rate", written.max_force_rate, OfForces, "N/s"),
            ("max_stiffness", written.max_stiffness, OfForces, "N/m"),
            ("max_damping", written.max_damping, NotNegative, "N·s/m"),
            ("workspace_radius", written.workspace_radius, Positive, "m"),
            ("mass", written.mass, Positive, "kg"),
            ("least_damping", written.least_damping, NotNegative, "N·s/m"),
            ("friction", written.friction, NotNegative, "N"),
            ("encoder_step", written.encoder_step, NotNegative, "m"),
            ("max_speed", written.max_speed, Positive, "m/s"),
            ("max_acceleration", written.max_acceleration, Positive, "m/s²"),
        ],
    );
    let needed = Problems::all([
        at_most_peak(
            ["continuous_force", "max_force"],
            written.continuous_force,
            written.max_force,
            "N",
        ),
        friction_of_steps(forces, written.encoder_step, written.friction, "N"),
    ]);
    let texts = Problems::all([
        one_line("device", &written.device),
        one_line("source", &written.source),
    ]);
    let turning = written.turning.as_ref().map_or(Ok(()), check_turning);
    let gripper = written.gripper.as_ref().map_or(Ok(()), check_gripper);
    Problems::all([
        version.map_err(Problems::from),
        numbers,
        needed,
        texts,
        check_assumed(&written.assumed, DeviceProfile::NUMBERS),
        turning.map_err(|problems| problems.under("turning")),
        gripper.map_err(|problems| problems.under("gripper")),
        check_buttons(&written.buttons),
    ])
}

fn check_gripper(gripper: &WrittenGripper) -> Result<(), Problems> {
    check_numbers(
        gripper.max_force != 0.0,
        &[
            ("max_opening", gripper.max_opening, Positive, "m"),
            ("max_force", gripper.max_force, NotNegative, "N"),
            ("max_force_rate", gripper.max_force_rate, OfForces, "N/s"),
        ],
    )
}

/// The names of buttons, whose places are their indices.
fn check_buttons(names: &[String]) -> Result<(), Problems> {
    let most = usize::from(Buttons::MOST);
    if names.len() > most {
        let message = format!("must be at most {most} names, got {}", names.len());
        return Err(Problem::about(message).under("buttons").into());
    }
    let wrong = names.iter().enumerate().map(|(i, name)| {
        let wrong = if name.is_empty() {
            Some("must have a name".to_owned())
        } else if name.contains(char::is_control) {
            Some("must be one line without control characters".to_owned())
        } else if names.iter().take(i).any(|before| before == name) {
            Some(format!("two buttons are named \"{name}\""))
        } else {
            None
        };
        wrong.map_or(Ok(()), |wrong| Err(Problem::new(wrong).at(i).under("buttons")))
    });
    Problems::all(wrong)
}

fn check_turning(turning: &WrittenTurning) -> Result<(), Problems> {
    let torques = turning.max_torque != 0.0;
    let numbers = check_numbers(
        torques,
        &[
            ("max_torque", turning.max_torque, NotNegative, "N·m"),
            ("continuous_torque", turning.continuous_torque, OfForces, "N·m"),
            ("max_torque_rate", turning.max_torque_rate, OfForces, "N·m/s"),
            ("max_stiffness", turning.max_stiffness, OfForces, "N·m/rad"),
            ("max_damping", turning.max_damping, NotNegative, "N·m·s/rad"),
            ("inertia", turning.inertia, Positive, "kg·m²"),
            ("least_damping", turning.least_damping, NotNegative, "N·m·s/rad"),
            ("friction", turning.friction, NotNegative, "N·m"),
            ("encoder_step", turning.encoder_step, NotNegative, "rad"),
            ("max_speed", turning.max_speed, Positive, "rad/s"),
            ("max_acceleration", turning.max_acceleration, Positive, "rad/s²"),
        ],
    );
    let needed = Problems::all([
        at_most_peak(
            ["continuous_torque", "max_torque"],
            turning.continuous_torque,
            turning.max_torque,
            "N·m",
        ),
        friction_of_steps(torques, turning.encoder_step, turning.friction, "N·m"),
    ]);
    Problems::all([
        numbers,
        needed,
        one_line("source", &turning.source).map_err(Problems::from),
        check_assumed(&turning.assumed, TurningProfile::NUMBERS),
    ])
}

/// What a device gives without time limit is at most its largest, if that is a number.
fn at_most_peak(
    [lasting, peak]: [&str; 2],
    value: f64,
    most: f64,
    unit: &str,
) -> Result<(), Problem> {
    // A largest that is wrong is told alone; so is a value that is NaN.
    if !(most >= 0.0 && value > most) {
        return Ok(());
    }
    let message = format!("must be at most {peak}, {most} {unit}, got {value} {unit}");
    Err(Problem::about(message).under(lasting))
}

/// No number of a device is as far from one as this, in any unit of a profile.
const LARGEST: f64 = 1e9;

/// What holds for a number of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Range {
    Positive,
    NotNegative,
    /// Positive for a device that gives forces, and not negative for one that does not.
    OfForces,
}
use Range::{NotNegative, OfForces, Positive};

/// Checks numbers, each with its key, its range and its unit, of a device that gives `forces` or not.
fn check_numbers(forces: bool, numbers: &[(&str, f64, Range, &str)]) -> Result<(), Problems> {
    let checked = numbers.iter().map(|&(key, value, range, unit)| {
        if range == Positive || range == OfForces && forces {
            positive(key, value, unit)?;
        } else {
            at_least(key, value, 0.0, unit)?;
        }
        check_size(key, value)
    });
    Problems::all(checked)
}

/// A number is zero, or neither smaller nor larger than any device's.
fn check_size(key: &str, value: f64) -> Result<(), Problem> {
    let least = 1.0 / LARGEST;
    if value == 0.0 || (least..=LARGEST).contains(&value) {
        return Ok(());
    }
    let message = format!("must be from {least:e} to {LARGEST:e} in size, got {value:e}");
    Err(Problem::about(message).under(key))
}

/// A wall is passive on a device with encoder steps only up to a stiffness of `2 f_c / Δ`; a device
/// without forces renders none.
fn friction_of_steps(
    forces: bool,
    step: f64,
    friction: f64,
    unit: &str,
) -> Result<(), Problem> {
    if forces && step > 0.0 && friction == 0.0 {
        let message = format!("must be positive beside encoder steps, got 0 {unit}");
        return Err(Problem::about(message).under("friction"));
    }
    Ok(())
}

fn one_line(key: &str, text: &str) -> Result<(), Problem> {
    if text.contains(char::is_control) {
        let message = "must be one line without control characters".to_owned();
        return Err(Problem::about(message).under(key));
    }
    Ok(())
}

fn check_assumed(assumed: &[String], known: &[&str]) -> Result<(), Problems> {
    let wrong = assumed.iter().enumerate().map(|(i, name)| {
        let message = if !known.contains(&name.as_str()) {
            unknown_name("number of a device", name, known)
        } else if assumed.iter().take(i).any(|before| before == name) {
            format!("`{name}` is listed twice")
        } else {
            return Ok(());
        };
        Err(Problem::new(message).at(i).under("assumed"))
    });
    Problems::all(wrong)
}

/// The names of `assumed` as a profile holds them.
fn names(assumed: &[String], known: &[&'static str]) -> Vec<&'static str> {
    let is_assumed = |name: &&&str| assumed.iter().any(|assumed| assumed == **name);
    known.iter().filter(is_assumed).copied().collect()
}

fn profile(written: WrittenDevice) -> DeviceProfile {
    let profile = (DeviceProfile {
        max_force: written.max_force,
        continuous_force: written.continuous_force,
        max_force_rate: written.max_force_rate,
        max_stiffness: written.max_stiffness,
        max_damping: written.max_damping,
        workspace_radius: written.workspace_radius,
        mass: written.mass,
        least_damping: written.least_damping,
        friction: written.friction,
        encoder_step: written.encoder_step,
        max_speed: written.max_speed,
        max_acceleration: written.max_acceleration,
        source: written.source.into(),
        assumed: names(&written.assumed, DeviceProfile::NUMBERS).into(),
        ..DeviceProfile::unlimited(written.device)
    })
    .with_buttons(written.buttons);
    let profile = match written.turning {
        Some(turning) => DeviceProfile { turning: Some(turning_profile(turning)), ..profile },
        None => profile,
    };
    match written.gripper {
        Some(WrittenGripper { max_opening, max_force, max_force_rate }) => {
            let gripper = GripperProfile::new(max_opening, max_force);
            DeviceProfile {
                gripper: Some(GripperProfile { max_force_rate, ..gripper }),
                ..profile
            }
        }
        None => profile,
    }
}

fn turning_profile(written: WrittenTurning) -> TurningProfile {
    TurningProfile {
        max_torque: written.max_torque,
        continuous_torque: written.continuous_torque,
        max_torque_rate: written.max_torque_rate,
        max_stiffness: written.max_stiffness,
        max_damping: written.max_damping,
        inertia: written.inertia,
        least_damping: written.least_damping,
        friction: written.friction,
        encoder_step: written.encoder_step,
        max_speed: written.max_speed,
        max_acceleration: written.max_acceleration,
        assumed: names(&written.assumed, TurningProfile::NUMBERS).into(),
        source: written.source.into(),
    }
}

fn written(profile: &DeviceProfile) -> WrittenDevice {
    WrittenDevice {
        palpate_device: VERSION,
        description: None,
        device: profile.name.to_string(),
        max_force: profile.max_force,
        continuous_force: profile.continuous_force,
        max_force_rate: profile.max_force_rate,
        max_stiffness: profile.max_stiffness,
        max_damping: profile.max_damping,
        workspace_radius: profile.workspace_radius,
        mass: profile.mass,
        least_damping: profile.least_damping,
        friction: profile.friction,
        encoder_step: profile.encoder_step,
        max_speed: profile.max_speed,
        max_acceleration: profile.max_acceleration,
        turning: profile.turning.as_ref().map(|turning| WrittenTurning {
            max_torque: turning.max_torque,
            continuous_torque: turning.continuous_torque,
            max_torque_rate: turning.max_torque_rate,
            max_stiffness: turning.max_stiffness,
            max_damping: turning.max_damping,
            inertia: turning.inertia,
            least_damping: turning.least_damping,
            friction: turning.friction,
            encoder_step: turning.encoder_step,
            max_speed: turning.max_speed,
            max_acceleration: turning.max_acceleration,
            source: turning.source.to_string(),
            assumed: turning.assumed.iter().map(|name| (*name).to_owned()).collect(),
        }),
        gripper: profile.gripper.map(|gripper| WrittenGripper {
            max_opening: gripper.max_opening,
            max_force: gripper.max_force,
            max_force_rate: gripper.max_force_rate,
        }),
        buttons: profile.buttons.iter().map(ToString::to_string).collect(),
        source: profile.source.to_string(),
        assumed: profile.assumed.iter().map(|name| (*name).to_owned()).collect(),
    }
}
