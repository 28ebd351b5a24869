// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All checks that are not tests, each with its time.

use std::time::Instant;

use crate::command::{Failure, cargo, cargo_with, metadata};
use crate::{layers, licences, sources};

type Stage = (&'static str, fn() -> Result<(), Failure>);

/// The stages, the cheapest first.
const STAGES: &[Stage] = &[
    ("format", || cargo(&["fmt", "--all", "--check"])),
    ("sources", sources::check),
    ("layers", || layers::check(&metadata()?)),
    ("licences", || licences::check(&metadata()?)),
    ("clippy", || {
        cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"])
    }),
    ("docs", || {
        cargo_with(
            &["doc", "--workspace", "--no-deps", "--locked"],
            &[("RUSTDOCFLAGS", "-D warnings")],
        )
    }),
];

/// Runs every stage, all of them even if one fails.
pub(crate) fn all() -> Result<(), Failure> {
    let mut failures = Vec::new();
    for (name, stage) in STAGES {
        let start = Instant::now();
        let result = stage();
        println!("check {name}: {:.1} s", start.elapsed().as_secs_f64());
        failures.extend(result.err().map(|failure| format!("{name}: {}", failure.0)));
    }
    if failures.is_empty() { Ok(()) } else { Err(Failure(failures.join("\n"))) }
}
