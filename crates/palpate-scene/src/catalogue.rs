// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The primitives of both dimensions, as files see them.

use std::borrow::Cow;

use palpate_field::Unit;
use palpate_field::catalogue::{ALIASES, Alias, Entry};
use palpate_field::kernel::{Parameter, ParameterKind};
use serde_json::{Value, json};

use crate::problem::{Problem, SceneError};
use crate::scene::Dimension;
use crate::shape::WrittenShape;

/// A primitive in one dimension.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Signature {
    pub(crate) dimension: Dimension,
    pub(crate) name: &'static str,
    #[cfg(test)]
    pub(crate) about: &'static str,
    pub(crate) parameters: &'static [Parameter],
    /// The other name of which this is.
    pub(crate) alias: Option<&'static Alias>,
}

impl Signature {
    fn of<const D: usize>(dimension: Dimension, entry: &Entry<D>) -> Self {
        let Entry { name, parameters, .. } = *entry;
        Self {
            dimension,
            name,
            #[cfg(test)]
            about: entry.about,
            parameters,
            alias: None,
        }
    }

    /// The parameter whose key in files is `key`: for an angle that with `_degrees`, or the
    /// name alone for radians.
    pub(crate) fn parameter(&self, key: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| file_key(p) == key || p.name == key)
    }
}

/// All primitives, those of the plane first, then under their other names.
pub(crate) fn signatures() -> impl Iterator<Item = Signature> {
    primitives().chain(ALIASES.iter().filter_map(|alias| {
        let is_meant =
            |s: &Signature| (s.name, s.dimension.count()) == (alias.of, alias.dimension);
        let primitive = primitives().find(is_meant)?;
        let parameters = alias.parameters.unwrap_or(primitive.parameters);
        Some(Signature { name: alias.name, parameters, alias: Some(alias), ..primitive })
    }))
}

fn primitives() -> impl Iterator<Item = Signature> {
    let planar = Entry::<2>::ALL.iter().map(|e| Signature::of(Dimension::Two, e));
    planar.chain(Entry::<3>::ALL.iter().map(|e| Signature::of(Dimension::Three, e)))
}

/// The primitives of that name or other name: at most one in each dimension.
pub(crate) fn named(name: &str) -> Vec<Signature> {
    signatures().filter(|signature| signature.name == name).collect()
}

/// A parameter's key in files: angles in degrees say so; in radians they have the name alone.
pub(crate) fn file_key(parameter: &Parameter) -> Cow<'static, str> {
    match parameter.kind {
        ParameterKind::Angle => format!("{}_degrees", parameter.name).into(),
        _ => parameter.name.into(),
    }
}

/// A primitive with its parameters, promise and example, as `palpate shapes --json` prints it.
///
/// # Errors
///
/// If the example cannot be written, which the tests of the catalogue exclude.
///
/// ```
/// use palpate_field::catalogue::Entry;
/// use palpate_scene::described_primitive;
///
/// # fn main() -> Result<(), palpate_scene::SceneError> {
/// let first = described_primitive(&Entry::<3>::ALL[0])?;
/// assert!(first["parameters"][0]["key"].is_string());
/// # Ok(())
/// # }
/// ```
#[inline(never)]
pub fn described_primitive<const D: usize>(entry: &Entry<D>) -> Result<Value, SceneError> {
    let example = entry.example().map_err(|error| Problem::new(error.to_string()))?;
    let promise = example.promise();
    Ok(json!({
        "name": entry.name,
        "dimension": D,
        "about": entry.about,
        "origin": entry.origin,
        "parameters": entry.parameters.iter().map(described).collect::<Vec<_>>(),
        "promise": promise.in_words(),
        "outside": promise.outside.word(),
        "inside": promise.inside.word(),
        "lipschitz": promise.lipschitz,
        "convex": promise.convex,
        "bounded": promise.bounds.is_some(),
        "example": WrittenShape::of(&example)?,
    }))
}

/// A parameter as scene files write it: angles in degrees, with a key that ends in `_degrees`.
fn described(parameter: &Parameter) -> Value {
    let unit = match parameter.kind.unit() {
        Unit::Radian => "degrees",
        unit => unit.symbol(),
    };
    json!({ "key": file_key(parameter), "unit": unit, "about": parameter.about })
}
