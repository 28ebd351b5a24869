// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The JSON Schema of scene files, made from the types and the catalogue.
//!
//! Everything is defined twice, for the plane and for space, because most sizes
//! depend on the dimension.

mod shape;
mod tidy;

use std::borrow::Cow;

use palpate_vibration::ACTUATORS;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::pose::AxisAngle;
use crate::scene::{Dimension, Scene};
use crate::shape::WrittenShape;

/// The schema, generated.
pub(super) fn schema() -> Value {
    let mut definitions = Map::new();
    for dimension in [Dimension::Two, Dimension::Three] {
        definitions.insert(place(dimension).to_owned(), definitions_of(dimension));
    }
    let scene = |dimension| json!({ "$ref": reference(dimension, "Scene") });
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "palpate scene",
        "description": "Shapes to be touched, in metres, y up. Generated; see docs/formats.md.",
        "type": "object",
        "properties": {
            "palpate": { "const": 1, "description": "The version of the format." },
            "dimension": {
                "enum": [2, 3],
                "description": "2 for the plane, 3 for space.",
            },
        },
        "required": ["palpate", "dimension", "bodies"],
        "if": { "properties": { "dimension": { "const": 2 } } },
        "then": scene(Dimension::Two),
        "else": scene(Dimension::Three),
        "$defs": definitions,
    })
}

/// What the definitions of a dimension are under.
fn place(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Two => "plane",
        Dimension::Three => "space",
    }
}

/// The reference to a definition.
fn reference(dimension: Dimension, name: &str) -> String {
    format!("#/$defs/{}/{name}", place(dimension))
}

/// All definitions of a dimension.
fn definitions_of(dimension: Dimension) -> Value {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let scene = generator.subschema_for::<Scene>();
    drop(scene);
    let mut definitions = generator.take_definitions(false);
    let size = dimension.count();
    let numbers = |count: usize| {
        json!({
            "type": "array",
            "items": { "type": "number" },
            "minItems": count,
            "maxItems": count,
        })
    };
    // What the types leave open is decided here.
    definitions.insert("Vector".to_owned(), numbers(size));
    definitions.insert("Dimension".to_owned(), json!({ "const": size }));
    definitions.insert(
        "Turn".to_owned(),
        match dimension {
            Dimension::Two => json!({ "type": "number", "description": "Degrees." }),
            Dimension::Three => json!({ "$ref": "#/$defs/AxisAngle" }),
        },
    );
    let rows = json!({
        "type": "array",
        "items": numbers(size),
        "minItems": size,
        "maxItems": size,
    });
    definitions.insert(
        "Rotation".to_owned(),
        match dimension {
            Dimension::Two => rows,
            Dimension::Three => json!({ "anyOf": [numbers(4), rows] }),
        },
    );
    if dimension == Dimension::Two {
        forbid_in_the_plane(&mut definitions);
    }
    definitions.insert("Shape".to_owned(), shape::schema(dimension));
    definitions.insert("NamedShapes".to_owned(), shape::named_shapes(dimension));
    let mut definitions = Value::Object(definitions.into_iter().collect());
    tidy::tidy(&mut definitions, place(dimension));
    definitions
}

/// Removes the keys that only space has.
fn forbid_in_the_plane(definitions: &mut Map<String, Value>) {
    for key in ["plane", "at"] {
        let properties = definitions
            .get_mut("WrittenView")
            .and_then(|definition| definition.get_mut("properties"))
            .and_then(Value::as_object_mut);
        if let Some(properties) = properties {
            properties.shift_remove(key);
        }
    }
}

/// A reference to a definition that [`definitions_of`] fills in.
fn filled_in(name: &str) -> Schema {
    json_schema!({ "$ref": format!("#/$defs/{name}") })
}

/// One number for each dimension.
pub(crate) struct VectorSchema;

impl JsonSchema for VectorSchema {
    fn schema_name() -> Cow<'static, str> {
        "Vector".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({})
    }
}

/// The name of an actuator.
pub(crate) struct ActuatorSchema;

impl JsonSchema for ActuatorSchema {
    fn schema_name() -> Cow<'static, str> {
        "Actuator".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names = ACTUATORS.each_ref().map(|(name, _)| *name);
        json_schema!({ "enum": names })
    }
}

/// What `rotate_degrees` takes.
pub(crate) struct TurnSchema;

impl JsonSchema for TurnSchema {
    fn schema_name() -> Cow<'static, str> {
        "Turn".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        generator.subschema_for::<AxisAngle>()
    }
}

impl JsonSchema for WrittenShape {
    fn schema_name() -> Cow<'static, str> {
        "Shape".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({})
    }
}

/// The schema of `dimension`.
pub(crate) fn dimension(_: &mut SchemaGenerator) -> Schema {
    filled_in("Dimension")
}

/// The schema of `shapes`.
pub(crate) fn named_shapes(_: &mut SchemaGenerator) -> Schema {
    filled_in("NamedShapes")
}

/// The schema of a view's plane.
pub(crate) fn plane(generator: &mut SchemaGenerator) -> Schema {
    let free = generator.subschema_for::<crate::view::FreePlane>();
    json_schema!({ "anyOf": [{ "enum": ["xy", "xz", "yz"] }, free] })
}

/// The schema of a body's material.
pub(crate) fn material(generator: &mut SchemaGenerator) -> Schema {
    let own = generator.subschema_for::<palpate_haptics::Material>();
    let names: Vec<_> = palpate_haptics::Material::preset_names().collect();
    json_schema!({ "anyOf": [{ "enum": names }, own] })
}

/// Set to write the schema instead of comparing it.
const RENEW: &str = "PALPATE_RENEW";

#[test]
fn the_committed_schema_is_the_generated_one() {
    let text = crate::json::write(&schema());
    if std::env::var_os(RENEW).is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/schema/scene.schema.json");
        std::fs::write(path, text).unwrap();
        return;
    }
    assert!(
        text == super::schema_text(),
        "schema/scene.schema.json is stale; `cargo xtask renew` renews it"
    );
}
