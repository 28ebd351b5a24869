// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The JSON Schema of scene files. A test generates it from the types and the catalogue, and compares it
//! with the file.

#[cfg(test)]
mod generated;

use serde_json::Value;

#[cfg(test)]
pub(crate) use generated::{
    ActuatorSchema, TurnSchema, VectorSchema, dimension, material, named_shapes, plane,
};

/// The JSON Schema of scene files, in draft 2020-12: for editors, and for
/// programs that write scenes.
///
/// A file that the schema refuses is refused by [`Scene::from_json`] too. Rules
/// that a schema cannot express are checked there alone: cycles of references, names that must
/// be known or unique, and rules that compare two numbers.
///
/// ```
/// let schema = palpate_scene::schema();
/// assert_eq!(schema["properties"]["palpate"]["const"], 1);
/// assert!(schema["$defs"]["space"]["Shape"]["properties"]["ball"].is_object());
/// ```
///
/// # Panics
///
/// Never: the schema is a file of this crate.
#[must_use]
pub fn schema() -> Value {
    serde_json::from_str(schema_text()).expect("the schema is JSON")
}

/// The text of [`schema`], as it is kept in `schema/scene.schema.json`.
///
/// ```
/// let text = palpate_scene::schema_text();
/// assert!(text.starts_with("{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\""));
/// ```
#[must_use]
pub fn schema_text() -> &'static str {
    include_str!("../schema/scene.schema.json")
}
