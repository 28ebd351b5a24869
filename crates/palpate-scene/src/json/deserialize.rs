// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! serde's view of the tree, which adds the path to every error.

use jsonc_parser::ast::{ObjectProp, Value};
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, IgnoredAny, IntoDeserializer, MapAccess,
    SeqAccess, Visitor,
};
use serde::forward_to_deserialize_any;

use super::document::name;
use crate::problem::Problem;

/// A value of the tree.
#[derive(Clone, Copy)]
pub(super) struct Node<'t, 'a>(pub(super) &'t Value<'a>);

impl<'de> Deserializer<'de> for Node<'_, '_> {
    type Error = Problem;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        match self.0 {
            Value::StringLit(text) => visitor.visit_str(&text.value),
            Value::NumberLit(number) => visit_number(number.value, visitor),
            Value::BooleanLit(value) => visitor.visit_bool(value.value),
            Value::NullKeyword(_) => visitor.visit_unit(),
            Value::Array(array) => {
                let mut elements = Elements { elements: &array.elements, next: 0 };
                let value = visitor.visit_seq(&mut elements)?;
                let (taken, count) = (elements.next, array.elements.len());
                if taken == count {
                    return Ok(value);
                }
                Err(Problem::about(format!("must be a list of {taken}, got {count}")))
            }
            Value::Object(object) => {
                refuse_duplicates(&object.properties)?;
                visitor.visit_map(Properties { properties: &object.properties, next: 0 })
            }
        }
    }

    /// Refuses `null`: a key is left out, or has a value.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Problem> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Problem> {
        match self.0 {
            Value::StringLit(text) => visitor.visit_enum(Word(&text.value)),
            _ => {
                let expected = format!("one of \"{}\"", variants.join("\", \""));
                let found = self.deserialize_any(Found)?;
                Err(Problem::about(format!("must be {expected}, got {found}")))
            }
        }
    }

    /// Takes objects alone, where serde would also take a list of the values in order.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Problem> {
        match self.0 {
            Value::Object(_) => self.deserialize_any(visitor),
            _ => {
                let found = self.deserialize_any(Found)?;
                Err(Problem::about(format!("must be an object, got {found}")))
            }
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map identifier ignored_any
    }
}

/// Visits whole numbers as integers, for counts, and all others as `f64`.
fn visit_number<'de, V: Visitor<'de>>(literal: &str, visitor: V) -> Result<V::Value, Problem> {
    if let Ok(whole) = literal.parse::<u64>() {
        return visitor.visit_u64(whole);
    }
    match literal.parse::<i64>() {
        // "-0" is a float of its own.
        Ok(whole) if whole != 0 => return visitor.visit_i64(whole),
        _ => {}
    }
    match literal.parse::<f64>() {
        Ok(number) if number.is_finite() => visitor.visit_f64(number),
        _ => {
            let literal = crate::problem::shortened(literal);
            Err(Problem::about(format!("must be within the range of numbers, got {literal}")))
        }
    }
}

fn refuse_duplicates(properties: &[ObjectProp<'_>]) -> Result<(), Problem> {
    let mut seen = std::collections::HashSet::with_capacity(properties.len());
    for property in properties {
        let key = name(property);
        if !seen.insert(key) {
            let shown = crate::problem::shortened(key);
            return Err(Problem::new(format!("duplicate key `{shown}`")).under(key));
        }
    }
    Ok(())
}

struct Elements<'t, 'a> {
    elements: &'t [Value<'a>],
    next: usize,
}

impl<'de> SeqAccess<'de> for &mut Elements<'_, '_> {
    type Error = Problem;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Problem> {
        let Some(element) = self.elements.get(self.next) else { return Ok(None) };
        let index = self.next;
        self.next += 1;
        seed.deserialize(Node(element)).map(Some).map_err(|problem| problem.at(index))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.elements.len() - self.next)
    }
}

struct Properties<'t, 'a> {
    properties: &'t [ObjectProp<'a>],
    next: usize,
}

impl<'de> MapAccess<'de> for Properties<'_, '_> {
    type Error = Problem;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Problem> {
        let Some(property) = self.properties.get(self.next) else { return Ok(None) };
        let key: StrDeserializer<'_, Problem> = name(property).into_deserializer();
        seed.deserialize(key).map(Some).map_err(|problem| problem.under(name(property)))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(
        &mut self,
        seed: V,
    ) -> Result<V::Value, Problem> {
        let Some(property) = self.properties.get(self.next) else {
            return Err(Problem::new("a value without its key"));
        };
        self.next += 1;
        seed.deserialize(Node(&property.value)).map_err(|problem| problem.under(name(property)))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.properties.len() - self.next)
    }
}

/// A string that names a variant without content.
struct Word<'t>(&'t str);

impl<'de> EnumAccess<'de> for Word<'_> {
    type Error = Problem;
    type Variant = OnlyWord;

    fn variant_seed<V: DeserializeSeed<'de>>(
        self,
        seed: V,
    ) -> Result<(V::Value, OnlyWord), Problem> {
        let word: StrDeserializer<'_, Problem> = self.0.into_deserializer();
        Ok((seed.deserialize(word)?, OnlyWord))
    }
}

struct OnlyWord;

impl<'de> serde::de::VariantAccess<'de> for OnlyWord {
    type Error = Problem;

    fn unit_variant(self) -> Result<(), Problem> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, _: T) -> Result<T::Value, Problem> {
        Err(Problem::about("must be a word of its own"))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, Problem> {
        Err(Problem::about("must be a word of its own"))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Problem> {
        Err(Problem::about("must be a word of its own"))
    }
}

/// The value that was found, for a message.
struct Found;

impl<'de> Visitor<'de> for Found {
    type Value = String;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("anything")
    }

    fn visit_str<E>(self, text: &str) -> Result<String, E> {
        Ok(format!("{:?}", crate::problem::shortened(text)))
    }

    fn visit_bool<E>(self, value: bool) -> Result<String, E> {
        Ok(value.to_string())
    }

    fn visit_u64<E>(self, value: u64) -> Result<String, E> {
        Ok(value.to_string())
    }

    fn visit_i64<E>(self, value: i64) -> Result<String, E> {
        Ok(value.to_string())
    }

    fn visit_f64<E>(self, value: f64) -> Result<String, E> {
        Ok(value.to_string())
    }

    fn visit_unit<E>(self) -> Result<String, E> {
        Ok("null".to_owned())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<String, A::Error> {
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok("a list".to_owned())
    }

    fn visit_map<A: MapAccess<'de>>(self, _: A) -> Result<String, A::Error> {
        Ok("an object".to_owned())
    }
}
