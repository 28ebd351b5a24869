// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The rules of a material's numbers, with the place of what breaks them.

use palpate_haptics::{Impact, Layer, Magnet, Material, PopThrough, Texture};

use crate::check::{at_least, positive, positive_if};
use crate::problem::Problem;

/// [N/m]
const STIFFNESS: &str = "N/m";
/// [N·s/m]
const DAMPING: &str = "N·s/m";

/// What is wrong with the numbers of a material, in a scene of `dimension`.
pub(crate) fn check(material: &Material, dimension: usize) -> Result<(), Problem> {
    at_least("stiffness", material.stiffness, 0.0, STIFFNESS)?;
    at_least("damping", material.damping, 0.0, DAMPING)?;
    at_least("static_friction", material.static_friction, 0.0, "")?;
    at_least("dynamic_friction", material.dynamic_friction, 0.0, "")?;
    at_least("viscosity", material.viscosity, 0.0, DAMPING)?;
    check_frictions(material.static_friction, material.dynamic_friction)?;
    if let Some(magnet) = &material.magnet {
        check_magnet(magnet).map_err(|problem| problem.under("magnet"))?;
    }
    if let Some(pop) = &material.pop_through {
        check_pop_through(pop).map_err(|problem| problem.under("pop_through"))?;
    }
    check_layers(material).map_err(|problem| problem.under("layers"))?;
    if let Some(texture) = &material.texture {
        check_texture(texture, dimension).map_err(|problem| problem.under("texture"))?;
    }
    if let Some(impact) = &material.impact {
        check_impact(impact).map_err(|problem| problem.under("impact"))?;
    }
    Ok(())
}

fn check_frictions(static_friction: f64, dynamic_friction: f64) -> Result<(), Problem> {
    if dynamic_friction <= static_friction {
        return Ok(());
    }
    let message = format!(
        "must be at most the static friction {static_friction}, got {dynamic_friction}"
    );
    Err(Problem::about(message).under("dynamic_friction"))
}

fn check_layers(material: &Material) -> Result<(), Problem> {
    let mut above = 0.0;
    let (mut fixed, mut slipping) = (material.static_friction, material.dynamic_friction);
    for (i, layer) in material.layers.iter().enumerate() {
        check_layer(layer, above).map_err(|problem| problem.at(i))?;
        above = layer.depth;
        fixed = layer.static_friction.unwrap_or(fixed);
        slipping = layer.dynamic_friction.unwrap_or(slipping);
        check_frictions(fixed, slipping).map_err(|problem| problem.at(i))?;
    }
    Ok(())
}

fn check_layer(layer: &Layer, above: f64) -> Result<(), Problem> {
    positive("depth", layer.depth, "m")?;
    if layer.depth <= above {
        let message = format!(
            "must be more than that of the layer above, {above} m, got {} m",
            layer.depth
        );
        return Err(Problem::about(message).under("depth"));
    }
    for (key, value, unit) in [
        ("stiffness", layer.stiffness, STIFFNESS),
        ("damping", layer.damping, DAMPING),
        ("static_friction", layer.static_friction, ""),
        ("dynamic_friction", layer.dynamic_friction, ""),
        ("viscosity", layer.viscosity, DAMPING),
    ] {
        value.map_or(Ok(()), |value| at_least(key, value, 0.0, unit))?;
    }
    match &layer.pop_through {
        Some(pop) => check_pop_through(pop).map_err(|problem| problem.under("pop_through")),
        None => Ok(()),
    }
}

fn check_magnet(magnet: &Magnet) -> Result<(), Problem> {
    positive("force", magnet.force, "N")?;
    positive("distance", magnet.distance, "m")
}

fn check_pop_through(pop: &PopThrough) -> Result<(), Problem> {
    positive("force", pop.force, "N")?;
    at_least("distance", pop.distance, 0.0, "m")
}

fn check_texture(texture: &Texture, dimension: usize) -> Result<(), Problem> {
    positive("amplitude", texture.amplitude, "m")?;
    positive("wavelength", texture.wavelength, "m")?;
    let Some(direction) = &texture.direction else { return Ok(()) };
    crate::pose::direction(direction, dimension).map_err(|problem| problem.under("direction"))
}

fn check_impact(impact: &Impact) -> Result<(), Problem> {
    at_least("amplitude", impact.amplitude, 0.0, DAMPING)?;
    positive_if("frequency", Some(impact.frequency), "Hz")?;
    at_least("decay", impact.decay, 0.0, "1/s")
}
