// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles `src/closed.c`, and sets the version that the program prints. It includes the commit if that is known: from
//! `PALPATE_COMMIT`, or in a release build from git.

use std::env::var;
use std::path::Path;
use std::process::Command;

fn main() {
    mark_closed_output();
    println!("cargo::rerun-if-env-changed=PALPATE_COMMIT");
    // Other builds are not made again after each commit.
    let is_release = var("PROFILE").is_ok_and(|profile| profile == "release");
    let of_git = || is_release.then(commit).flatten();
    let mut version = env!("CARGO_PKG_VERSION").to_owned();
    if let Some(commit) = var("PALPATE_COMMIT").ok().or_else(of_git) {
        version += &format!(" ({commit})");
    }
    println!("cargo::rustc-env=PALPATE_VERSION={version}");
}

/// Links what looks whether standard output is closed to the program.
fn mark_closed_output() {
    println!("cargo::rerun-if-changed=src/closed.c");
    if var("CARGO_CFG_UNIX").is_err() {
        return;
    }
    // An object: of a library, nothing would ask for its one function, which is called before `main`.
    for object in cc::Build::new().file("src/closed.c").compile_intermediates() {
        println!("cargo::rustc-link-arg-bin=palpate={}", object.display());
    }
}

/// The commit that is checked out, if this file is one of its files.
fn commit() -> Option<String> {
    // A copy of this package may be in the repository of another project.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let folder = git(&["rev-parse", "--absolute-git-dir"])?;
    for file in ["HEAD", "logs/HEAD"] {
        let path = Path::new(&folder).join(file);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(&["rev-parse", "--short=12", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let said =
        output.status.success().then(|| String::from_utf8(output.stdout).ok()).flatten()?;
    Some(said.trim().to_owned())
}
