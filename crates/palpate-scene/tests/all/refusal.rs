// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files that must be refused, by the parser and perhaps by the schema.

use palpate_scene::{Scene, schema};

/// What the schema thinks of a bad file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Schema {
    Refuses,
    /// It cannot say what is wrong.
    Accepts,
}
/// Checks that each text is refused with its message and judged by the schema.
pub(crate) fn check_all(cases: &[(&str, &str, Schema)], text_of: impl Fn(&str) -> String) {
    let validator = jsonschema::validator_for(&schema()).expect("a schema");
    for (part, expected, verdict) in cases {
        let text = text_of(part);
        let error = Scene::from_json(&text).expect_err(part);
        assert_eq!(error.to_string(), *expected, "{text}");
        let value = serde_json::from_str(&text);
        let valid = value.is_ok_and(|value| validator.is_valid(&value));
        assert_eq!(valid, *verdict == Schema::Accepts, "the schema on {text}");
    }
}
