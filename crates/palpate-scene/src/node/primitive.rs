// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A primitive with its parameters.

use std::fmt;

use indexmap::IndexMap;
use palpate_field::kernel::{Argument, Parameter, ParameterKind};
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

use super::operators::DESCRIPTION;
use crate::catalogue::{Signature, file_key};
use crate::problem::unknown;

/// A primitive of the catalogue with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// Its name in the catalogue, or another name for it there.
    pub name: String,
    /// A note for readers of the file.
    pub description: Option<String>,
    /// Its parameters by their keys in files: `angle_degrees`, or `angle` in radians.
    pub arguments: IndexMap<String, Argument>,
}

impl Primitive {
    /// The argument for a parameter, and the key that it has.
    pub(crate) fn argument(&self, parameter: &Parameter) -> Option<(&str, &Argument)> {
        let degrees = self.arguments.get_key_value(&*file_key(parameter));
        let argument = degrees.or_else(|| self.arguments.get_key_value(parameter.name));
        argument.map(|(key, argument)| (key.as_str(), argument))
    }
}

impl Serialize for Primitive {
    /// The parameters alone: the name is the key that they are under.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let Some(description) = &self.description {
            map.serialize_entry(DESCRIPTION, description)?;
        }
        for (key, argument) in &self.arguments {
            match argument {
                Argument::Number(number) => map.serialize_entry(key, number)?,
                Argument::Count(count) => map.serialize_entry(key, count)?,
                Argument::Vector(vector) => map.serialize_entry(key, vector)?,
                Argument::Points(points) => map.serialize_entry(key, points)?,
                Argument::Rings(rings) => map.serialize_entry(key, rings)?,
            }
        }
        map.end()
    }
}

/// Reads the parameters of one of `candidates`: the primitives of one name.
pub(super) struct Parameters<'c>(pub(super) &'c [Signature]);

impl<'de> DeserializeSeed<'de> for Parameters<'_> {
    type Value = Primitive;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Primitive, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Parameters<'_> {
    type Value = Primitive;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with its parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Primitive, A::Error> {
        // A name may have other parameters in the other dimension: the keys
        // decide which is meant.
        let mut candidates = self.0.to_vec();
        let mut description = None;
        let mut read = IndexMap::new();
        while let Some(key) = map.next_key::<String>()? {
            if key == DESCRIPTION {
                description = Some(map.next_value()?);
                continue;
            }
            let found = candidates.iter().find_map(|candidate| candidate.parameter(&key));
            let Some(parameter) = found else {
                let known: Vec<_> = candidates
                    .iter()
                    .flat_map(|candidate| candidate.parameters)
                    .map(|parameter| file_key(parameter).into_owned())
                    .collect();
                let known: Vec<_> = known.iter().map(String::as_str).collect();
                let refused = Refused(unknown("key", &key, &known));
                return Err(match map.next_value_seed(refused) {
                    Ok(()) => A::Error::custom("an unknown key"),
                    Err(error) => error,
                });
            };
            candidates.retain(|candidate| candidate.parameter(&key).is_some());
            let argument = map.next_value_seed(Value(parameter.kind))?;
            read.insert(key, argument);
        }
        let Some(signature) = candidates.first() else {
            return Err(A::Error::custom("not a primitive"));
        };
        // In the order of the catalogue, so that writing has one order.
        let mut arguments = IndexMap::new();
        for parameter in signature.parameters {
            let key = file_key(parameter);
            let argument = read.swap_remove_entry(&*key);
            let Some((key, argument)) =
                argument.or_else(|| read.swap_remove_entry(parameter.name))
            else {
                return Err(A::Error::custom(format_args!(
                    "missing key `{key}`: {}",
                    parameter.about
                )));
            };
            arguments.insert(key, argument);
        }
        if let Some(radians) = read.keys().next() {
            return Err(A::Error::custom(format_args!(
                "`{radians}_degrees` and `{radians}` say the same; give one of them"
            )));
        }
        Ok(Primitive { name: signature.name.to_owned(), description, arguments })
    }
}

/// Reads an argument of a kind.
struct Value(ParameterKind);

impl<'de> DeserializeSeed<'de> for Value {
    type Value = Argument;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Argument, D::Error> {
        match self.0 {
            ParameterKind::Count => u32::deserialize(deserializer).map(Argument::Count),
            ParameterKind::Vector | ParameterKind::Direction => {
                Vec::deserialize(deserializer).map(Argument::Vector)
            }
            ParameterKind::Points => Vec::deserialize(deserializer).map(Argument::Points),
            ParameterKind::Rings => Vec::deserialize(deserializer).map(Argument::Rings),
            _ => f64::deserialize(deserializer).map(Argument::Number),
        }
    }
}

/// A value that is refused with a message: so the error is seen from its key.
pub(super) struct Refused(pub(super) String);

impl<'de> DeserializeSeed<'de> for Refused {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, _: D) -> Result<(), D::Error> {
        Err(D::Error::custom(self.0))
    }
}
