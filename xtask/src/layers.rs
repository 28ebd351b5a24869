// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The layer rule: a crate depends only on crates above it in ARCHITECTURE.md.

use serde_json::Value;

use crate::command::Failure;

/// The crates from the top layer to the bottom.
const LAYERS: &[&str] = &[
    "palpate-field",
    "palpate-scene",
    "palpate-mesh",
    "palpate-query",
    "palpate-local",
    "palpate-haptics",
    "palpate-devices",
    "palpate-plot",
    "palpate",
    "palpate-cli",
    "palpate-bench",
    "xtask",
];

/// What tests alone may use, from any layer.
const FOR_TESTS: &[&str] = &["palpate-testkit"];

/// Checks every dependency between the crates of the workspace.
pub(crate) fn check(metadata: &Value) -> Result<(), Failure> {
    let members: Vec<&str> = list(&metadata["workspace_members"]);
    let mut wrong = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        if !members.contains(&package["id"].as_str().unwrap_or_default()) {
            continue;
        }
        let name = package["name"].as_str().unwrap_or_default();
        let for_tests = FOR_TESTS.contains(&name);
        let layer = LAYERS.iter().position(|crate_name| *crate_name == name);
        if layer.is_none() && !for_tests {
            wrong.push(format!("{name} is in no layer: add it to xtask/src/layers.rs"));
        }
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let on = dependency["name"].as_str().unwrap_or_default();
            let in_tests = dependency["kind"] == "dev";
            if FOR_TESTS.contains(&on) && !in_tests && !for_tests {
                wrong.push(format!("{name} depends on {on} outside its tests"));
            }
            let below = LAYERS.iter().position(|crate_name| *crate_name == on);
            if let (Some(layer), Some(below), false) = (layer, below, in_tests)
                && below >= layer
            {
                wrong.push(format!("{name} depends on {on}, which is below it"));
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(Failure(wrong.join("\n"))) }
}

fn list(value: &Value) -> Vec<&str> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}
