// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! JSON written, and read into types.

use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use serde_json::{Number, Value};

use super::document::Taken;
use crate::names::shortened;
use crate::problem::Problem;

/// What fits on a line, indentation included.
const WIDTH: usize = 96;

/// The text of `value`, with a newline at its end.
pub(crate) fn write(value: &Value) -> String {
    let mut text = String::new();
    pretty(value, 0, 0, &mut text);
    text.push('\n');
    text
}

/// Writes `value` where `column` characters of the line are taken.
fn pretty(value: &Value, indent: usize, column: usize, text: &mut String) {
    let start = text.len();
    if compact(value, WIDTH.saturating_sub(column), text).is_some() {
        return;
    }
    text.truncate(start);
    let inner = indent + 2;
    let (open, close, count) = match value {
        Value::Array(elements) => ('[', ']', elements.len()),
        Value::Object(entries) => ('{', '}', entries.len()),
        scalar => return push_scalar(scalar, text),
    };
    text.push(open);
    let mut next = |i: usize, key: Option<&String>, element: &Value| {
        text.push('\n');
        text.push_str(&" ".repeat(inner));
        let mut column = inner + 1;
        if let Some(key) = key {
            let before = text.len();
            push_string(key, text);
            text.push_str(": ");
            column += text.len() - before;
        }
        pretty(element, inner, column, text);
        if i + 1 < count {
            text.push(',');
        }
    };
    match value {
        Value::Array(elements) => {
            elements.iter().enumerate().for_each(|(i, e)| next(i, None, e));
        }
        Value::Object(entries) => {
            entries.iter().enumerate().for_each(|(i, (key, e))| next(i, Some(key), e));
        }
        _ => {}
    }
    text.push('\n');
    text.push_str(&" ".repeat(indent));
    text.push(close);
}

/// Writes `value` on one line of at most `room` characters; `None` if it does
/// not fit.
fn compact(value: &Value, room: usize, text: &mut String) -> Option<()> {
    let end = text.len() + room;
    match value {
        Value::Array(elements) => {
            text.push('[');
            for (i, element) in elements.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { ", " });
                compact(element, end.checked_sub(text.len())?, text)?;
            }
            text.push(']');
        }
        Value::Object(entries) if entries.is_empty() => text.push_str("{}"),
        Value::Object(entries) => {
            text.push_str("{ ");
            for (i, (key, element)) in entries.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { ", " });
                push_string(key, text);
                text.push_str(": ");
                compact(element, end.checked_sub(text.len())?, text)?;
            }
            text.push_str(" }");
        }
        scalar => push_scalar(scalar, text),
    }
    (text.len() <= end).then_some(())
}

fn push_scalar(value: &Value, text: &mut String) {
    match value {
        Value::String(string) => push_string(string, text),
        Value::Number(number) => push_number(number, text),
        other => text.push_str(&other.to_string()),
    }
}

fn push_string(string: &str, text: &mut String) {
    text.push_str(&Value::from(string).to_string());
}

fn push_number(number: &Number, text: &mut String) {
    if number.is_f64() {
        text.push_str(&decimal(number.as_f64().unwrap_or_default()));
    } else {
        text.push_str(&number.to_string());
    }
}

/// The shortest decimal that reads back as `x`, without an exponent unless it
/// would be long.
fn decimal(x: f64) -> String {
    if x == 0.0 || (1e-6..1e15).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

/// The value that was found, for a message.
pub(crate) fn found(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{:?}", shortened(text)),
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        scalar => scalar.to_string(),
    }
}

/// A value of the tree, without what was taken out.
#[derive(Clone, Copy)]
pub(super) struct Node<'t> {
    pub(super) value: &'t Value,
    pub(super) taken: &'t Taken<'t>,
}

impl<'de> Deserializer<'de> for Node<'_> {
    type Error = Problem;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        match self.value {
            Value::String(text) => visitor.visit_str(text),
            Value::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(whole), _) => visitor.visit_u64(whole),
                (_, Some(whole)) => visitor.visit_i64(whole),
                _ => visitor.visit_f64(number.as_f64().unwrap_or(f64::NAN)),
            },
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Null => visitor.visit_unit(),
            Value::Array(elements) => {
                let elements: Vec<_> = self.taken.left(elements).collect();
                let count = elements.len();
                let mut elements = Elements { elements, next: 0, taken: self.taken };
                let value = visitor.visit_seq(&mut elements)?;
                let wanted = elements.next;
                if wanted == count {
                    return Ok(value);
                }
                Err(Problem::about(format!("must be a list of {wanted}, got {count}")))
            }
            Value::Object(entries) => {
                let entries = self.taken.entries(self.value, entries).into_iter();
                visitor.visit_map(Entries { entries, open: None, taken: self.taken })
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
        match self.value {
            Value::String(text) => visitor.visit_enum(Word(text)),
            other => {
                let expected = format!("one of \"{}\"", variants.join("\", \""));
                let found = found(other);
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
        match self.value {
            Value::Object(_) => self.deserialize_any(visitor),
            other => {
                let found = found(other);
                Err(Problem::about(format!("must be an object, got {found}")))
            }
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map identifier ignored_any
    }
}

struct Elements<'t> {
    elements: Vec<&'t Value>,
    next: usize,
    taken: &'t Taken<'t>,
}

impl<'de> SeqAccess<'de> for &mut Elements<'_> {
    type Error = Problem;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Problem> {
        let Some(element) = self.elements.get(self.next) else { return Ok(None) };
        let index = self.next;
        self.next += 1;
        let node = Node { value: element, taken: self.taken };
        seed.deserialize(node).map(Some).map_err(|problem| problem.at(index))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.elements.len() - self.next)
    }
}

struct Entries<'t> {
    entries: std::vec::IntoIter<(&'t str, &'t Value)>,
    /// The entry whose key was read and whose value comes next.
    open: Option<(&'t str, &'t Value)>,
    taken: &'t Taken<'t>,
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = Problem;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Problem> {
        self.open = self.entries.next();
        let Some((key, _)) = self.open else { return Ok(None) };
        let text: StrDeserializer<'_, Problem> = key.into_deserializer();
        seed.deserialize(text).map(Some).map_err(|problem| problem.under(key))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(
        &mut self,
        seed: V,
    ) -> Result<V::Value, Problem> {
        let Some((key, value)) = self.open else {
            return Err(Problem::new("a value without its key"));
        };
        let node = Node { value, taken: self.taken };
        seed.deserialize(node).map_err(|problem| problem.under(key))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.entries.len())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_bit_for_bit() {
        for (x, text) in
            [(800.0, "800"), (-0.0, "-0"), (0.1, "0.1"), (1e-7, "1e-7"), (2.5e20, "2.5e20")]
        {
            assert_eq!(decimal(x), text);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits());
        }
    }

    #[test]
    fn what_is_short_stays_on_a_line() {
        let value = serde_json::json!({ "a": [1, 2.0, 3.5], "b": "x".repeat(90) });
        let text = write(&value);
        assert!(text.starts_with("{\n  \"a\": [1, 2, 3.5],\n  \"b\": \"xxx"), "{text}");
    }
}
