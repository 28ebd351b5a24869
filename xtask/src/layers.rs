// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The layer rule: a crate depends only on lower crates, those to its left in ARCHITECTURE.md.

use serde_json::Value;

use crate::command::Failure;

/// The crates from the lowest layer to the highest.
const LAYERS: [&str; 19] = [
    "palpate-field",
    "palpate-mesh",
    "palpate-grid",
    "palpate-query",
    "palpate-local",
    "palpate-device",
    "palpate-vibration",
    "palpate-sim",
    "palpate-safety",
    "palpate-haptics",
    "palpate-scene",
    "palpate-plot",
    "palpate-render",
    "palpate",
    "palpate-live",
    "palpate-cli",
    "palpate-python",
    "palpate-bench",
    "xtask",
];

/// What tests alone may use, from any layer.
const FOR_TESTS: &[&str] = &["palpate-testkit"];

/// Checks every dependency between the crates of the workspace, and that all of them are in the
/// lists here and in `architecture`.
pub(crate) fn check(metadata: &Value, architecture: &str) -> Result<(), Failure> {
    let ids = list(&metadata["workspace_members"]);
    let packages = || metadata["packages"].as_array().into_iter().flatten();
    let is_member = |id: &Value| ids.contains(&id.as_str().unwrap_or_default());
    let members: Vec<_> = packages().filter(|package| is_member(&package["id"])).collect();
    let mut wrong: Vec<String> =
        members.iter().flat_map(|package| wrong_dependencies(package)).collect();
    let names: Vec<_> = members.iter().filter_map(|package| package["name"].as_str()).collect();
    for listed in LAYERS.iter().chain(FOR_TESTS).filter(|listed| !names.contains(listed)) {
        wrong.push(format!("{listed} is in a layer, but no crate: see xtask/src/layers.rs"));
    }
    let line = LAYERS.map(|name| format!("`{name}`")).join(" · ");
    if !architecture.contains(&line) {
        wrong.push(format!("ARCHITECTURE.md lists other layers than {line}"));
    }
    Failure::any(wrong)
}

/// What is wrong with the dependencies of a crate.
fn wrong_dependencies(package: &Value) -> Vec<String> {
    let mut wrong = Vec::new();
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
        let other = LAYERS.iter().position(|crate_name| *crate_name == on);
        if let (Some(layer), Some(other), false) = (layer, other, in_tests)
            && other >= layer
        {
            wrong.push(format!("{name} depends on {on}, which is above it"));
        }
    }
    wrong
}

fn list(value: &Value) -> Vec<&str> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A workspace of all crates, of which `name` depends on `on`, and more.
    fn workspace(name: &str, on: &str, kind: Value, more: &[&str]) -> Value {
        let all = LAYERS.iter().chain(FOR_TESTS).chain(more);
        let package = |crate_name: &&str| {
            let dependency = serde_json::json!({ "name": on, "kind": kind });
            let dependencies = if *crate_name == name { vec![dependency] } else { Vec::new() };
            serde_json::json!({ "id": crate_name, "name": crate_name, "dependencies": dependencies })
        };
        let packages: Vec<_> = all.clone().map(package).collect();
        serde_json::json!({ "workspace_members": all.collect::<Vec<_>>(), "packages": packages })
    }

    fn said(metadata: &Value) -> String {
        let architecture = LAYERS.map(|name| format!("`{name}`")).join(" · ");
        check(metadata, &architecture).err().map_or_else(String::new, |failure| failure.0)
    }

    #[test]
    fn a_crate_depends_on_lower_crates_alone() {
        let good = workspace("palpate-query", "palpate-field", Value::Null, &[]);
        assert_eq!(said(&good), "");
        let bad = workspace("palpate-field", "palpate-query", Value::Null, &[]);
        assert_eq!(said(&bad), "palpate-field depends on palpate-query, which is above it");
        let in_tests = workspace("palpate-field", "palpate-query", "dev".into(), &[]);
        assert_eq!(said(&in_tests), "");
    }

    #[test]
    fn what_is_for_tests_is_used_in_tests() {
        let bad = workspace("palpate-query", "palpate-testkit", Value::Null, &[]);
        assert_eq!(said(&bad), "palpate-query depends on palpate-testkit outside its tests");
        assert_eq!(said(&workspace("palpate-query", "palpate-testkit", "dev".into(), &[])), "");
    }

    #[test]
    fn every_crate_is_in_a_layer_and_every_layer_a_crate() {
        let more = workspace("", "", Value::Null, &["palpate-more"]);
        assert_eq!(said(&more), "palpate-more is in no layer: add it to xtask/src/layers.rs");
        let mut fewer = workspace("", "", Value::Null, &[]);
        fewer["packages"]
            .as_array_mut()
            .unwrap()
            .retain(|package| package["name"] != "palpate");
        assert!(said(&fewer).starts_with("palpate is in a layer, but no crate"));
    }

    #[test]
    fn the_document_lists_the_same_layers() {
        let good = workspace("", "", Value::Null, &[]);
        let failure = check(&good, "`palpate-field` · `xtask`").unwrap_err();
        assert!(failure.0.starts_with("ARCHITECTURE.md lists other layers"), "{}", failure.0);
    }
}
