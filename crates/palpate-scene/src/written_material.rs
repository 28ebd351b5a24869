// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The material of a body, by name or in numbers.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use palpate_haptics::Material;

use crate::names::unknown;
use crate::problem::Problem;

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
mod tests {
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
