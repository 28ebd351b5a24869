// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Every example runs, says something, and stays short.
use std::path::{Path, PathBuf};
use std::process::Command;

/// The most lines of an example.
const MOST_LINES: usize = 60;

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> =
        folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn every_example_runs_and_says_something() {
    // `cargo test` builds examples beside the tests.
    let deps = std::env::current_exe().unwrap();
    let folder = deps.parent().and_then(Path::parent).unwrap().join("examples");
    for file in examples() {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let program = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        let output = Command::new(&program).output().unwrap_or_else(|error| {
            panic!("{}: {error}; `cargo test -p palpate` builds it", program.display())
        });
        let said = String::from_utf8(output.stdout).unwrap();
        let complained = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{name}: {complained}");
        assert!(!said.trim().is_empty(), "{name} says nothing");
    }
}

#[test]
fn every_example_fits_a_screen_and_is_named_in_the_readme() {
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md");
    let readme = std::fs::read_to_string(readme).unwrap();
    for file in examples() {
        let lines = std::fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= MOST_LINES, "{} has {lines} lines", file.display());
        let name = file.file_name().unwrap().to_string_lossy();
        assert!(readme.contains(&format!("examples/{name}")), "README.md does not name {name}");
    }
}
