// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mass`: computes volume, mass and moments of the bodies of a scene.

use std::io::Write;

use palpate::field::{Mass, MassLimits};
use palpate::scene::{AnyScene, BuiltScene};
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
    [volume_unit, mass_unit, moment_unit]: [&str; 3],
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let limits =
        MassLimits::default().with_tolerance(options.tolerance).with_cells(options.cells);
    let mut out = output::answer();
    let mut bodies = Vec::new();
    let mut outcome = Outcome::Yes;
    for (done, body) in scene.bodies.iter().enumerate() {
        // A single body may take half a minute.
        let (shape, density) = (body.shape.clone(), options.density);
        let mass = interrupt.unless_asked(move || shape.mass(density, limits));
        let Some(mass) = mass else {
            let all = scene.bodies.len();
            output::remark(format_args!("interrupted after {done} of {all} bodies"));
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
            bodies.push(described(name, &mass));
            continue;
        }
        writeln!(out, "{}, at {} kg/m³ ({} cells)", shown(name), options.density, mass.cells)?;
        if mass.is_zero() {
            let why = if body.shape.promise().has_interior {
                "empty: no point is in it, its volume is proven to be 0"
            } else {
                "no inside: curves and sheets have a volume of 0"
            };
            writeln!(out, "  {why} {volume_unit}")?;
            continue;
        }
        if is_open && is_empty(&body.shape).is_none() {
            writeln!(out, "  may be empty: no point was found in it")?;
        }
        if is_open {
            let (cells, asked) = (mass.cells, options.tolerance);
            let share = mass.volume_error / mass.volume;
            writeln!(
                out,
                "  open: after {cells} cells the error is {share:.1e} of the volume, and \
                 --tolerance asks for {asked}; raise --cells"
            )?;
        }
        let line = |what: &str, value: f64, error: f64, unit: &str| {
            format!("  {what:<15}{} ± {error:.1e} {unit}", measured(value, error))
        };
        writeln!(out, "{}", line("volume", mass.volume, mass.volume_error, volume_unit))?;
        writeln!(out, "{}", line("mass", mass.mass(), mass.mass_error(), mass_unit))?;
        let row = |numbers: &[f64], error: f64| {
            let numbers: Vec<_> = numbers.iter().map(|x| measured(*x, error)).collect();
            format!("[{}] ± {error:.1e}", numbers.join(", "))
        };
        let centroid = row(&mass.centroid.0, mass.centroid_error);
        writeln!(out, "  {:<15}{centroid} m", "centroid")?;
        for (i, moments) in mass.second_moments.iter().enumerate() {
            let what = if i == 0 { "second moments" } else { "" };
            let moments = row(moments, mass.second_moments_error);
            writeln!(out, "  {what:<15}{moments} {moment_unit}")?;
        }
    }
    if options.json {
        out.json(&json!({ "density_kg_per_m3": options.density, "bodies": bodies }))?;
    }
    Ok(outcome)
}

/// Writes infinite errors as null, and so the centroid of what is empty.
fn described<const D: usize>(name: &str, mass: &Mass<D>) -> Value {
    let rows: Vec<_> = mass.second_moments.iter().map(|row| row.to_vec()).collect();
    json!({
        "name": name,
        "volume": mass.volume,
        "volume_error": mass.volume_error,
        "mass": mass.mass(),
        "mass_error": mass.mass_error(),
        "empty": mass.is_zero(),
        "centroid_m": (!mass.is_zero()).then(|| mass.centroid.0.to_vec()),
        "centroid_error_m": mass.centroid_error,
        "second_moments": rows,
        "second_moments_error": mass.second_moments_error,
        "cells": mass.cells,
    })
}
