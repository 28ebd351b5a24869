// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The value of `rotation`: a quaternion, or the rows of a matrix.

#[cfg(test)]
use std::borrow::Cow;
use std::fmt;

#[cfg(test)]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// What `rotation` takes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Attitude {
    Quaternion([f64; 4]),
    Rows(Vec<Vec<f64>>),
}

#[cfg(test)]
impl JsonSchema for Attitude {
    fn schema_name() -> Cow<'static, str> {
        "Rotation".into()
    }

    /// Filled in for each dimension.
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({})
    }
}

impl Serialize for Attitude {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Quaternion(quaternion) => quaternion.serialize(serializer),
            Self::Rows(rows) => rows.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Attitude {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AttitudeVisitor)
    }
}

struct AttitudeVisitor;

impl<'de> Visitor<'de> for AttitudeVisitor {
    type Value = Attitude;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of 4 numbers, or of the rows of a matrix")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Attitude, A::Error> {
        const NUMBERS: &str = "a list of 4 numbers";
        match seq.next_element()? {
            None => Err(A::Error::invalid_length(0, &NUMBERS)),
            Some(Element::Row(first)) => {
                let mut rows = vec![first];
                while let Some(row) = seq.next_element()? {
                    rows.push(row);
                }
                Ok(Attitude::Rows(rows))
            }
            Some(Element::Number(first)) => {
                let mut quaternion = [first, 0.0, 0.0, 0.0];
                for (i, x) in quaternion.iter_mut().enumerate().skip(1) {
                    let next = seq.next_element()?;
                    *x = next.ok_or_else(|| A::Error::invalid_length(i, &NUMBERS))?;
                }
                Ok(Attitude::Quaternion(quaternion))
            }
        }
    }
}

/// The first element, which decides what the others are.
enum Element {
    Number(f64),
    Row(Vec<f64>),
}

impl<'de> Deserialize<'de> for Element {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ElementVisitor)
    }
}

struct ElementVisitor;

impl<'de> Visitor<'de> for ElementVisitor {
    type Value = Element;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or a row of a matrix")
    }

    fn visit_u64<E>(self, number: u64) -> Result<Element, E> {
        Ok(Element::Number(number as f64))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Element, E> {
        Ok(Element::Number(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Element, E> {
        Ok(Element::Number(number))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Element, A::Error> {
        let mut row = Vec::new();
        while let Some(number) = seq.next_element()? {
            row.push(number);
        }
        Ok(Element::Row(row))
    }
}
