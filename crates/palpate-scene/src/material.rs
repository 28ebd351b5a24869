// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Materials of scenes.

use std::fmt;

use palpate_haptics::{Impact, Layer, Magnet, Material, PopThrough, Texture};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::names::unknown;
use crate::problem::{Problem, Problems, at_least, part_if, positive, positive_if};

/// [N/m]
const STIFFNESS: &str = "N/m";
/// [N·s/m]
const DAMPING: &str = "N·s/m";

/// What is wrong with the numbers of a material, in a scene of `dimension`.
pub(crate) fn check(material: &Material, dimension: usize) -> Result<(), Problems> {
    let numbers = [
        at_least("stiffness", material.stiffness, 0.0, STIFFNESS),
        at_least("damping", material.damping, 0.0, DAMPING),
        at_least("static_friction", material.static_friction, 0.0, ""),
        at_least("dynamic_friction", material.dynamic_friction, 0.0, ""),
        part_if("relative_stiffness", material.relative_stiffness),
        at_least("viscosity", material.viscosity, 0.0, DAMPING),
        check_frictions(material.static_friction, material.dynamic_friction),
        at_least("seam", material.seam.unwrap_or(0.0), 0.0, "m"),
    ];
    let parts = [
        ("magnet", material.magnet.as_ref().map_or(Ok(()), check_magnet)),
        ("pop_through", material.pop_through.as_ref().map_or(Ok(()), check_pop_through)),
        ("layers", check_layers(material)),
        ("texture", material.texture.as_ref().map_or(Ok(()), |t| check_texture(t, dimension))),
        ("impact", material.impact.as_ref().map_or(Ok(()), check_impact)),
    ];
    let parts = parts.map(|(key, part)| part.map_err(|problems| problems.under(key)));
    Problems::all([Problems::all(numbers), Problems::all(parts)])
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

fn check_layers(material: &Material) -> Result<(), Problems> {
    let mut wrong = Problems::default();
    let mut above = 0.0;
    let (mut fixed, mut slipping) = (material.static_friction, material.dynamic_friction);
    for (i, layer) in material.layers.iter().enumerate() {
        wrong.kept(check_layer(layer, above).map_err(|problems| problems.at(i)));
        above = layer.depth;
        fixed = layer.static_friction.unwrap_or(fixed);
        slipping = layer.dynamic_friction.unwrap_or(slipping);
        wrong.kept(check_frictions(fixed, slipping).map_err(|problem| problem.at(i)));
    }
    wrong.end(Ok(()))
}

fn check_layer(layer: &Layer, above: f64) -> Result<(), Problems> {
    let depth = positive("depth", layer.depth, "m").and_then(|()| {
        if layer.depth > above {
            return Ok(());
        }
        let rule = format!("must be more than that of the layer above, {above} m");
        Err(Problem::about(format!("{rule}, got {} m", layer.depth)).under("depth"))
    });
    let numbers = [
        ("stiffness", layer.stiffness, STIFFNESS),
        ("damping", layer.damping, DAMPING),
        ("static_friction", layer.static_friction, ""),
        ("dynamic_friction", layer.dynamic_friction, ""),
        ("viscosity", layer.viscosity, DAMPING),
    ];
    let numbers = numbers.map(|(key, value, unit)| {
        value.map_or(Ok(()), |value| at_least(key, value, 0.0, unit))
    });
    let pop = layer.pop_through.as_ref().map_or(Ok(()), check_pop_through);
    Problems::all([
        Problems::all(numbers.into_iter().chain([depth])),
        pop.map_err(|problems| problems.under("pop_through")),
    ])
}

fn check_magnet(magnet: &Magnet) -> Result<(), Problems> {
    let force = positive("force", magnet.force, "N");
    Problems::all([force, positive("distance", magnet.distance, "m")])
}

fn check_pop_through(pop: &PopThrough) -> Result<(), Problems> {
    let force = positive("force", pop.force, "N");
    Problems::all([force, at_least("distance", pop.distance, 0.0, "m")])
}

fn check_texture(texture: &Texture, dimension: usize) -> Result<(), Problems> {
    let direction = texture.direction.as_ref().map_or(Ok(()), |direction| {
        crate::pose::direction(direction, dimension).map_err(|p| p.under("direction"))
    });
    Problems::all([
        positive("amplitude", texture.amplitude, "m"),
        positive("wavelength", texture.wavelength, "m"),
        direction,
    ])
}

fn check_impact(impact: &Impact) -> Result<(), Problems> {
    Problems::all([
        at_least("amplitude", impact.amplitude, 0.0, DAMPING),
        positive_if("frequency", Some(impact.frequency), "Hz"),
        at_least("decay", impact.decay, 0.0, "1/s"),
    ])
}

/// What a body feels like: the name of a preset, or numbers of its own.
///
/// ```
/// use palpate_haptics::Material;
/// use palpate_scene::WrittenMaterial;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let written: WrittenMaterial = serde_json::from_str(r#""rubber""#)?;
/// assert_eq!(written, WrittenMaterial::Preset("rubber".into()));
/// assert_eq!(written.material()?, Material::rubber());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WrittenMaterial {
    /// The name of a preset.
    Preset(String),
    /// Numbers of its own.
    Own(Box<Material>),
}

impl WrittenMaterial {
    /// The preset of that name, or the material with these numbers.
    ///
    /// # Errors
    ///
    /// If there is no preset of that name: those there are.
    pub fn material(&self) -> Result<Material, crate::SceneError> {
        Ok(self.known()?)
    }

    /// As [`material`](Self::material), with a problem that has no place yet.
    pub(crate) fn known(&self) -> Result<Material, Problem> {
        match self {
            Self::Preset(name) => Material::preset(name).map_err(|_| {
                let names: Vec<_> = Material::preset_names().collect();
                Problem::new(unknown("material", name, &names))
            }),
            Self::Own(material) => Ok(Material::clone(material)),
        }
    }
}

impl From<Material> for WrittenMaterial {
    fn from(material: Material) -> Self {
        Self::Own(Box::new(material))
    }
}

impl Serialize for WrittenMaterial {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Preset(name) => serializer.serialize_str(name),
            Self::Own(material) => material.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for WrittenMaterial {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(MaterialVisitor)
    }
}

struct MaterialVisitor;

impl<'de> Visitor<'de> for MaterialVisitor {
    type Value = WrittenMaterial;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object or the name of a material")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<WrittenMaterial, E> {
        Ok(WrittenMaterial::Preset(name.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<WrittenMaterial, A::Error> {
        Material::deserialize(MapAccessDeserializer::new(map)).map(WrittenMaterial::from)
    }
}

#[cfg(test)]
mod written_material_tests {
    use super::*;

    #[test]
    fn a_name_that_is_none_is_answered_with_the_nearest_or_with_those_there_are() {
        let refused = |name: &str| {
            WrittenMaterial::Preset(name.into()).material().unwrap_err().to_string()
        };
        assert_eq!(refused("glas"), "unknown material `glas`, did you mean `glass`?");
        let error = refused("plasma");
        assert!(error.starts_with("unknown material `plasma`; known are `rubber`, `wood`"));
        assert!(error.ends_with("and `layered_tissue`"), "{error}");
    }
}
