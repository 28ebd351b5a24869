// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a surface feels like.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::check::{at_least, positive, positive_if};
use crate::problem::Problem;
use crate::schema::VectorSchema;

/// What a surface feels like.
///
/// A device that is not stiff enough scales stiffness and damping down; these
/// are what is wished for.
///
/// ```
/// use palpate_scene::Material;
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let rubber: Material = serde_json::from_str(r#"{ "stiffness": 300, "static_friction": 0.9 }"#)?;
/// assert_eq!(rubber.damping, Material::default().damping);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "an object")]
pub struct Material {
    /// What it is meant to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Force for each metre of depth [N/m]; 500 if left out, which the common
    /// desktop devices render.
    #[schemars(range(min = 0.0))]
    pub stiffness: f64,
    /// Force for each metre per second towards the surface [N·s/m]; 1 if left
    /// out.
    #[schemars(range(min = 0.0))]
    pub damping: f64,
    /// Greatest tangential over normal force while sticking; 0.4 if left out.
    #[schemars(range(min = 0.0))]
    pub static_friction: f64,
    /// Tangential over normal force while slipping, at most the static one; 0.3
    /// if left out.
    #[schemars(range(min = 0.0))]
    pub dynamic_friction: f64,
    /// Force for each metre per second inside the body, as in a liquid [N·s/m];
    /// 0 if left out.
    #[serde(skip_serializing_if = "crate::check::is_default")]
    #[schemars(range(min = 0.0))]
    pub viscosity: f64,
    /// A pull towards the surface from outside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub magnet: Option<Magnet>,
    /// When the surface gives way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pop_through: Option<PopThrough>,
    /// What is felt deeper in the body, each layer deeper than the one before.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
    /// A wave on the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<Texture>,
    /// What a tap on the surface rings like.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impact: Option<Impact>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            description: None,
            stiffness: 500.0,
            damping: 1.0,
            static_friction: 0.4,
            dynamic_friction: 0.3,
            viscosity: 0.0,
            magnet: None,
            pop_through: None,
            layers: Vec::new(),
            texture: None,
            impact: None,
        }
    }
}

/// A pull towards the surface from outside, which makes a tool snap onto it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct Magnet {
    /// What it is meant to be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The greatest pull [N].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub force: f64,
    /// How far from the surface it reaches [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub distance: f64,
}

/// When a surface gives way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct PopThrough {
    /// What it is meant to be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The normal force from which the surface no longer holds [N].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub force: f64,
    /// How far away a tool that went through must be before the surface holds
    /// again [m]; 0.001 if left out.
    #[serde(default = "one_millimetre")]
    #[schemars(range(min = 0.0))]
    pub distance: f64,
}

fn one_millimetre() -> f64 {
    1e-3
}

/// What is felt from a depth on: what is left out is as in the layer above.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct Layer {
    /// What it is meant to be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// How deep below the surface the layer begins [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub depth: f64,
    /// Force for each further metre of depth [N/m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub stiffness: Option<f64>,
    /// Force for each metre per second towards the surface [N·s/m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Greatest tangential over normal force while sticking.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub static_friction: Option<f64>,
    /// Tangential over normal force while slipping.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub dynamic_friction: Option<f64>,
    /// Force for each metre per second inside the layer [N·s/m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub viscosity: Option<f64>,
    /// When the top of this layer gives way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pop_through: Option<PopThrough>,
}

/// A sine wave on a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct Texture {
    /// What it is meant to be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// What the wave changes.
    pub kind: TextureKind,
    /// How far the wave rises above the mean surface [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub amplitude: f64,
    /// From crest to crest [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wavelength: f64,
    /// The direction from crest to crest in the body's coordinates; the product
    /// of waves along all axes if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<VectorSchema>")]
    pub direction: Option<Vec<f64>>,
}

/// What a texture changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum TextureKind {
    /// The surface itself: a tool rides over the crests.
    Displacement,
    /// The force alone, by the height of the wave under the tool.
    Height,
}

