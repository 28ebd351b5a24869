// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `palpate identify` prints.

use std::collections::BTreeMap;
use std::io::{self, Write};

use palpate::device::DeviceProfile;
use palpate::sim::{DeviceAxis, EncoderStep, Estimate, Identified, IdentifiedAxis};
use serde::Serialize;

use crate::identify::IdentifyOptions;
use crate::outcome::Failure;
use crate::output::{self, Destination};
use palpate::scene::text::{measured, rounded};

/// What was found, beside what was assumed and what the simulated device is made of.
pub(super) struct Report<'a> {
    pub(super) options: &'a IdentifyOptions,
    pub(super) profile: &'a DeviceProfile,
    pub(super) plant: &'a DeviceProfile,
    pub(super) found: &'a Identified,
    pub(super) out: Option<&'a Destination>,
}

/// Mass, damping, friction and encoder step of an axis.
struct Numbers {
    mass: f64,
    damping: f64,
    friction: f64,
    encoder_step: f64,
}

impl Numbers {
    fn of(profile: &DeviceProfile, axis: DeviceAxis) -> Self {
        match (axis, &profile.turning) {
            (DeviceAxis::About(_), Some(turning)) => Self {
                mass: turning.inertia,
                damping: turning.least_damping,
                friction: turning.friction,
                encoder_step: turning.encoder_step,
            },
            _ => Self {
                mass: profile.mass,
                damping: profile.least_damping,
                friction: profile.friction,
                encoder_step: profile.encoder_step,
            },
        }
    }
}

/// A number that was found, with what else is known of it.
struct Row {
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    found: Estimate,
    is_seen: bool,
    profile: f64,
    made_with: f64,
}

impl Report<'_> {
    pub(super) fn print(&self) -> Result<(), Failure> {
        let mut out = output::answer();
        if self.options.json {
            out.json(&self.answer())?;
            return Ok(());
        }
        writeln!(
            out,
            "{}, simulated, at {} Hz, seed {}",
            self.profile.name, self.options.rate, self.options.seed
        )?;
        for axis in &self.found.axes {
            self.write_axis(&mut out, axis)?;
        }
        if self.found.is_turning_unknown {
            writeln!(
                out,
                "its wrist gives no torque: inertia, damping, friction and step about its axes stay \
                 those of the profile"
            )?;
        }
        match self.out {
            Some(path) => writeln!(out, "wrote {}", path.name().display())?,
            None if self.options.out.is_none() => {
                writeln!(out, "no profile is written: name a file by --out")?;
            }
            None => {}
        }
        Ok(())
    }

    fn write_axis(&self, out: &mut impl Write, axis: &IdentifiedAxis) -> io::Result<()> {
        writeln!(
            out,
            "{}: {} strokes in {:.1} s, misfit {:.2} (good: {} at most)",
            axis.axis,
            axis.strokes,
            axis.time,
            axis.misfit,
            IdentifiedAxis::GOOD_MISFIT
        )?;
        if !axis.is_fitted() {
            writeln!(
                out,
                "  it moves otherwise than a mass with damping and friction, as where a hand holds it \
                 softly: let go of it, and try again"
            )?;
        }
        for row in self.rows(axis) {
            writeln!(out, "  {:<13} {}", row.name, row.said(axis))?;
        }
        if let EncoderStep::Unseen(least) = axis.encoder_step {
            let (least, unit) = (rounded(least), axis.axis.length_unit());
            writeln!(out, "  its readings show no steps above {least} {unit}")?;
        }
        if matches!(axis.encoder_step, EncoderStep::Uneven(_)) {
            writeln!(out, "  its steps have no common length; the largest counts")?;
        }
        match axis.softest_spring {
            Some(softest) => {
                let (softest, unit) = (rounded(softest), axis.axis.stiffness_unit());
                writeln!(
                    out,
                    "  a hand that holds it by less than {softest} {unit} is not noticed"
                )?;
            }
            None => writeln!(out, "  a hand that holds it would not be noticed")?,
        }
        if axis.has_weight() {
            let (force, unit) = (rounded(axis.offset.value), axis.axis.force_unit());
            writeln!(
                out,
                "  a constant force of {force} {unit} pulls: balance the handle's weight"
            )?;
        }
        Ok(())
    }

    fn rows(&self, axis: &IdentifiedAxis) -> [Row; 4] {
        let assumed = Numbers::of(self.profile, axis.axis);
        let made = Numbers::of(self.plant, axis.axis);
        let is_turning = matches!(axis.axis, DeviceAxis::About(_));
        let mass = if is_turning { ["inertia"; 2] } else { ["mass"; 2] };
        let row = |[key, name]: [&'static str; 2],
                   unit,
                   found: Estimate,
                   profile,
                   made_with| {
            Row { key, name, unit, found, is_seen: found.is_seen(), profile, made_with }
        };
        let at = axis.axis;
        let step = Estimate { value: axis.encoder_step.size(), error: 0.0 };
        let mut rows = [
            row(mass, at.mass_unit(), axis.mass, assumed.mass, made.mass),
            row(["damping"; 2], at.damping_unit(), axis.damping, assumed.damping, made.damping),
            row(
                ["friction"; 2],
                at.force_unit(),
                axis.friction,
                assumed.friction,
                made.friction,
            ),
            row(
                ["encoder_step", "encoder step"],
                at.length_unit(),
                step,
                assumed.encoder_step,
                made.encoder_step,
            ),
        ];
        // The step is read and not fitted.
        let [fitted @ .., _] = &mut rows;
        fitted.iter_mut().for_each(|row| row.is_seen &= axis.is_fitted());
        rows
    }

    fn answer(&self) -> Answer {
        let axis = |axis: &IdentifiedAxis| {
            let number = |row: Row| Number {
                value: row.found.value,
                error: row.found.error,
                unit: row.unit,
                is_seen: row.is_seen,
                profile: row.profile,
                made_with: row.made_with,
            };
            Axis {
                axis: axis.axis.to_string(),
                strokes: axis.strokes,
                time: axis.time,
                misfit: axis.misfit,
                softest_spring: axis.softest_spring,
                offset: Offset {
                    value: axis.offset.value,
                    error: axis.offset.error,
                    unit: axis.axis.force_unit(),
                },
                has_weight: axis.has_weight(),
                steps: match axis.encoder_step {
                    EncoderStep::Even(_) => "even",
                    EncoderStep::Uneven(_) => "uneven",
                    EncoderStep::Unseen(_) => "unseen",
                },
                numbers: self.rows(axis).map(|row| (row.key, number(row))).into(),
            }
        };
        Answer {
            device: self.profile.name.to_string(),
            rate: self.options.rate,
            seed: self.options.seed,
            axes: self.found.axes.iter().map(axis).collect(),
            is_turning_unknown: self.found.is_turning_unknown,
            written: self.out.map(|out| out.name().display().to_string()),
        }
    }
}

