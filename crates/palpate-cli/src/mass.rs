// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`: computes volume, mass and moments of the bodies of a scene.

use std::io::{self, Write};

use palpate::field::{Mass, MassLimits};
use palpate::scene::{AnyScene, BuiltBody, BuiltScene};
use serde_json::{Value, json};

use crate::arguments::MassOptions;
use crate::emptiness::is_empty;
use crate::input;
use crate::interrupt::Interrupt;
use crate::numbers::measured;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};

/// Computes the mass of each body; the answer is no if an error is above the tolerance, or a body
/// has none.
pub(crate) fn run(options: &MassOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene))?;
    match &named.scene {
        AnyScene::Planar(scene) => report(options, scene, ["m²", "kg/m", "kg·m"], interrupt),
        AnyScene::Spatial(scene) => report(options, scene, ["m³", "kg", "kg·m²"], interrupt),
    }
}

fn report<const D: usize>(
    options: &MassOptions,
    scene: &BuiltScene<D>,
    units: [&str; 3],
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let limits = MassLimits { tolerance: options.tolerance, cells: options.cells };
    let mut out = output::answer();
    let mut bodies = Vec::new();
    let mut outcome = Outcome::Yes;
    for (done, body) in scene.bodies.iter().enumerate() {
        // A single body may take half a minute.
        let (shape, density) = (body.shape.clone(), options.density);
        let mass = interrupt.unless_asked(move || shape.mass(density, limits));
        let Some(mass) = mass else {
            let all = output::counted(scene.bodies.len(), "body", "bodies");
            output::remark(format_args!("interrupted after {done} of {all}"));
            outcome = Outcome::Interrupted;
            break;
        };
        let name = &body.name;
        let mass = match mass {
            Ok(mass) => mass,
            Err(error) => {
                outcome = Outcome::No;
                if options.json {
                    bodies.push(json!({ "name": name, "problem": error.to_string() }));
                } else {
                    writeln!(out, "{}: {error}", shown(name))?;
                }
                continue;
            }
        };
        let is_open = mass.volume_error > options.tolerance * mass.volume;
        if is_open {
            outcome = Outcome::No;
        }
        if options.json {
            let is_empty = mass.is_zero() && body.shape.promise().has_interior;
            bodies.push(described(name, &mass, is_empty));
            continue;
        }
        let weighed = Weighed { body, mass, is_open, units };
        weighed.write(&mut out, options)?;
    }
    if options.json {
        out.json(&json!({ "density_kg_per_m3": options.density, "bodies": bodies }))?;
    }
    Ok(outcome)
}

/// A body that is weighed.
struct Weighed<'a, const D: usize> {
    body: &'a BuiltBody<D>,
    mass: Mass<D>,
    /// Whether an error is above the tolerance.
    is_open: bool,
    /// Of volumes, masses and moments.
    units: [&'a str; 3],
}

impl<const D: usize> Weighed<'_, D> {
    fn write(&self, out: &mut impl Write, options: &MassOptions) -> io::Result<()> {
        let Self { body, mass, is_open, units: [volume_unit, mass_unit, moment_unit] } = self;
        let (density, cells) = (options.density, mass.cells);
        let by = match cells {
            0 if !mass.is_zero() => "its faces".to_owned(),
            _ => format!("{cells} cells"),
        };
        writeln!(out, "{}, at {density} kg/m³ ({by})", shown(&body.name))?;
        if mass.is_zero() {
            let why = if body.shape.promise().has_interior {
                "empty: no point is in it, its volume is proven to be 0"
            } else {
                "no inside: curves and sheets have a volume of 0"
            };
            return writeln!(out, "  {why} {volume_unit}");
        }
        if *is_open {
            if is_empty(&body.shape).is_none() {
                writeln!(out, "  may be empty: no point was found in it")?;
            }
            let (share, asked) = (mass.volume_error / mass.volume, options.tolerance);
            writeln!(
                out,
                "  open: after {cells} cells the error is {share:.1e} of the volume, and \
                 --tolerance asks for {asked}; raise --cells"
            )?;
        }
        let one = |what: &str, value: f64, error: f64, unit: &str| {
            format!("  {what:<15}{} ± {error:.1e} {unit}", measured(value, error))
        };
        writeln!(out, "{}", one("volume", mass.volume, mass.volume_error, volume_unit))?;
        writeln!(out, "{}", one("mass", mass.mass(), mass.mass_error(), mass_unit))?;
        let row = |what: &str, values: &[f64], error: f64, unit: &str| {
            let values: Vec<_> = values.iter().map(|x| measured(*x, error)).collect();
            format!("  {what:<15}[{}] ± {error:.1e} {unit}", values.join(", "))
        };
        writeln!(out, "{}", row("centroid", &mass.centroid.0, mass.centroid_error, "m"))?;
        for (i, moments) in mass.second_moments.iter().enumerate() {
            let what = if i == 0 { "second moments" } else { "" };
            let moments = row(what, moments, mass.second_moments_error, moment_unit);
            writeln!(out, "{moments}")?;
        }
        Ok(())
    }
}

/// Writes infinite errors as null, and so the centroid of what has no volume.
fn described<const D: usize>(name: &str, mass: &Mass<D>, is_empty: bool) -> Value {
    let rows: Vec<_> = mass.second_moments.iter().map(|row| row.to_vec()).collect();
    json!({
        "name": name,
        "volume": mass.volume,
        "volume_error": mass.volume_error,
        "mass": mass.mass(),
        "mass_error": mass.mass_error(),
        "empty": is_empty,
        "centroid_m": (!mass.is_zero()).then(|| mass.centroid.0.to_vec()),
        "centroid_error_m": mass.centroid_error,
        "second_moments": rows,
        "second_moments_error": mass.second_moments_error,
        "cells": mass.cells,
    })
}
