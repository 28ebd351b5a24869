// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rules on what crates need: they compile without a system beneath them, and pull few others.

use std::collections::BTreeSet;
use std::process::Command;

use crate::command::{Failure, cargo, cargo_command, output, root};

/// A target without a system.
const WASM: &str = "wasm32-unknown-unknown";

/// Crates that compile for it without their default features.
const FOR_WASM: &[&str] = &["palpate-field", "palpate-query", "palpate-haptics", "palpate"];

/// Crates, and how many crates they and what they need are at most, without default features: 20
/// of other projects, and the crate itself with the four of this workspace that it needs.
const MOST_CRATES: &[(&str, usize)] = &[("palpate-haptics", 20 + 5)];

/// Crates, and what none of those that they need may be without default features.
const WITHOUT: &[(&str, &str)] = &[("palpate", "serde"), ("palpate", "serde_core")];

/// Compiles what has to compile for [`WASM`].
pub(crate) fn wasm() -> Result<(), Failure> {
    add_target()?;
    for name in FOR_WASM {
        cargo(&["check", "-p", name, "--no-default-features", "--locked", "--target", WASM])?;
    }
    Ok(())
}

/// Adds the target to the toolchain that compiles here, if it is missing.
fn add_target() -> Result<(), Failure> {
    let libraries = output(Command::new("rustc").current_dir(root()).args([
        "--print",
        "target-libdir",
        "--target",
        WASM,
    ]))?;
    if std::path::Path::new(libraries.trim()).is_dir() {
        return Ok(());
    }
    let line = format!("rustup target add {WASM}");
    output(Command::new("rustup").current_dir(root()).args(["target", "add", WASM])).map_err(
        |failure| Failure(format!("run `{line}`, which does not work here: {}", failure.0)),
    )?;
    Ok(())
}

/// Checks what crates need.
pub(crate) fn dependencies() -> Result<(), Failure> {
    let mut wrong = Vec::new();
    for (name, most) in MOST_CRATES {
        wrong.extend(too_many(name, &needed(name)?, *most));
    }
    for (name, other) in WITHOUT {
        wrong.extend(needs(name, &needed(name)?, other));
    }
    wrong.extend(compiled_again()?);
    Failure::any(wrong)
}

/// Crates that the wheel would compile again beside those of the tests, since their features differ.
fn compiled_again() -> Result<Vec<String>, Failure> {
    let wheel =
        features(&["-p", "palpate-python", "--features", "as-tested", "-e", "normal,build"])?;
    let tests = features(&["--workspace", "-e", "normal,build,dev"])?;
    let own = features(&["-p", "palpate-cli", "-e", "normal,build"])?;
    Ok(differing(&wheel, &tests, &own))
}

/// A crate, its version and its features a line.
fn features(which: &[&str]) -> Result<String, Failure> {
    let mut tree = cargo_command(&["tree", "--locked", "--prefix", "none", "-f", "{p} |{f}"]);
    output(tree.args(which))
}

/// Lists crates that the wheel and the tests build with different features. Crates outside `own` are
/// ignored: they are few and cheap to build.
fn differing(wheel: &str, tests: &str, own: &str) -> Vec<String> {
    let named = |line: &str| line.split(" |").next().unwrap_or_default().to_owned();
    let own: BTreeSet<String> = crates(own).into_iter().map(named).collect();
    let tests = crates(tests);
    let differs = |line: &&str| !tests.contains(line) && own.contains(&named(line));
    let told = |line: &str| {
        format!(
            "the wheel compiles {line} again: name these features in `as-tested` of bindings/python/Cargo.toml"
        )
    };
    crates(wheel).into_iter().filter(differs).map(told).collect()
}

/// A crate and what it needs without default features, a crate and its version a line.
fn needed(name: &str) -> Result<String, Failure> {
    let mut tree = cargo_command(&["tree", "--locked", "-p", name, "--no-default-features"]);
    output(tree.args(["--edges", "normal", "--prefix", "none"]))
}

/// The crates of a tree; cargo marks those that it printed before.
fn crates(tree: &str) -> BTreeSet<&str> {
    tree.lines().map(|line| line.trim_end_matches(" (*)")).collect()
}

/// Says if a tree has too many crates.
fn too_many(name: &str, tree: &str, most: usize) -> Option<String> {
    let count = crates(tree).len();
    println!("{name} is {count} crates with what it needs, {most} at most");
    (count > most)
        .then(|| format!("{name} is {count} crates with what it needs, {most} at most"))
}

/// Says if a tree has the crate `other`.
fn needs(name: &str, tree: &str, other: &str) -> Option<String> {
    let is_other = |line: &&str| line.split(' ').next() == Some(other);
    let found = crates(tree).into_iter().find(is_other)?;
    Some(format!("{name} needs {found} without default features"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_that_needs_too_many_others_is_refused() {
        let tree = "a v1\nb v1\nc v1\nb v1 (*)\n";
        assert_eq!(too_many("a", tree, 3), None);
        let said = too_many("a", tree, 2).unwrap();
        assert_eq!(said, "a is 3 crates with what it needs, 2 at most");
    }

    #[test]
    fn a_crate_of_the_wheel_with_other_features_is_told() {
        let tests = "a v1 |default,std\nb v1 |std\n";
        let told = differing("a v1 |std\nb v1 |std (*)\nc v1 |\n", tests, "a v1 |\nb v1 |\n");
        assert_eq!(told.len(), 1);
        assert!(told[0].starts_with("the wheel compiles a v1 |std again"), "{told:?}");
        assert_eq!(differing("b v1 |std\n", tests, "b v1 |\n"), [] as [String; 0]);
    }

    #[test]
    fn a_crate_that_needs_what_its_features_bring_is_refused() {
        let tree = "a v1\nserde_derive v2\nserde v1\n";
        assert_eq!(
            needs("a", tree, "serde").unwrap(),
            "a needs serde v1 without default features"
        );
        assert_eq!(needs("a", tree, "derive"), None);
    }
}
