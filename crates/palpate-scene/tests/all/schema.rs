// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The schema takes every scene.

use palpate_scene::schema;

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

#[test]
fn the_schema_takes_meshes_and_grids_that_stand_in_the_scene() {
    // The rule of meshes once stood at grids: editors marked every mesh without a file.
    let validator = jsonschema::validator_for(&schema()).unwrap();
    let is_taken = |shape: &str| {
        let scene = format!(
            r#"{{ "palpate": 1, "dimension": 3, "bodies": [ {{ "name": "it", "shape": {shape} }} ] }}"#
        );
        validator.is_valid(&serde_json::from_str(&scene).unwrap())
    };
    let vertices = r#""vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]"#;
    let faces = r#""faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]"#;
    let samples = r#""counts": [2, 2, 2], "cell": 1, "origin": [0, 0, 0], "samples": [1, 1]"#;
    for taken in [
        format!(r#"{{ "mesh": {{ {vertices}, {faces} }} }}"#),
        r#"{ "mesh": { "file": "a.stl", "scale": 0.001 } }"#.to_owned(),
        format!(r#"{{ "grid": {{ {samples} }} }}"#),
        r#"{ "grid": { "file": "a.grid" } }"#.to_owned(),
    ] {
        assert!(is_taken(&taken), "{taken}");
    }
    for refused in [
        format!(r#"{{ "mesh": {{ {vertices} }} }}"#),
        format!(r#"{{ "mesh": {{ "file": "a.stl", {vertices}, {faces} }} }}"#),
        format!(r#"{{ "mesh": {{ "scale": 2, {vertices}, {faces} }} }}"#),
        format!(r#"{{ "grid": {{ "file": "a.grid", {samples} }} }}"#),
        r#"{ "grid": { "cell": 1 } }"#.to_owned(),
        r#"{ "grid": {} }"#.to_owned(),
    ] {
        assert!(!is_taken(&refused), "{refused}");
    }
}