/// A decaying sinusoid for each tap (Okamura, Cutkosky and Dennerlein 2001):
/// `a · v · exp(−d·t) · sin(2π·f·t)` for a tap at normal speed v.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct Impact {
    /// What it is meant to be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Its amplitude a, for each metre per second of the tap [N·s/m].
    #[schemars(range(min = 0.0))]
    pub amplitude: f64,
    /// Its frequency f [Hz].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub frequency: f64,
    /// Its rate of decay d [1/s].
    #[schemars(range(min = 0.0))]
    pub decay: f64,
}

/// [N/m]
const STIFFNESS: &str = "N/m";
/// [N·s/m]
const DAMPING: &str = "N·s/m";

impl Material {
    /// What is wrong with the numbers, in a scene of `dimension`.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), Problem> {
        at_least("stiffness", self.stiffness, 0.0, STIFFNESS)?;
        at_least("damping", self.damping, 0.0, DAMPING)?;
        at_least("static_friction", self.static_friction, 0.0, "")?;
        at_least("dynamic_friction", self.dynamic_friction, 0.0, "")?;
        at_least("viscosity", self.viscosity, 0.0, DAMPING)?;
        check_frictions(self.static_friction, self.dynamic_friction)?;
        if let Some(magnet) = &self.magnet {
            magnet.check().map_err(|problem| problem.under("magnet"))?;
        }
        if let Some(pop) = &self.pop_through {
            pop.check().map_err(|problem| problem.under("pop_through"))?;
        }
        check_layers(self).map_err(|problem| problem.under("layers"))?;
        if let Some(texture) = &self.texture {
            texture.check(dimension).map_err(|problem| problem.under("texture"))?;
        }
        if let Some(impact) = &self.impact {
            impact.check().map_err(|problem| problem.under("impact"))?;
        }
        Ok(())
    }
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
        layer.check(above).map_err(|problem| problem.at(i))?;
        above = layer.depth;
        fixed = layer.static_friction.unwrap_or(fixed);
        slipping = layer.dynamic_friction.unwrap_or(slipping);
        check_frictions(fixed, slipping).map_err(|problem| problem.at(i))?;
    }
    Ok(())
}

impl Layer {
    fn check(&self, above: f64) -> Result<(), Problem> {
        positive("depth", self.depth, "m")?;
        if self.depth <= above {
            let message = format!(
                "must be more than that of the layer above, {above} m, got {} m",
                self.depth
            );
            return Err(Problem::about(message).under("depth"));
        }
        for (key, value, unit) in [
            ("stiffness", self.stiffness, STIFFNESS),
            ("damping", self.damping, DAMPING),
            ("static_friction", self.static_friction, ""),
            ("dynamic_friction", self.dynamic_friction, ""),
            ("viscosity", self.viscosity, DAMPING),
        ] {
            value.map_or(Ok(()), |value| at_least(key, value, 0.0, unit))?;
        }
        match &self.pop_through {
            Some(pop) => pop.check().map_err(|problem| problem.under("pop_through")),
            None => Ok(()),
        }
    }
}

impl Magnet {
    fn check(&self) -> Result<(), Problem> {
        positive("force", self.force, "N")?;
        positive("distance", self.distance, "m")
    }
}

impl PopThrough {
    fn check(&self) -> Result<(), Problem> {
        positive("force", self.force, "N")?;
        at_least("distance", self.distance, 0.0, "m")
    }
}

impl Texture {
    fn check(&self, dimension: usize) -> Result<(), Problem> {
        positive("amplitude", self.amplitude, "m")?;
        positive("wavelength", self.wavelength, "m")?;
        let Some(direction) = &self.direction else { return Ok(()) };
        crate::pose::direction(direction, dimension)
            .map_err(|problem| problem.under("direction"))
    }
}

impl Impact {
    fn check(&self) -> Result<(), Problem> {
        at_least("amplitude", self.amplitude, 0.0, DAMPING)?;
        positive_if("frequency", Some(self.frequency), "Hz")?;
        at_least("decay", self.decay, 0.0, "1/s")
    }
}
