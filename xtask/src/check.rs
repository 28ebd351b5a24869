// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All checks that are not tests, each with its time.

use std::time::Instant;

use crate::command::{Failure, cargo, cargo_with, metadata, root};
use crate::{api, builds, code, layers, licences, links, packages, sources, words};

type Stage = (&'static str, fn() -> Result<(), Failure>);

/// The stages, the cheapest first.
const STAGES: &[Stage] = &[
    ("format", || cargo(&["fmt", "--all", "--check"])),
    ("sources", sources::check),
    ("words", words::check),
    ("links", links::check),
    ("layers", || layers::check(&metadata()?, &architecture()?)),
    ("dependencies", builds::dependencies),
    ("licences", || licences::check(&metadata()?)),
    ("packages", || packages::check(&metadata()?)),
    ("clippy", || {
        cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"])
    }),
    ("wasm", builds::wasm),
    ("docs", document),
    ("api", || document().and_then(|()| api::check())),
    (THOROUGH, code::check),
];

/// This stage makes a release build, so it runs only if asked for.
const THOROUGH: &str = "code";

/// Makes the documentation of every crate.
pub(crate) fn document() -> Result<(), Failure> {
    // rustdoc links to another crate's pages only where their folder is there already. cargo takes
    // the crates in any order, and empties a crate's folder just before that crate's rustdoc
    // makes it anew: one crate at a time, no rustdoc sees the folder of another one missing.
    api::make_folders()?;
    cargo_with(
        &["doc", "--workspace", "--no-deps", "--locked", "--jobs", "1"],
        &[("RUSTDOCFLAGS", "-D warnings")],
    )
}

fn architecture() -> Result<String, Failure> {
    std::fs::read_to_string(root().join("ARCHITECTURE.md"))
        .map_err(|error| Failure(format!("ARCHITECTURE.md cannot be read: {error}")))
}

/// The names of the stages.
pub(crate) fn stages() -> impl Iterator<Item = &'static str> {
    STAGES.iter().map(|(name, _)| *name)
}

/// Runs the stages of these names. If there are none, it runs all, the thorough one only if
/// `is_thorough`. It goes on after a failure.
pub(crate) fn run(names: &[String], is_thorough: bool) -> Result<(), Failure> {
    let mut failures = Vec::new();
    let asked = |name: &str| match names {
        [] => is_thorough || name != THOROUGH,
        _ => names.iter().any(|asked| asked == name),
    };
    for (name, stage) in STAGES.iter().filter(|(name, _)| asked(name)) {
        let start = Instant::now();
        let result = stage();
        println!("check {name}: {:.1} s", start.elapsed().as_secs_f64());
        failures.extend(result.err().map(|failure| format!("{name}: {}", failure.0)));
    }
    Failure::any(failures)
}
