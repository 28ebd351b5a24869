// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The committed schema is the generated one, and takes every scene.

use palpate_scene::{schema, schema_text};

/// Set to write the schema instead of comparing it.
const UPDATE: &str = "PALPATE_UPDATE_SCHEMA";

#[test]
fn the_committed_schema_is_the_generated_one() {
    let path =
        crate::common::repository().join("crates/palpate-scene/schema/scene.schema.json");
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(&path, schema_text()).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(
        committed == schema_text(),
        "schema/scene.schema.json is stale; run the test again with {UPDATE}=1"
    );
}

#[test]
fn the_schema_is_a_schema_and_takes_every_scene() {
    assert!(jsonschema::meta::is_valid(&schema()));
    let validator = jsonschema::validator_for(&schema()).unwrap();
    for (name, text) in crate::common::files("scenes") {
        if let Err(error) = validator.validate(&serde_json::from_str(&text).unwrap()) {
            panic!("{name}: {}: {error}", error.instance_path());
        }
    }
}