/// The answer of `palpate identify`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The name of the device.
    device: String,
    /// Ticks a second [Hz].
    rate: f64,
    /// The seed of the motions.
    seed: u64,
    /// The axes, those of translation first.
    axes: Vec<Axis>,
    /// `true` if the device senses its orientation but gives no torque.
    is_turning_unknown: bool,
    /// The profile that was written.
    written: Option<String>,
}

/// What was found of an axis: mass or inertia, damping, friction and encoder step.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Axis {
    /// The axis.
    axis: String,
    /// Strokes that were evaluated.
    strokes: u64,
    /// The time of all motions [s].
    time: f64,
    /// The misfit of the model: about 1 where it is right.
    misfit: f64,
    /// The softest spring by which a hand may hold the handle and be noticed [N/m], or [N·m/rad].
    softest_spring: Option<f64>,
    /// A constant force beside the motors'.
    offset: Offset,
    /// `true` if that force is weight that is not balanced.
    has_weight: bool,
    /// The steps of the encoder: `even`, `uneven` or `unseen`.
    steps: &'static str,
    #[serde(flatten)]
    numbers: BTreeMap<&'static str, Number>,
}

/// A constant force [N], or torque [N·m].
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Offset {
    /// The number.
    value: f64,
    /// Two standard deviations.
    error: f64,
    /// The unit.
    unit: &'static str,
}

/// A number that was found.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Number {
    /// The number.
    value: f64,
    /// Two standard deviations.
    error: f64,
    /// The unit.
    unit: &'static str,
    /// `true` if the motions tell the number.
    is_seen: bool,
    /// The number of the profile.
    profile: f64,
    /// The number of the simulated device.
    made_with: f64,
}

impl Row {
    fn said(&self, axis: &IdentifiedAxis) -> String {
        let Self { found, unit, profile, made_with, .. } = self;
        let number = if self.is_seen {
            if found.error > 0.0 {
                let [value, error] =
                    [found.value, found.error].map(|x| measured(x, found.error));
                format!("{value} ± {error} {unit}")
            } else {
                format!("{} {unit}", rounded(found.value))
            }
        } else if !axis.is_fitted() {
            format!("cannot be told: {} {unit} is nearest", rounded(found.value))
        } else {
            let (least, most) = (rounded(found.least()), rounded(found.most()));
            format!("cannot be told: from {least} to {most} {unit}")
        };
        format!(
            "{number}; {}; {}",
            beside(found.value, *profile),
            made(found.value, *made_with)
        )
    }
}

/// A number beside the one that was assumed.
fn beside(found: f64, assumed: f64) -> String {
    let said = rounded(assumed);
    let part = 100.0 * (found / assumed - 1.0);
    if found == assumed || part.abs() < 1.0 {
        format!("as the profile's {said}")
    } else if part.is_finite() {
        format!("{part:+.0} % of the profile's {said}")
    } else {
        format!("beside the profile's {said}")
    }
}

/// A number beside the one of the simulated device.
fn made(found: f64, truth: f64) -> String {
    let part = 100.0 * (found / truth - 1.0).abs();
    if part.is_finite() {
        format!("within {part:.2} % of what it was made with")
    } else {
        format!("it was made with {}", rounded(truth))
    }
}
